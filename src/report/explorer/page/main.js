// Puts the page together and keeps it so.

function about() {
  const counts = PAGE.sets.map((set) => `${set.count.toLocaleString("en")} readings of ${set.title.toLowerCase()}`);
  byId("about").textContent = `${counts.join(" and ")}${PAGE.campaign ? ` of ${PAGE.campaign}` : ""}, ${Object.keys(PAGE.sessions).length.toLocaleString("en")} sessions.`;
  const simulated = Object.values(PAGE.sessions).filter((s) => s.simulated).length;
  const are = simulated === 1 ? "is" : "are";
  if (simulated) byId("about").append(element("span", { className: "simulated" }, ` ${simulated} of the sessions ${are} simulated.`));
  const thinned = PAGE.sets.filter((set) => set.count < set.of);
  const sample = byId("sample");
  sample.hidden = !thinned.length;
  if (thinned.length) {
    const first = levelsOf(PAGE.sets[0], "campaign")[0];
    const shares = thinned.map((set) => `${set.count.toLocaleString("en")} of ${set.of.toLocaleString("en")} readings of ${set.title.toLowerCase()}`);
    sample.replaceChildren(`This page has a sample, spread evenly over all sessions: ${shares.join(" and ")}. Numbers beside the plot are of the sample. `, element("code", {}, inFull(first)), " makes a page of one campaign in full; derived/rows.parquet has every reading.");
  }
  byId("foot").append(`pipeline ${PAGE.version}, inputs ${PAGE.input.slice(0, 19)}…. The same numbers: `, ...["tables/plateaus.csv", "tables/model_comparison.csv", "findings.json"].flatMap((file, k) => [k ? ", " : "", element("a", { href: file }, file)]), ". Axes: uPlot 1.6.32 (MIT, © Leon Sorokin).");
}

// Draws everything as chosen; what the axes show has changed if `afresh`, else a zoom stays.
function refresh(afresh = false) {
  if (afresh) state.zoom = null;
  hideTip();
  fillControls();
  const { set, places } = drawScatter();
  sayErrors(set, places);
  fillTable(set, places);
  fillAnswers();
  toAddress();
}

const hideTip = () => (byId("tip").hidden = true);

function resize() {
  scatter.plot?.setSize(plotSize());
}

function restore() {
  fromAddress();
  const zoom = state.zoom;
  refresh();
  if (zoom) zoomTo(zoom);
  const open = readingOf(setOf(), state.reading);
  if (open >= 0) showReading(setOf(), open);
  else closeReading();
}

about();
if (PAGE.sets.length) {
  bindControls();
  restore();
  let waiting = 0;
  addEventListener("resize", () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      resize();
      const open = readingOf(setOf(), state.reading);
      if (open >= 0) showReading(setOf(), open);
    }, 120);
  });
  addEventListener("hashchange", () => location.hash !== ownHash && restore());
  dark.addEventListener("change", restore);
} else {
  byId("view").textContent = "There are no readings.";
}
