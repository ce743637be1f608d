// What was found, campaign by campaign, and what the expected error is made of.

function fillAnswers() {
  const set = setOf();
  const answers = PAGE.answers.filter((a) => a.kind === set.kind && (!state.campaign || a.campaign === state.campaign));
  const section = byId("answers");
  section.hidden = !answers.length;
  const largest = Math.max(...answers.map((a) => a.budget.reduce((sum, b) => sum + b.variance, 0)), Number.MIN_VALUE);
  const sources = [...new Set(answers.flatMap((a) => a.budget.map((b) => b.label)))];
  section.replaceChildren(element("h2", {}, "Effects found, and the sources of the expected error"), ...answers.map((a) => answerOf(a, sources, largest)));
}

// Ink of a source: the same in every campaign.
const inkOfSource = (sources, label) => (sources.indexOf(label) < INKS.length ? inks()[sources.indexOf(label)] : colourOf("--faint"));

function answerOf(answer, sources, largest) {
  const total = answer.budget.reduce((sum, b) => sum + b.variance, 0);
  const number = (x) => withUnit(x ?? NaN, answer.unit, 3);
  const parts = [element("h3", {}, answer.title, answer.simulated ? element("small", {}, " simulated") : null)];
  parts.push(...answer.sentences.map((text) => element("p", {}, text)));
  if (answer.before.heldout !== null) {
    parts.push(element("p", { className: "numbers" }, `RMSE on ${answer.held_out}: without effects `, element("b", {}, number(answer.before.heldout)), ", with effects ", element("b", {}, number(answer.after.heldout)), `; on the readings of the fit ${number(answer.before.train)} and ${number(answer.after.train)}.`));
  }
  if (total > 0) {
    const bars = answer.budget.filter((b) => b.variance > 0).map((b) => element("span", { className: "part", style: `width:${(100 * b.variance) / total}%;background:${inkOfSource(sources, b.label)}`, title: `${b.label}: ${number(b.rmse)}, ${Math.round((100 * b.variance) / total)}% of the variance` }));
    const bar = element("div", { className: "budget", role: "img", ariaLabel: `Shares of the expected variance, ${number(answer.expected)} in all; the numbers follow`, style: `width:${Math.max(12, 100 * Math.sqrt(total / largest))}%` }, bars);
    const rows = answer.budget.map((b) => element("li", {}, element("span", { className: "key", style: `background:${inkOfSource(sources, b.label)}` }), ` ${b.label} `, element("b", {}, number(b.rmse)), ` (${Math.round((100 * b.variance) / total)}%)`));
    parts.push(element("p", { className: "numbers" }, "Expected on an unseen one: ", element("b", {}, number(answer.expected)), ", combining in quadrature"), bar, element("ul", { className: "sources" }, rows));
  }
  return element("article", {}, parts);
}
