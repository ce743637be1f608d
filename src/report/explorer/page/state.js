// What is chosen on the page, kept in the part of the address after #: the address is a link to the view.

const FILTERS = ["specimen", "session", "phase", "state"];
const NOT_NAMED = "not known";

const state = {};

const setOf = () => PAGE.sets.find((set) => set.kind === state.kind) ?? PAGE.sets[0];

// The view that opens the page: what the first model leaves, over angle or pressure.
function usual(kind) {
  const set = PAGE.sets.find((s) => s.kind === kind) ?? PAGE.sets[0];
  const has = (name) => set.byName.has(name);
  const across = ["angle_rad", "pressure_kpa", "contraction_rel"].filter(has);
  return {
    kind: set.kind, campaign: "", x: across[0] ?? set.measured, y: set.models.length ? "residual" : set.measured,
    model: set.models[0]?.column ?? "", colour: has("campaign") && levelsOf(set, "campaign").length > 1 ? "campaign" : "specimen",
    low: "", high: "", reading: "", zoom: null, filters: {},
  };
}

// The different texts of a column, as they are named.
function levelsOf(set, name) {
  const column = set.byName.get(name);
  return column ? [...new Set(column.data.map((x) => x ?? NOT_NAMED))].sort((a, b) => a.localeCompare(b, "en", { numeric: true })) : [];
}

// A reading is known by session, log and first line.
const keyOf = (set, k) => [value(set, "session", k), value(set, "log", k), value(set, "row", k)].join("|");

function readingOf(set, key) {
  if (!key) return -1;
  for (let k = 0; k < set.count; k++) if (keyOf(set, k) === key) return k;
  return -1;
}

function fromAddress() {
  const given = new URLSearchParams(location.hash.slice(1));
  const start = usual(given.get("kind") ?? state.kind);
  const set = PAGE.sets.find((s) => s.kind === start.kind);
  const axis = (name) => name && quantity(set, name, set.models[0]?.column) && name;
  for (const name of ["x", "y"]) start[name] = axis(given.get(name)) || start[name];
  if (set.modelOf.has(given.get("model"))) start.model = given.get("model");
  if (set.byName.has(given.get("colour")) || given.get("colour") === "residual") start.colour = given.get("colour");
  if (levelsOf(set, "campaign").includes(given.get("campaign"))) start.campaign = given.get("campaign");
  for (const end of ["low", "high"]) if (given.get(end) && Number.isFinite(Number(given.get(end)))) start[end] = given.get(end);
  for (const name of FILTERS) if (given.has(name)) start.filters[name] = new Set(given.getAll(name));
  start.reading = given.get("reading") ?? "";
  const zoom = (given.get("zoom") ?? "").split(",").map(Number);
  if (zoom.length === 4 && zoom.every(Number.isFinite)) start.zoom = zoom;
  Object.assign(state, start);
}

function address() {
  const set = setOf();
  const start = usual(state.kind);
  const text = new URLSearchParams();
  if (PAGE.sets.length > 1) text.set("kind", state.kind);
  for (const name of ["campaign", "x", "y", "model", "colour", "low", "high", "reading"]) {
    if (state[name] !== start[name]) text.set(name, state[name]);
  }
  for (const [name, chosen] of Object.entries(state.filters)) for (const level of chosen) text.append(name, level);
  if (state.zoom) text.set("zoom", state.zoom.map((x) => Number(x.toPrecision(6))).join(","));
  return { set, hash: `#${text}` };
}

let ownHash = "";

function toAddress() {
  ownHash = address().hash;
  if (location.hash !== ownHash) history.replaceState(null, "", ownHash);
}

// Readings that pass the filters and have both coordinates, by place.
const shownReadings = (set, x, y) => passingReadings(set).filter((k) => Number.isFinite(x[k]) && Number.isFinite(y[k]));

// Whether a column has a number for any reading of the campaign.
function hasValues(set, name) {
  const [data, campaigns] = [set.byName.get(name)?.data ?? [], set.byName.get("campaign")?.data];
  return data.some((x, k) => Number.isFinite(x) && (!state.campaign || campaigns[k] === state.campaign));
}

// Readings that pass the filters, by place.
function passingReadings(set) {
  const { campaign, filters } = state;
  const low = state.low === "" ? -Infinity : Number(state.low);
  const high = state.high === "" ? Infinity : Number(state.high);
  const pressure = set.byName.get("pressure_kpa")?.data;
  const campaigns = set.byName.get("campaign")?.data;
  const chosen = Object.entries(filters).map(([name, levels]) => [set.byName.get(name)?.data, levels]).filter(([data]) => data);
  const found = [];
  for (let k = 0; k < set.count; k++) {
    if (campaign && campaigns[k] !== campaign) continue;
    if (pressure && (low > -Infinity || high < Infinity) && !(pressure[k] >= low && pressure[k] <= high)) continue;
    if (chosen.every(([data, levels]) => levels.has(data[k] ?? NOT_NAMED))) found.push(k);
  }
  return found;
}

// Number, root mean square, mean and largest of what the chosen model leaves of some readings.
function errorsOf(set, model, places) {
  const predicted = set.byName.get(model)?.data;
  let [n, sum, squares, largest] = [0, 0, 0, 0];
  for (const k of predicted ? places : []) {
    const error = set.measuredValues[k] - predicted[k];
    if (Number.isNaN(error)) continue;
    n += 1;
    sum += error;
    squares += error * error;
    largest = Math.max(largest, Math.abs(error));
  }
  return { n, rms: Math.sqrt(squares / n), mean: sum / n, largest };
}
