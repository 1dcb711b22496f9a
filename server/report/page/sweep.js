// The page of a sweep: verdict, the curve, its table, what the gates say. All numbers are those of sweep.json.

const met = (point) => point.met && isNumber(point.texture_bytes);

function sweepVerdict(sweep) {
  const worse = (field(sweep, "baseline.regressions") || []).length, failed = (sweep.acceptance || []).filter((one) => !one.passed).length;
  const unmet = (sweep.unmet_ms || []).length;
  const held = [sweep.baseline ? "the baseline" : null, sweep.acceptance ? "the criteria" : null].filter(Boolean).join(" and ");
  if (sweep.passed && held) return ["good", "Passed", `nothing is worse than ${held} ${sweep.acceptance ? "allow" : "allows"}.`];
  if (sweep.passed) return ["good", "Every budget met", "at each of them the time bound of every view lies within the budget."];
  const reasons = [
    worse > 0 ? `${count(worse)} ${worse === 1 ? "budget is" : "budgets are"} worse than in the baseline` : null,
    failed > 0 ? `${count(failed)} ${failed === 1 ? "criterion is" : "criteria are"} not met` : null,
    unmet > 0 ? `${count(unmet)} of ${count(sweep.points.length)} budgets cannot be met everywhere` : null,
  ].filter(Boolean);
  return ["bad", worse + failed > 0 ? "Failed" : "Not every budget met", `${reasons.join("; ")}.`];
}

/// Values of one curve at the budgets of all; a logarithmic axis has no place for 0.
function valuesAt(budgets, points, value) {
  const known = new Map(points.map((point) => [point.budget_ms, value(point)]));
  return budgets.map((budget) => (known.get(budget) > 0 ? known.get(budget) : null));
}

function curveSection(sweep) {
  const points = sweep.points, before = field(sweep, "baseline.points") || [];
  const budgets = [...new Set([...points, ...before].map((point) => point.budget_ms))].sort((a, b) => a - b);
  const series = [
    { name: "textures", colour: "--after", points: true, values: valuesAt(budgets, points.filter(met), (point) => point.texture_bytes) },
    { name: "textures, some views unsolved", colour: "--bad", marksOnly: true, points: true, values: valuesAt(budgets, points.filter((point) => !met(point)), (point) => point.texture_bytes) },
    { name: "lower bound", colour: "--soft", dash: [3, 4], points: true, values: valuesAt(budgets, points, (point) => point.memory_lower_bound_bytes) },
    { name: "baseline", colour: "--before", dash: [8, 5], points: true, values: valuesAt(budgets, before.filter(met), (point) => point.texture_bytes) },
    { name: "baseline, some views unsolved", colour: "--series-3", marksOnly: true, points: true, values: valuesAt(budgets, before.filter((point) => !met(point)), (point) => point.texture_bytes) },
  ].filter((one) => one.values.some((value) => value !== null));
  const chart = series.length === 0 ? null : lineChart({
    label: `Memory of the textures against the frame-time budget, at ${points.length} budgets`, height: 420, xs: budgets, series,
    x: { label: "frame-time budget, ms", format: (value) => significant(value, 4) }, y: { label: "memory", format: bytes, log: true },
  });
  const none = points.filter((point) => point.texture_bytes === 0).length;
  const lead = `Budgets: ${sweep.budgets_from}. Each point is what placing at this budget alone would give. The lower bound holds for the same candidates, regions and time bound.`
    + (none > 0 ? ` At ${count(none)} of the budgets nothing needs placing; 0 has no place on a logarithmic axis.` : "");
  return section("curve", "Memory against the budget", lead, chart ? element("figure", {}, chart) : element("p", {}, "No budget needs any memory."));
}

function pointState(point) {
  if (point.met) return point.cpv.count === 0 ? "nothing to place" : "met";
  return `${count(point.cpv.unsolved)} unsolved`;
}

function pointsSection(sweep) {
  const columns = [
    { title: "budget", number: true, text: (point) => `${significant(point.budget_ms, 6)} ms` },
    { title: "outcome", text: pointState }, { title: "slow regions", number: true, text: (point) => count(point.cpv.count) },
    { title: "impostors", number: true, text: (point) => count(point.impostors) }, { title: "textures", number: true, text: (point) => bytes(point.texture_bytes) },
    { title: "with geometry and levels of detail", number: true, text: (point) => bytes(point.total_bytes) }, { title: "lower bound", number: true, text: (point) => bytes(point.memory_lower_bound_bytes) },
    { title: "gap", number: true, text: (point) => (point.texture_bytes > 0 ? percent(point.gap) : NONE) },
    { title: "reachable", text: (point) => (point.reachable ? "yes" : "not promised") },
    { title: "time", number: true, text: (point) => seconds(point.seconds) },
    { title: "bakes, recalled", number: true, text: (point) => `${count(field(point, "bakes.baked"))}, ${count(field(point, "bakes.recalled"))}` },
  ];
  return section("points", "The numbers", "\u201cReachable\u201d is what the survey promised before any bake, from cautious costs. Recalled bakes were made for a looser budget.", table(columns, sweep.points, "Points of the curve"));
}

