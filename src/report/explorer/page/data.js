// The data of the page: columns come as base64 and leave as arrays.

const PAGE = JSON.parse(document.getElementById("data").textContent);

const bytesOf = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;

// Values of a column, one a reading: numbers (NaN for none) or texts (null for none).
function decode(column) {
  if (column.f32 !== undefined) return new Float32Array(bytesOf(column.f32));
  const codes = new Uint16Array(bytesOf(column.u16));
  if (column.is_text) return Array.from(codes, (k) => column.levels[k]);
  const levels = column.levels.map((x) => (x === null ? NaN : x));
  return Float64Array.from(codes, (k) => levels[k]);
}

for (const set of PAGE.sets) {
  set.byName = new Map();
  for (const column of set.columns) {
    column.data = decode(column);
    delete column.f32;
    delete column.u16;
    set.byName.set(column.name, column);
  }
  set.measuredValues = set.byName.get(set.measured).data;
  set.modelOf = new Map(set.models.map((model) => [model.column, model]));
}

const TRACES = new Map(PAGE.traces.map((trace) => [`${trace.session}\n${trace.log}`, trace]));

const value = (set, name, k) => set.byName.get(name)?.data[k] ?? null;

// Name, unit and values of what can stand on an axis. A quantity of the chosen model changes with it.
function quantity(set, name, model) {
  const predicted = set.byName.get(model)?.data;
  const about = { unit: set.unit, of: set.modelOf.get(model)?.label ?? "" };
  if (name === "residual" && predicted) {
    const data = set.measuredValues.map((x, k) => x - predicted[k]);
    return { ...about, label: "measured minus predicted", data };
  }
  if (name === "predicted" && predicted) return { ...about, label: "predicted", data: predicted };
  const column = set.byName.get(name);
  return column && { label: column.label, unit: column.unit, of: "", data: column.data };
}

// What stands beside an axis.
const titled = (q) => q.label + (q.unit ? `, ${q.unit.replace(".", " ")}` : "");

// A number as people read it: `digits` significant ones, without exponent where that is short.
function shown(x, digits = 4) {
  if (x === null || Number.isNaN(x)) return "–";
  if (Number.isInteger(x) && Math.abs(x) < 1e7) return String(x).replace("-", "−");
  const size = Math.abs(x);
  const places = size === 0 ? 0 : Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  const text = size >= 1e-4 && size < 1e7 ? x.toFixed(Math.min(places, 8)) : x.toExponential(digits - 1);
  return text.replace("-", "−");
}

const withUnit = (x, unit, digits) => shown(x, digits) + (unit && !Number.isNaN(x) ? ` ${unit.replace(".", " ")}` : "");

// An element with attributes and children.
function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, given] of Object.entries(attributes)) {
    if (key in made && key !== "list") made[key] = given;
    else made.setAttribute(key, given);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}

const byId = (id) => document.getElementById(id);
