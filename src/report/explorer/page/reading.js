// One reading: the words beside the pointer, and the panel with its plateau in the log and where it comes from.

const panel = { plots: [] };

const predictions = (set, k) => set.models
  .map((model) => ({ model, predicted: value(set, model.column, k) }))
  .filter(({ predicted }) => predicted !== null && !Number.isNaN(predicted));

// The same words for the pointer and for a screen reader: name and text.
function wordsOf(set, k) {
  const words = [[value(set, "specimen", k), value(set, "session", k)]];
  const say = (name) => {
    const column = set.byName.get(name);
    const given = column?.data[k];
    if (given !== undefined && given !== null && !Number.isNaN(given)) words.push([column.label, column.is_text ? given : withUnit(given, column.unit)]);
  };
  for (const name of [set.measured, "pressure_kpa", "contraction_rel", "angle_rad", "phase"]) say(name);
  const predicted = value(set, state.model, k);
  if (predicted !== null && !Number.isNaN(predicted)) {
    words.push([set.modelOf.get(state.model).label, withUnit(predicted, set.unit)]);
    words.push(["measured minus predicted", withUnit(set.measuredValues[k] - predicted, set.unit)]);
  }
  for (const name of [state.x, state.y, state.colour]) {
    if (set.byName.has(name) && !words.some(([label]) => label === set.byName.get(name).label) && !["specimen", "session"].includes(name)) say(name);
  }
  const what = value(set, "state", k);
  if (what && what !== "fitted") words.push(["state", what]);
  return words;
}

function tipOf(set, k) {
  const [[specimen, session], ...rest] = wordsOf(set, k);
  const rows = rest.map(([name, text]) => element("div", {}, element("span", {}, name), element("b", {}, text)));
  return [element("strong", {}, `${specimen ?? ""}`), element("em", {}, session), ...rows];
}

function spoken(set, k, place, count) {
  const [[specimen, session], ...rest] = wordsOf(set, k);
  return `Reading ${place} of ${count}: specimen ${specimen}, session ${session}; ${rest.map(([name, text]) => `${name} ${text}`).join("; ")}`;
}

function openReading(k, focus) {
  const set = setOf();
  state.reading = keyOf(set, k);
  toAddress();
  showReading(set, k);
  scatter.plot.redraw(false);
  byId("live").textContent = `Opened: ${spoken(set, k, scatter.places.indexOf(k) + 1, scatter.places.length)}`;
  if (!focus) return;
  hideTip();
  byId("reading").querySelector("button").focus();
}

function closeReading() {
  const had = state.reading;
  state.reading = "";
  byId("reading").hidden = true;
  document.body.classList.remove("with-reading");
  panel.plots.forEach((plot) => plot.destroy());
  panel.plots = [];
  if (!had) return;
  toAddress();
  resize();
  byId("plot").focus({ preventScroll: true });
}

function showReading(set, k) {
  const aside = byId("reading");
  panel.plots.forEach((plot) => plot.destroy());
  panel.plots = [];
  const close = element("button", { type: "button", className: "close", ariaLabel: "Close" }, "×");
  close.addEventListener("click", closeReading);
  aside.addEventListener("keydown", (event) => event.key === "Escape" && closeReading());
  const trace = element("div", { className: "trace" });
  const heading = element("h2", {}, `${value(set, "specimen", k)}, ${withUnit(set.measuredValues[k], set.unit)}`);
  aside.replaceChildren(close, heading, trace, source(set, k), table(set, k));
  const wasHidden = aside.hidden;
  aside.hidden = false;
  document.body.classList.add("with-reading");
  if (wasHidden) resize();
  drawTrace(set, k, trace);
}

// Where the reading comes from.
function source(set, k) {
  const id = value(set, "session", k);
  const session = PAGE.sessions[id] ?? {};
  const [first, last] = [value(set, "row", k), value(set, "last_row", k)];
  const samples = value(set, "n_samples", k);
  const lines = last !== null && last > first ? `lines ${first} to ${last}${samples ? ` (${shown(samples)} samples)` : ""}` : `line ${first}`;
  const of = [
    ["Raw file", `${value(set, "log", k)}, ${lines}`],
    ["Session", id],
    ["Campaign", value(set, "campaign", k)],
    ["Date", session.date],
    ["Data", session.simulated ? "simulated" : null],
    ["State", value(set, "state", k)],
    ["Excluded", session.exclude],
    ["Notes", session.notes],
  ];
  const list = of.filter(([, text]) => text).map(([name, text]) => [element("dt", {}, name), element("dd", {}, String(text))]);
  const command = element("code", {}, `pipeline explain ${id}`);
  const how = element("p", { className: "note" }, "Its stages, options and digests: ", command, "; the digests of the raw files: ", element("a", { href: "provenance.json" }, "provenance.json"), ".");
  return element("section", {}, element("h3", {}, "Where it comes from"), element("dl", {}, list.flat()), how);
}