function baselineSection(sweep) {
  const baseline = sweep.baseline;
  if (!baseline) return null;
  const value = (one, key) => (one.kind === "memory" ? bytes(one[key]) : `${count(one[key])} unsolved`);
  const columns = [
    { title: "budget", number: true, text: (one) => `${significant(one.budget_ms, 6)} ms` }, { title: "before", number: true, text: (one) => value(one, "before") },
    { title: "now", number: true, text: (one) => value(one, "after") },
  ];
  const apart = baseline.not_compared_ms.length === 0 ? "" : ` Not in both curves, so not compared: ${baseline.not_compared_ms.map((budget) => `${significant(budget, 6)} ms`).join(", ")}.`;
  const lead = `${count(baseline.compared_ms.length)} budgets compared; memory may grow by ${percent(baseline.tolerance)}.${apart}`;
  return section("baseline", "Since the baseline", lead, baseline.regressions.length === 0 ? element("p", {}, "Nothing is worse.") : table(columns, baseline.regressions, "Regressions"));
}

function acceptanceSection(sweep) {
  if (!sweep.acceptance) return null;
  return section("acceptance", "Criteria", "", element("ul", {}, ...sweep.acceptance.map((one) => element("li", {}, one.sentence))));
}

function leftOutOfSweep(sweep) {
  const told = new Map((sweep.left_out || []).map((entry) => [`${entry.stage}: ${entry.reason}`, null]));
  for (const point of sweep.points)
    for (const entry of point.left_out || []) {
      const text = `${entry.stage}: ${entry.reason}`;
      if (!told.has(text)) told.set(text, []);
      if (told.get(text) !== null) told.get(text).push(`${significant(point.budget_ms, 6)} ms`);
    }
  const entries = [...told].map(([text, budgets]) => (budgets === null ? text : `${text} (at ${budgets.join(", ")})`));
  return leftOutSection({ metrics: { left_out: entries } });
}

function sweepTiles(sweep) {
  const survey = sweep.survey || {}, solved = sweep.points.filter(met);
  const memories = solved.map((point) => point.texture_bytes);
  return [
    ["Budgets met", `${count(solved.length)} of ${count(sweep.points.length)}`, `${significant(sweep.points[0].budget_ms, 6)} to ${significant(sweep.points[sweep.points.length - 1].budget_ms, 6)} ms`],
    memories.length === 0 ? null : ["Memory where met", `${bytes(Math.min(...memories))} to ${bytes(Math.max(...memories))}`, "textures of the impostors"],
    isNumber(survey.reachable_all_ms) ? ["Lowest budget for all views", milliseconds(survey.reachable_all_ms), "as the survey promises it"] : null,
    isNumber(survey.worst_bound_ms) ? ["Highest bound of a region", milliseconds(survey.worst_bound_ms), "above it nothing needs placing"] : null,
  ].filter(Boolean);
}

function tileOf([title, figure, note]) {
  return element("div", { class: "tile" }, element("dt", {}, title), element("dd", { class: "figure" }, figure), element("dd", { class: "note" }, note));
}

function sweepContext(sweep) {
  const camera = sweep.camera;
  return [
    `${count(field(sweep, "scene.objects"))} objects, ${count(field(sweep, "scene.triangles"))} triangles`, `on ${sweep.target.id}`,
    `${camera.width} x ${camera.height} pixels, ${significant(camera.fov_y_deg, 3)}\u00b0 field of view`,
  ].join(" \u00b7 ");
}

function buildSweepPage(sweep) {
  const name = field(sweep, "scene.name") || "scene";
  document.title = `${name}, swept \u2014 Standin`;
  const [tone, word, sentence] = sweepVerdict(sweep);
  const sections = [curveSection(sweep), pointsSection(sweep), baselineSection(sweep), acceptanceSection(sweep), stagesSection({ metrics: sweep }), leftOutOfSweep(sweep), wordsSection()]
    .filter((made) => made !== null);
  const links = sections.map((made) => element("li", {}, element("a", { href: `#${made.id}` }, made.querySelector("h2").textContent)));
  document.getElementById("top").append(
    element("h1", {}, name), element("p", { class: "context" }, sweepContext(sweep)),
    element("div", { class: `verdict ${tone}`, role: "status" }, element("strong", {}, word), element("span", {}, sentence)),
    element("dl", { class: "tiles" }, ...sweepTiles(sweep).map(tileOf)), element("nav", { "aria-label": "Sections" }, element("ul", {}, ...links)));
  document.getElementById("content").append(...sections);
  document.getElementById("end").append(element("p", {}, "Standin sweep. All numbers: sweep.json."));
}

buildSweepPage(JSON.parse(document.getElementById("report-data").textContent));
keepChartsFresh();
