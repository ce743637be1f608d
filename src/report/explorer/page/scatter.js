// The plot of all readings that are shown: axes, zoom and scales are uPlot's, the marks are drawn here.

const scatter = { plot: null, places: [], x: null, y: null, marks: null, points: null, hover: -1 };
const REACH = 22;

const font = (weight = "") => `${weight} 13px system-ui, sans-serif`.trim();
const axisOf = (label, more = {}) => ({
  label, labelFont: font(), font: font(), labelSize: 26, labelGap: 2, stroke: () => colourOf("--ink"),
  grid: { stroke: () => colourOf("--grid"), width: 1 }, ticks: { stroke: () => colourOf("--rule"), width: 1, size: 5 },
  values: (_, ticks) => ticks.map((x) => (x === null ? "" : String(Number(x.toPrecision(10))).replace("-", "−"))), ...more,
});

// Ends of the data with a margin; a single value gets some room.
function span(values, places) {
  let [low, high] = [Infinity, -Infinity];
  for (const k of places) {
    low = Math.min(low, values[k]);
    high = Math.max(high, values[k]);
  }
  if (!(low <= high)) return [0, 1];
  const margin = 0.04 * (high - low) || 0.05 * Math.abs(low) || 1;
  return [low - margin, high + margin];
}

const plotSize = () => {
  const width = Math.max(280, byId("plot").clientWidth);
  return { width, height: Math.round(Math.min(Math.max(0.62 * width, 300), Math.max(340, innerHeight - 260))) };
};

function drawScatter() {
  const set = setOf();
  const [x, y] = [quantity(set, state.x, state.model), quantity(set, state.y, state.model)];
  const places = shownReadings(set, x.data, y.data);
  const marks = colouring(set, places);
  Object.assign(scatter, { places, x, y, marks, hover: -1, points: null, order: null });
  scatter.plot?.destroy();
  const zoom = state.zoom;
  const [across, up] = [span(x.data, places), span(y.data, places)];
  const options = {
    ...plotSize(), legend: { show: false }, scales: { x: { time: false, range: (_, low, high) => (low === null ? across : [low, high]) }, y: { range: (_, low, high) => (low === null ? up : [low, high]) } },
    cursor: { points: { show: false }, drag: { x: true, y: true, uni: 12, dist: 6 }, x: true, y: true },
    axes: [axisOf(titled(x), { size: 34 }), axisOf(titled(y), { size: 62 })],
    series: [{}, { paths: () => null, points: { show: false } }],
    hooks: { draw: [drawMarks], setScale: [noteZoom], ready: [listen] },
  };
  const ends = zoom ? [[zoom[0], zoom[1]], [zoom[2], zoom[3]]] : [across, up];
  scatter.settling = true;
  scatter.plot = new uPlot(options, [ends[0], ends[1]], byId("plot"));
  scatter.plot.batch(() => {
    scatter.plot.setScale("x", { min: ends[0][0], max: ends[0][1] });
    scatter.plot.setScale("y", { min: ends[1][0], max: ends[1][1] });
  });
  scatter.full = [across, up];
  queueMicrotask(() => (scatter.settling = false));
  drawLegend(marks);
  byId("plot").setAttribute("aria-label", `Scatter plot of ${places.length} readings: ${titled(y)} over ${titled(x)}${y.of ? ` by ${y.of}` : ""}, coloured by ${marks.title}`);
  return { set, places };
}

// Marks that share ink and shape are one path.
function drawMarks(u) {
  const { places, x, y, marks } = scatter;
  const { ctx, bbox } = u;
  const ratio = devicePixelRatio || 1;
  const size = (places.length > 3000 ? 2.3 : places.length > 600 ? 3 : 4) * ratio;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  if (state.y === "residual") drawZero(u);
  const paths = new Map();
  scatter.points = new Float64Array(2 * places.length);
  places.forEach((k, i) => {
    const [px, py] = [u.valToPos(x.data[k], "x", true), u.valToPos(y.data[k], "y", true)];
    scatter.points[2 * i] = px / ratio;
    scatter.points[2 * i + 1] = py / ratio;
    const [ink, shape] = [marks.ink(k), marks.shape(k)];
    const key = `${ink} ${shape}`;
    if (!paths.has(key)) paths.set(key, { ink, path: new Path2D() });
    outline(paths.get(key).path, shape, px, py, size);
  });
  ctx.globalAlpha = places.length > 3000 ? 0.6 : 0.8;
  for (const { ink, path } of paths.values()) {
    ctx.fillStyle = ink;
    ctx.fill(path);
  }
  ctx.globalAlpha = 1;
  const open = readingOf(setOf(), state.reading);
  for (const [k, width] of [[open, 2.5], [scatter.hover, 1.5]]) {
    if (k < 0 || !Number.isFinite(x.data[k]) || !Number.isFinite(y.data[k])) continue;
    ctx.strokeStyle = colourOf("--ink");
    ctx.lineWidth = width * ratio;
    ctx.beginPath();
    outline(ctx, marks.shape(k), u.valToPos(x.data[k], "x", true), u.valToPos(y.data[k], "y", true), size + 3 * ratio);
    ctx.stroke();
  }
  ctx.restore();
}

