// What is shown: choices, filters, the steps of the search, the table.

const option = (name, label, chosen) => element("option", { value: name, selected: name === chosen }, label);

// A model that has no value for any reading of the campaign cannot be chosen.
function modelOption(set, model, chosen) {
  const disabled = !hasValues(set, model.column);
  const made = option(model.column, disabled ? `${model.label} (no values here)` : model.label, chosen);
  made.disabled = disabled;
  return made;
}

// Columns that can stand on an axis, or colour marks, in groups.
function axisChoices(set, chosen, withTexts) {
  const models = new Set(set.models.map((m) => m.column));
  const own = set.columns.filter((c) => !models.has(c.name) && (withTexts || !c.is_text));
  const of = (title, list) => element("optgroup", { label: title }, list);
  const label = (c) => c.label + (c.unit ? ` (${c.unit.replace(".", " ")})` : "");
  const groups = [];
  if (set.models.length) groups.push(of("Chosen model", [option("residual", "measured minus predicted", chosen), ...(withTexts ? [] : [option("predicted", "predicted", chosen)])]));
  groups.push(of("Reading", own.map((c) => option(c.name, label(c), chosen))));
  if (!withTexts) groups.push(of("Predicted by", set.models.map((m) => modelOption(set, m, chosen))));
  return groups;
}

function modelChoices(set) {
  const of = (title, is) => {
    const list = set.models.filter((m) => m.is_search === is);
    return list.length ? [element("optgroup", { label: title }, list.map((m) => modelOption(set, m, state.model)))] : [];
  };
  return [...of("Models", false), ...of("Residual search", true)];
}

function fillControls() {
  const set = setOf();
  const sets = byId("sets");
  sets.hidden = PAGE.sets.length < 2;
  segments(sets, PAGE.sets.map((s) => [s.kind, s.title]), state.kind, (kind) => {
    Object.assign(state, usual(kind));
    refresh(true);
  });
  const campaigns = levelsOf(set, "campaign");
  byId("campaign").replaceChildren(...(campaigns.length > 1 ? [option("", `All ${campaigns.length}`, state.campaign)] : []), ...campaigns.map((c) => option(c, c, state.campaign || (campaigns.length === 1 ? c : ""))));
  for (const axis of ["x", "y"]) byId(axis).replaceChildren(...axisChoices(set, state[axis], false));
  byId("colour").replaceChildren(...axisChoices(set, state.colour, true));
  byId("model").replaceChildren(...modelChoices(set));
  byId("model").closest("label").hidden = !set.models.length;
  byId("low").value = state.low;
  byId("high").value = state.high;
  const pressure = set.byName.get("pressure_kpa");
  if (pressure) [byId("low").placeholder, byId("high").placeholder] = span(pressure.data, [...pressure.data.keys()].filter((k) => Number.isFinite(pressure.data[k]))).map((x) => Math.round(x));
  for (const [id, name, title] of [["specimens", "specimen", "Specimens"], ["sessions", "session", "Sessions"], ["branches", "phase", "Branch"], ["states", "state", "State"]]) fillFilter(id, name, title);
  fillSteps(set);
}

// A row of buttons of which one is chosen.
function segments(into, choices, chosen, choose) {
  const legend = into.querySelector("legend");
  const buttons = choices.map(([name, label]) => {
    const radio = element("input", { type: "radio", name: into.id, value: name, checked: name === chosen });
    radio.addEventListener("change", () => choose(name));
    return element("label", {}, radio, element("span", {}, label));
  });
  into.replaceChildren(legend, ...buttons);
}