// What every model says of it, and every column.
function table(set, k) {
  const measured = set.measuredValues[k];
  const head = ["", `predicted, ${set.unit.replace(".", " ")}`, "measured minus predicted"].map((text) => element("th", { scope: "col" }, text));
  const rows = predictions(set, k).map(({ model, predicted }) => element("tr", { className: model.column === state.model ? "chosen" : "" },
    element("th", { scope: "row" }, model.label), element("td", {}, shown(predicted)), element("td", {}, shown(measured - predicted))));
  const models = new Set(set.models.map((model) => model.column));
  const columns = set.columns.filter((c) => !models.has(c.name) && c.data[k] !== null && !Number.isNaN(c.data[k]));
  const list = columns.map((c) => [element("dt", {}, c.label), element("dd", {}, c.is_text ? c.data[k] : withUnit(c.data[k], c.unit, 6))]);
  const shownModels = rows.length ? [element("h3", {}, "Models"), element("table", {}, element("thead", {}, element("tr", {}, head)), element("tbody", {}, rows))] : [];
  return element("section", {}, shownModels, element("details", {}, element("summary", {}, "Every column"), element("dl", {}, list.flat())));
}

// The log with the plateau marked; of a table of points the readings of the session one after the other.
function drawTrace(set, k, into) {
  const trace = TRACES.get(`${value(set, "session", k)}\n${value(set, "log", k)}`);
  const drawn = trace ? logOf(trace, set, k) : pointsOf(set, k);
  const notes = [element("p", { className: "note" }, drawn.note)];
  if (!trace && PAGE.sessions[value(set, "session", k)]?.timed) notes.push(element("p", { className: "note" }, "The trace of this log is not on this page: ", element("code", {}, inFull(value(set, "campaign", k))), " makes one with all of them."));
  drawn.plots.forEach((one, place) => {
    const holder = element("div", {});
    into.append(holder);
    const plot = new uPlot(traceOptions(one, drawn, place === drawn.plots.length - 1, into.clientWidth), [drawn.at, one.values], holder);
    panel.plots.push(plot);
  });
  if (trace) into.append(nearButton(drawn));
  into.append(...notes);
  into.setAttribute("role", "img");
  into.setAttribute("aria-label", drawn.spoken);
}

// Shows the plateau with a few plateaus' width around it, or the whole log again.
function nearButton(drawn) {
  const button = element("button", { type: "button", ariaPressed: "false" }, "Near the plateau");
  button.addEventListener("click", () => {
    const near = button.ariaPressed === "false";
    button.ariaPressed = String(near);
    const [from, to] = drawn.marked;
    const room = 4 * Math.max(to - from, 1e-9);
    const ends = near ? { min: from - room, max: to + room } : { min: drawn.at[0], max: drawn.at[drawn.at.length - 1] };
    panel.plots[0].setScale("x", ends);
  });
  return button;
}

// What one plot of the log shows along it, the other shows too.
function alike(u, scale) {
  if (scale !== "x") return;
  const { min, max } = u.scales.x;
  for (const other of panel.plots) if (other !== u && (other.scales.x.min !== min || other.scales.x.max !== max)) other.setScale("x", { min, max });
}

function traceOptions(one, drawn, last, width) {
  const mark = (u) => {
    const [from, to] = drawn.marked.map((x) => u.valToPos(x, "x", true));
    const { left, top, width: w, height } = u.bbox;
    u.ctx.save();
    u.ctx.beginPath();
    u.ctx.rect(left, top, w, height);
    u.ctx.clip();
    u.ctx.fillStyle = colourOf("--mark");
    const wide = Math.max(to - from, 3 * (devicePixelRatio || 1));
    u.ctx.fillRect((from + to - wide) / 2, top, wide, height);
    if (Number.isFinite(one.level)) {
      u.ctx.fillStyle = colourOf("--accent");
      u.ctx.beginPath();
      outline(u.ctx, "circle", (from + to) / 2, u.valToPos(one.level, "y", true), 4 * (devicePixelRatio || 1));
      u.ctx.fill();
    }
    u.ctx.restore();
  };
  return {
    width: Math.max(240, width), height: last ? 190 : 150, legend: { show: false }, scales: { x: { time: false } },
    cursor: { sync: { key: "trace" }, drag: { x: true, y: false }, points: { show: false } },
    axes: [axisOf(last ? drawn.across : "", last ? {} : { size: 24, labelSize: 0, label: undefined }), axisOf(one.label, { size: 58 })],
    series: [{}, { stroke: () => colourOf("--trace"), width: 1.2, points: { show: drawn.points, size: 5, fill: () => colourOf("--trace") }, paths: drawn.points ? () => null : undefined }],
    hooks: { draw: [mark], setScale: [alike] },
  };
}