// No residual.
function drawZero(u) {
  const at = u.valToPos(0, "y", true);
  u.ctx.strokeStyle = colourOf("--rule");
  u.ctx.lineWidth = devicePixelRatio || 1;
  u.ctx.beginPath();
  u.ctx.moveTo(u.bbox.left, at);
  u.ctx.lineTo(u.bbox.left + u.bbox.width, at);
  u.ctx.stroke();
}

function noteZoom(u) {
  if (scatter.settling || u !== scatter.plot) return;
  const { x, y } = u.scales;
  const ends = [x.min, x.max, y.min, y.max];
  const full = scatter.full.flat();
  const isFull = ends.every((end, k) => Math.abs(end - full[k]) <= 1e-9 * (Math.abs(full[k]) || 1));
  state.zoom = isFull ? null : ends;
  toAddress();
}

// The reading next to a place of the pointer; -1 where none is near.
function nearest(left, top) {
  const u = scatter.plot;
  const ratio = devicePixelRatio || 1;
  const [px, py] = [left + u.bbox.left / ratio, top + u.bbox.top / ratio];
  let [best, least] = [-1, REACH * REACH];
  scatter.places.forEach((k, i) => {
    const [dx, dy] = [scatter.points[2 * i] - px, scatter.points[2 * i + 1] - py];
    const far = dx * dx + dy * dy;
    if (far < least) [best, least] = [k, far];
  });
  return best;
}

function listen(u) {
  let pressed = null;
  const at = (event) => {
    const box = u.over.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  u.over.addEventListener("mousemove", (event) => hover(nearest(...at(event)), event));
  u.over.addEventListener("mouseleave", () => hover(-1));
  u.over.addEventListener("mousedown", (event) => (pressed = at(event)));
  u.over.addEventListener("click", (event) => {
    const [x, y] = at(event);
    if (pressed && Math.hypot(x - pressed[0], y - pressed[1]) > 5) return;
    const k = nearest(x, y);
    if (k >= 0) openReading(k);
  });
  u.over.addEventListener("dblclick", () => zoomTo(null));
}

// Shows a part of the plot, or all of it.
function zoomTo(ends) {
  const [x, y] = ends ? [ends.slice(0, 2), ends.slice(2)] : scatter.full;
  scatter.plot.batch(() => {
    scatter.plot.setScale("x", { min: x[0], max: x[1] });
    scatter.plot.setScale("y", { min: y[0], max: y[1] });
  });
}

// Marks a reading and says what it is, beside the pointer or the mark.
function hover(k, event) {
  if (k !== scatter.hover) {
    scatter.hover = k;
    scatter.plot.redraw(false);
  }
  const tip = byId("tip");
  tip.hidden = k < 0;
  if (k < 0) return;
  tip.replaceChildren(...tipOf(setOf(), k));
  const [x, y] = event ? [event.clientX, event.clientY] : placeOf(k);
  const box = tip.getBoundingClientRect();
  tip.style.left = `${Math.max(4, Math.min(x + 14, innerWidth - box.width - 8))}px`;
  tip.style.top = `${Math.max(4, y + 14 + box.height > innerHeight ? y - box.height - 10 : y + 14)}px`;
}

function placeOf(k) {
  const i = scatter.places.indexOf(k);
  const box = byId("plot").querySelector("canvas").getBoundingClientRect();
  return [box.left + scatter.points[2 * i], box.top + scatter.points[2 * i + 1]];
}

// Moves from reading to reading along one of the axes.
function step(axis, by) {
  scatter.order ??= {};
  const values = scatter[axis].data;
  const other = scatter[axis === "x" ? "y" : "x"].data;
  scatter.order[axis] ??= [...scatter.places].sort((a, b) => values[a] - values[b] || other[a] - other[b]);
  const order = scatter.order[axis];
  if (!order.length) return;
  const open = readingOf(setOf(), state.reading);
  const from = order.indexOf(scatter.hover >= 0 ? scatter.hover : open);
  const next = from >= 0 ? from + by : (by > 0 && by < Infinity) || by === -Infinity ? 0 : order.length - 1;
  const to = Math.min(Math.max(next, 0), order.length - 1);
  hover(order[to]);
  byId("live").textContent = spoken(setOf(), order[to], to + 1, order.length);
}

function onKey(event) {
  const steps = { ArrowRight: ["x", 1], ArrowLeft: ["x", -1], ArrowUp: ["y", 1], ArrowDown: ["y", -1], PageUp: ["x", 25], PageDown: ["x", -25], Home: ["x", -Infinity], End: ["x", Infinity] };
  if (steps[event.key]) step(...steps[event.key]);
  else if (event.key === "Enter" && scatter.hover >= 0) openReading(scatter.hover, true);
  else if (event.key === "Escape") {
    hover(-1);
    closeReading();
  } else return;
  event.preventDefault();
}
