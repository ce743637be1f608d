// Colours and shapes of marks. The palette is that of the figures (Okabe and Ito 2008); with more groups than colours the shape changes too.

const dark = matchMedia("(prefers-color-scheme: dark)");
const INKS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
const INKS_DARK = ["#4aa8e0", "#f0843c", "#2fc49b", "#e0a1c5", "#efb744", "#86ccf2"];
const SHAPES = ["circle", "square", "triangle", "diamond", "cross"];
// From low to high, told apart without colour vision (after cividis).
const RAMP = [[0, 48, 111], [61, 78, 108], [112, 113, 115], [163, 151, 114], [214, 193, 96], [254, 232, 56]];
const RAMP_DARK = [[58, 110, 190], [104, 128, 172], [142, 147, 150], [181, 170, 128], [219, 199, 104], [254, 232, 80]];

const inks = () => (dark.matches ? INKS_DARK : INKS);
const colourOf = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function ramp(share) {
  const stops = dark.matches ? RAMP_DARK : RAMP;
  const at = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const k = Math.min(Math.floor(at), stops.length - 2);
  const mixed = stops[k].map((low, c) => Math.round(low + (at - k) * (stops[k + 1][c] - low)));
  return `rgb(${mixed.join(" ")})`;
}

// For every reading its ink and shape, and what a legend says of them.
function colouring(set, places) {
  const q = quantity(set, state.colour, state.model);
  if (!q) return { ink: () => inks()[0], shape: () => "circle", groups: [], title: "" };
  if (set.byName.get(state.colour)?.is_text) {
    const all = levelsOf(set, state.colour);
    const used = new Set(places.map((k) => q.data[k] ?? NOT_NAMED));
    const names = all.filter((name) => used.has(name));
    const place = new Map(names.map((name, k) => [name, k]));
    const ink = (k) => inks()[k % INKS.length];
    const shape = (k) => SHAPES[Math.floor(k / INKS.length) % SHAPES.length];
    const at = (k) => place.get(q.data[k] ?? NOT_NAMED) ?? 0;
    const groups = names.map((name, k) => ({ name, ink: ink(k), shape: shape(k) }));
    return { ink: (k) => ink(at(k)), shape: (k) => shape(at(k)), groups, title: q.label };
  }
  let [low, high] = [Infinity, -Infinity];
  for (const k of places) {
    if (!Number.isFinite(q.data[k])) continue;
    low = Math.min(low, q.data[k]);
    high = Math.max(high, q.data[k]);
  }
  const share = (x) => (high > low ? (x - low) / (high - low) : 0.5);
  const ink = (k) => (Number.isFinite(q.data[k]) ? ramp(share(q.data[k])) : colourOf("--faint"));
  return { ink, shape: () => "circle", groups: [], range: [low, high], unit: q.unit, title: titled(q) };
}

// The outline of a mark about a point.
function outline(path, shape, x, y, r) {
  if (shape === "square") path.rect(x - 0.85 * r, y - 0.85 * r, 1.7 * r, 1.7 * r);
  else if (shape === "triangle") polygon(path, [[x, y - 1.15 * r], [x + r, y + 0.75 * r], [x - r, y + 0.75 * r]]);
  else if (shape === "diamond") polygon(path, [[x, y - 1.25 * r], [x + 1.25 * r, y], [x, y + 1.25 * r], [x - 1.25 * r, y]]);
  else if (shape === "cross") {
    const [a, b] = [0.4 * r, 1.1 * r];
    polygon(path, [[-a, -b], [a, -b], [a, -a], [b, -a], [b, a], [a, a], [a, b], [-a, b], [-a, a], [-b, a], [-b, -a], [-a, -a]].map(([u, v]) => [x + u, y + v]));
  } else {
    path.moveTo(x + r, y);
    path.arc(x, y, r, 0, 2 * Math.PI);
  }
}

function polygon(path, corners) {
  corners.forEach(([x, y], k) => (k ? path.lineTo(x, y) : path.moveTo(x, y)));
  path.closePath();
}

// A mark as a picture for the legend.
function swatch(ink, shape) {
  const canvas = element("canvas", { width: 28, height: 28, className: "swatch", ariaHidden: "true" });
  const context = canvas.getContext("2d");
  context.fillStyle = ink;
  context.beginPath();
  outline(context, shape, 14, 14, 9);
  context.fill();
  return canvas;
}

function drawLegend(marks) {
  const legend = byId("legend");
  legend.replaceChildren();
  if (marks.range && marks.range[0] <= marks.range[1]) {
    const stops = [0, 0.2, 0.4, 0.6, 0.8, 1].map(ramp).join(",");
    const bar = element("span", { className: "ramp", style: `background:linear-gradient(to right,${stops})` });
    legend.append(element("span", { className: "title" }, marks.title), shown(marks.range[0]), bar, shown(marks.range[1]));
    return;
  }
  const most = 36;
  legend.append(element("span", { className: "title" }, marks.title));
  for (const group of marks.groups.slice(0, most)) legend.append(element("span", { className: "group" }, swatch(group.ink, group.shape), group.name));
  if (marks.groups.length > most) legend.append(`and ${marks.groups.length - most} more, whose colours repeat`);
}