// A log: lowest and highest of every stretch one after the other.
function logOf(trace, set, k) {
  const whole = new Uint16Array(bytesOf(trace.u16));
  const n = whole.length / 5;
  const number = (place, scale) => {
    const [low, high] = trace.scales[scale];
    return whole[place] === 65535 ? null : low + ((high - low) * whole[place]) / 65534;
  };
  const [at, pressure, channel] = [[], [], []];
  for (let i = 0; i < n; i++) {
    const time = number(i, 0);
    at.push(time, time);
    pressure.push(number(n + i, 1), number(2 * n + i, 1));
    channel.push(number(3 * n + i, 2), number(4 * n + i, 2));
  }
  const lines = [value(set, "row", k), value(set, "last_row", k)];
  const marked = trace.timed ? timesOf(trace, at, set, k, lines) : lines;
  const zero = value(set, "zero_force_n", k) || 0;
  const taken = zero ? `; the reading is less the zero of ${withUnit(zero, set.unit)}` : "";
  const quantityName = set.byName.get(set.measured).label;
  return {
    at, marked, points: false, across: trace.timed ? "time in the log, s" : "line of the log",
    plots: [
      { values: pressure, label: "pressure, kPa", level: value(set, "pressure_kpa", k) },
      { values: channel, label: `${quantityName}, ${set.unit.replace(".", " ")}`, level: set.measuredValues[k] + zero },
    ],
    note: `${trace.log}: ${trace.samples.toLocaleString("en")} samples as calibrated, thinned to the lowest and highest of ${n} stretches. The band is the plateau${taken}.`,
    spoken: `Trace of ${trace.log}: pressure and ${quantityName} over ${trace.timed ? "time" : "lines"}; the plateau is from ${shown(marked[0])} to ${shown(marked[1])}`,
  };
}

// Times of the first and last line of a plateau. The reading has the time of its samples' middle; a log is sampled evenly near it.
function timesOf(trace, at, set, k, [first, last]) {
  const middle = value(set, "time_s", k);
  const each = (at[at.length - 1] - at[0]) / Math.max(trace.samples - 1, 1);
  const half = (each * (last - first)) / 2;
  return middle === null || Number.isNaN(middle) ? [at[0] + each * (first - trace.first_line), at[0] + each * (last - trace.first_line)] : [middle - half, middle + half];
}

// The readings of the same log, one after the other.
function pointsOf(set, k) {
  const [session, log] = [value(set, "session", k), value(set, "log", k)];
  const [sessions, logs] = [set.byName.get("session").data, set.byName.get("log").data];
  const row = set.byName.get("row").data;
  const own = [...row.keys()].filter((i) => sessions[i] === session && logs[i] === log).sort((a, b) => row[a] - row[b]);
  const pick = (name) => own.map((i) => { const x = value(set, name, i); return x === null || Number.isNaN(x) ? null : x; });
  const measured = set.byName.get(set.measured);
  const plots = [{ values: pick("pressure_kpa"), label: "pressure, kPa", level: value(set, "pressure_kpa", k) }, { values: pick(set.measured), label: titled(measured), level: set.measuredValues[k] }];
  return {
    at: own.map((i) => row[i]), marked: [row[k], row[k]], points: true, across: "line of the file",
    plots: plots.filter((one) => one.values.some((x) => x !== null)),
    note: `${log}: its ${own.length} readings one after the other.`,
    spoken: `Readings of ${log} by line; this one is line ${row[k]} of ${own.length} readings`,
  };
}

const inFull = (campaign) => `pipeline explore ${/^[\w.-]+$/.test(campaign) ? campaign : `"${campaign}"`} --out ${campaign.replace(/[^\w.-]+/g, "-")}.html`;