// Levels of a column that readings of the campaign have, to be chosen.
function fillFilter(id, name, title) {
  const set = setOf();
  const [data, campaigns] = [set.byName.get(name)?.data, set.byName.get("campaign")?.data];
  const details = byId(id);
  details.hidden = !data;
  if (!data) return;
  const used = new Set();
  data.forEach((x, k) => (!state.campaign || campaigns[k] === state.campaign) && used.add(x ?? NOT_NAMED));
  const levels = levelsOf(set, name).filter((level) => used.has(level));
  details.hidden = levels.length < 2;
  const chosen = state.filters[name];
  const count = chosen ? levels.filter((level) => chosen.has(level)).length : levels.length;
  details.querySelector("summary").textContent = `${title}: ${count === levels.length ? "all" : count + " of"} ${levels.length}`;
  details.classList.toggle("narrowed", count < levels.length);
  const choose = (now) => {
    if (levels.every((level) => now.has(level))) delete state.filters[name];
    else state.filters[name] = now;
    refresh();
  };
  const boxes = levels.map((level) => {
    const box = element("input", { type: "checkbox", checked: !chosen || chosen.has(level), value: level });
    box.addEventListener("change", () => {
      const now = new Set(chosen ?? levels);
      box.checked ? now.add(level) : now.delete(level);
      choose(now);
      byId(id).querySelector(`input[value="${CSS.escape(level)}"]`)?.focus();
    });
    const only = element("button", { type: "button", className: "only", ariaLabel: `only ${level}` }, "only");
    only.addEventListener("click", () => choose(new Set([level])));
    return element("div", { className: "choice" }, element("label", {}, box, " ", level), only);
  });
  const all = element("button", { type: "button" }, "all");
  all.addEventListener("click", () => choose(new Set(levels)));
  const none = element("button", { type: "button" }, "none");
  none.addEventListener("click", () => choose(new Set()));
  const scroll = details.querySelector(".choices");
  const top = scroll.scrollTop;
  scroll.replaceChildren(element("p", { className: "buttons" }, all, " ", none), ...boxes);
  scroll.scrollTop = top;
}

// What the search expects without effects, after each of them, and with all: one step to the next shows what an effect does.
function fillSteps(set) {
  const steps = byId("steps");
  const answers = PAGE.answers.filter((a) => a.kind === set.kind && (!state.campaign || a.campaign === state.campaign));
  const names = answers.length === 1 ? answers[0].steps : [];
  const most = Math.max(0, ...PAGE.answers.filter((a) => a.kind === set.kind && (!state.campaign || a.campaign === state.campaign)).map((a) => a.steps.length));
  const suffix = set.unit === "N" ? ["predicted_loop_", "_n"] : ["loop_", "_torque_nm"];
  const all = [["before", "without effects"]];
  for (let k = 1; k <= most; k++) all.push([`after_${k}`, names[k - 1] ? `+ ${names[k - 1]}` : `+ effect ${k}`]);
  if (!names.length || !most) all.push(["after", "all effects"]);
  all.push(["conditional", "+ specimen and session known"]);
  const known = all.map(([name, label]) => [suffix[0] + name + suffix[1], label]).filter(([column]) => set.modelOf.has(column));
  steps.hidden = known.length < 2;
  segments(steps, known, state.model, (model) => {
    Object.assign(state, { model, y: state.y === "predicted" ? "predicted" : "residual" });
    refresh(true);
    byId("steps").querySelector("input:checked")?.focus();
  });
}

function sayErrors(set, places) {
  const model = set.modelOf.get(state.model);
  const parts = [element("b", {}, `${places.length.toLocaleString("en")} readings`)];
  if (model) {
    const { n, rms, mean, largest } = errorsOf(set, state.model, places);
    const unit = set.unit;
    if (places.length) parts.push(` · ${model.label}`, n < places.length ? ` (${n.toLocaleString("en")} with an answer)` : "");
    if (n) parts.push(": RMSE ", element("b", { id: "rmse" }, withUnit(rms, unit)), ", mean ", withUnit(mean, unit), ", largest ", withUnit(largest, unit));
  }
  if (!places.length) parts.push(`: ${whyNone(set)}`);
  byId("errors").replaceChildren(...parts);
}

