// The page from the top: verdict, headline figures, then the sections that this job has numbers for.

function verdict({ metrics }) {
  const cpv = metrics.cpv || {}, verify = metrics.verify || {};
  const budget = milliseconds(metrics.budget_ms);
  if (!isNumber(metrics.budget_ms)) return ["plain", "Survey", `${field(metrics, "survey.verdict") || "how long frames take, and why; no budget was given"}.`];
  if (!isNumber(cpv.solved)) return ["plain", "Survey", isNumber(cpv.count) ? `${count(cpv.count)} regions may exceed ${budget}.` : `Frame times against a budget of ${budget}.`];
  if (cpv.count === 0) return ["good", "Nothing to do", `no view exceeds ${budget}, so no impostor is needed.`];
  if (cpv.unsolved > 0) return ["bad", "Budget not met everywhere", `${count(cpv.unsolved)} of ${count(cpv.count)} slow regions cannot be brought under ${budget}; the rest is solved.`];
  if (verify.over_budget_measured > 0) return ["bad", "Bound met, measurements not", `every region's bound lies within ${budget}, but ${count(verify.over_budget_measured)} of ${count(verify.views)} measured frames were slower.`];
  if (metrics.mode === "sampled") return ["plain", "Budget met by the views that were sampled", `of each region some single views, with a margin of 5 %, lie within ${budget}. Nothing is promised of the others.`];
  return ["good", "Budget met", `the time bound of every view in the view space lies within ${budget}.`];
}

function worstFrame(metrics, when) {
  const measured = field(metrics, `verify.frame_ms_${when}.max`);
  if (isNumber(measured)) return { value: measured, how: "measured" };
  const estimates = (field(metrics, "verify.frames") || []).map((frame) => frame[`estimated_${when}_ms`]).filter(isNumber);
  if (estimates.length > 0) return { value: Math.max(...estimates), how: "estimated" };
  return { value: when === "before" ? field(metrics, "survey.worst_frame_ms") : undefined, how: "estimated" };
}

function frameTile(metrics) {
  const before = worstFrame(metrics, "before"), after = worstFrame(metrics, "after");
  if (!isNumber(before.value)) return null;
  const figure = isNumber(after.value) ? `${significant(before.value, 3)} \u2192 ${milliseconds(after.value)}` : milliseconds(before.value);
  const how = before.how === after.how || !isNumber(after.value) ? before.how : `${before.how}, then ${after.how}`;
  return ["Worst frame of the sampled views", figure, isNumber(field(metrics, "verify.views")) ? `${how}, ${count(metrics.verify.views)} views` : how];
}

function cpvTile(metrics) {
  const cpv = metrics.cpv || {};
  if (!isNumber(cpv.count)) return null;
  return isNumber(cpv.solved) ? ["Slow regions solved", `${count(cpv.solved)} of ${count(cpv.count)}`, `with ${count(field(metrics, "impostors.count") || 0)} impostors`]
    : ["Slow regions", count(cpv.count), `time bound over ${milliseconds(metrics.budget_ms)}`];
}

function memoryTile(metrics) {
  const memory = field(metrics, "memory.total_bytes");
  if (!isNumber(memory)) return null;
  const gap = field(metrics, "bound.gap"), lods = field(metrics, "memory.lods_bytes");
  const note = isNumber(gap) ? `at most ${percent(gap)} of the textures could be saved` : "";
  if (!lods) return ["Memory of the impostors", bytes(memory), note];
  return ["Memory of impostors and levels of detail", bytes(memory), `${bytes(lods)} of it levels of detail; ${note}`];
}

function reachTile(metrics) {
  const survey = metrics.survey || {};
  if (!isNumber(survey.reachable_all_ms)) return null;
  const note = `99 % of views: at most ${milliseconds(survey.reachable_p99_ms)}, 90 %: at most ${milliseconds(survey.reachable_p90_ms)}`;
  return ["Lowest budget for all views", milliseconds(survey.reachable_all_ms), note];
}

function tile([title, figure, note]) {
  return element("div", { class: "tile" }, element("dt", {}, title), element("dd", { class: "figure" }, figure), note ? element("dd", { class: "note" }, note) : null);
}

function contextLine({ metrics, job }) {
  const camera = job.camera || {};
  return [
    isNumber(field(metrics, "scene.objects")) ? `${count(metrics.scene.objects)} objects, ${count(metrics.scene.triangles)} triangles` : null,
    isNumber(metrics.budget_ms) ? `budget ${milliseconds(metrics.budget_ms)}` : null,
    field(job, "target.id") ? `on ${job.target.id}` : null,
    camera.width ? `${camera.width} x ${camera.height} pixels, ${significant(camera.fov_y_deg, 3)}\u00b0 field of view` : null,
    field(job, "view_space.kind") ? `view space: ${job.view_space.kind}` : null,
  ].filter(Boolean).join(" \u00b7 ");
}

const SECTIONS = [heatMapSection, framesSection, viewsSection, unsolvedSection, causesSection, memorySection, atlasSection, curvesSection, stagesSection, leftOutSection, wordsSection];

function buildPage(data) {
  const { metrics } = data;
  const name = data.job.scene_name || "scene";
  document.title = `${name}${isNumber(metrics.budget_ms) ? ` at ${milliseconds(metrics.budget_ms)}` : ""} \u2014 Standin`;
  const [tone, word, sentence] = verdict(data);
  const sections = SECTIONS.map((make) => make(data)).filter((made) => made !== null);
  const links = sections.map((made) => element("li", {}, element("a", { href: `#${made.id}` }, made.querySelector("h2").textContent)));
  const tiles = [frameTile, cpvTile, memoryTile, reachTile].map((make) => make(metrics)).filter((made) => made !== null);
  document.getElementById("top").append(
    element("h1", {}, name), element("p", { class: "context" }, contextLine(data)),
    element("div", { class: `verdict ${tone}`, role: "status" }, element("strong", {}, word), element("span", {}, sentence)),
    element("dl", { class: "tiles" }, ...tiles.map(tile)), element("nav", { "aria-label": "Sections" }, element("ul", {}, ...links)));
  document.getElementById("content").append(...sections);
  document.getElementById("end").append(element("p", {}, `Standin report. All numbers: metrics.json. What to draw for a view: placement.json.`));
}

buildPage(JSON.parse(document.getElementById("report-data").textContent));
keepChartsFresh();