// Why no reading is drawn.
function whyNone(set) {
  const passing = passingReadings(set);
  if (!passing.length) return "none passes the filters";
  const count = `the ${passing.length.toLocaleString("en")} readings chosen`;
  const empty = [scatter.y, scatter.x].find((q) => passing.every((k) => !Number.isFinite(q.data[k])));
  if (empty?.of) return `${empty.of} has no value for ${count}; choose another model`;
  return empty ? `${count} have no ${empty.label}` : `none of ${count} has both ${scatter.x.label} and ${scatter.y.label}`;
}

// The readings shown, a page of them, for those who do not see the plot.
const ROWS = 200;

function fillTable(set, places) {
  if (!byId("table").open) return;
  const columns = [...new Set(["specimen", "session", set.measured, "pressure_kpa", ...[state.x, state.y].filter((name) => set.byName.has(name))])].map((name) => set.byName.get(name)).filter(Boolean);
  const predicted = set.byName.get(state.model)?.data;
  const head = [...columns.map(titled), ...(predicted ? ["predicted", "measured minus predicted"] : []), ""].map((text) => element("th", { scope: "col" }, text));
  const rows = places.slice(0, ROWS).map((k) => {
    const open = element("button", { type: "button", ariaLabel: `open the reading of ${value(set, "session", k)}, line ${value(set, "row", k)}` }, "open");
    open.addEventListener("click", () => openReading(k, true));
    const cells = columns.map((c) => element("td", {}, c.is_text ? (c.data[k] ?? "") : shown(c.data[k], 6)));
    const model = predicted ? [predicted[k], set.measuredValues[k] - predicted[k]].map((x) => element("td", {}, shown(x))) : [];
    return element("tr", {}, cells, model, element("td", {}, open));
  });
  const rest = places.length > ROWS ? [element("caption", {}, `The first ${ROWS} of ${places.length.toLocaleString("en")}; “Save as CSV” has all, and filters narrow them.`)] : [];
  byId("table").querySelector(".scroll").replaceChildren(element("table", {}, rest, element("thead", {}, element("tr", {}, head)), element("tbody", {}, rows)));
}

function saveCsv() {
  const set = setOf();
  const quoted = (x) => (x === null || Number.isNaN(x) ? "" : typeof x === "number" ? String(Number(x.toPrecision(7))) : /[",\n]/.test(x) ? `"${x.replaceAll('"', '""')}"` : x);
  const lines = [set.columns.map((c) => c.name).join(","), ...scatter.places.map((k) => set.columns.map((c) => quoted(c.data[k])).join(","))];
  const link = element("a", { href: URL.createObjectURL(new Blob([`${lines.join("\n")}\n`], { type: "text/csv" })), download: "readings.csv" });
  link.click();
  URL.revokeObjectURL(link.href);
}

function bindControls() {
  for (const name of ["x", "y", "model", "colour", "campaign"]) {
    byId(name).addEventListener("change", (event) => {
      state[name] = event.target.value;
      if (name === "campaign") {
        state.filters = {};
        if (state.campaign && state.colour === "campaign") state.colour = "specimen";
      }
      refresh(name === "x" || name === "y" || name === "campaign" || (name === "model" && ["residual", "predicted"].includes(state.y)));
    });
  }
  for (const end of ["low", "high"]) byId(end).addEventListener("change", (event) => {
    state[end] = event.target.value;
    refresh();
  });
  byId("reset").addEventListener("click", () => {
    Object.assign(state, { filters: {}, low: "", high: "", campaign: "" });
    refresh(true);
  });
  byId("csv").addEventListener("click", saveCsv);
  byId("link").addEventListener("click", async () => {
    toAddress();
    const done = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
    byId("live").textContent = done ? "The link is copied." : "The link is the address of this page.";
    byId("link").textContent = done ? "Copied" : "See the address";
    setTimeout(() => (byId("link").textContent = "Copy link"), 2000);
  });
  byId("controls").addEventListener("submit", (event) => event.preventDefault());
  byId("table").addEventListener("toggle", () => fillTable(setOf(), scatter.places));
  byId("plot").addEventListener("keydown", onKey);
}
