// The sections of the page, one function each: from the job's numbers to elements, or nothing where the job has no such numbers.

function section(id, title, lead, ...children) {
  const heading = element("h2", { id: `${id}-title` }, title);
  return element("section", { id, "aria-labelledby": `${id}-title` }, heading, lead ? element("p", { class: "soft" }, lead) : null, ...children);
}

function heatMapSection({ metrics }) {
  const cells = (metrics.heat_map || []).filter((cell) => isNumber(cell.before_ms));
  if (cells.length === 0) return null;
  const lead = "The view space from above, x to the right and z downwards. A cell's colour is the time bound of its slowest view direction: a time that its frames do not exceed, "
    + "at the coverage the target file states. Blue is within " + (isNumber(metrics.budget_ms) ? "the budget." : "half of the slowest time, since the job has no budget.");
  return section("map", "Where it is slow", lead, ...heatMapFigure(cells, heatScale(metrics, cells)));
}

const FRAME_SERIES = [
  { key: "estimated_before_ms", name: "before, estimated", colour: "--before", dash: [4, 4] },
  { key: "estimated_after_ms", name: "with impostors, estimated", colour: "--after", dash: [4, 4] },
  { key: "before_ms", name: "before, measured", colour: "--before" },
  { key: "after_ms", name: "with impostors, measured", colour: "--after" },
];

function quantile(sorted, share) {
  if (sorted.length === 0) return undefined;
  return sorted[Math.min(sorted.length - 1, Math.max(0, Math.ceil(share * sorted.length) - 1))];
}

/// Each series sorted by itself, resampled to one axis: the share of views that are at most as slow.
function sortedCurves(frames, shares) {
  return FRAME_SERIES.map((series) => ({ ...series, sorted: frames.map((frame) => frame[series.key]).filter(isNumber).sort((a, b) => a - b) }))
    .filter((series) => series.sorted.length > 0)
    .map((series) => ({ ...series, values: shares.map((share) => quantile(series.sorted, share / 100)) }));
}

function framesSection({ metrics }) {
  const frames = field(metrics, "verify.frames") || [];
  if (frames.length === 0) return null;
  const shares = Array.from({ length: Math.min(400, 2 * frames.length) + 1 }, (_, index, all) => (100 * index) / Math.min(400, 2 * frames.length));
  const curves = sortedCurves(frames, shares);
  const budget = { name: "budget", colour: "--budget", dash: [2, 3], values: shares.map(() => metrics.budget_ms) };
  const chart = lineChart({
    label: `Frame times of ${frames.length} views, sorted, before and with impostors, against the budget of ${milliseconds(metrics.budget_ms)}`,
    xs: shares, series: [...curves, budget],
    x: { label: "share of views at most as slow, %", format: (value) => significant(value, 3) },
    y: { label: "frame time, ms", format: (value) => significant(value, 3), range: (plot, least, most) => [0, most * 1.05] },
  });
  const columns = [
    { title: "frame time", text: (series) => series.name },
    { title: "views", number: true, text: (series) => count(series.sorted.length) },
    ...[["median", 0.5], ["99th percentile", 0.99], ["worst", 1]].map(([title, share]) => ({ title, number: true, text: (series) => milliseconds(quantile(series.sorted, share)) })),
  ];
  const lead = `${count(frames.length)} views of the view space, drawn with and without impostors: random ones inside the slow regions, and the hardest we know (corners of cells, borders of direction intervals, regions left closest to the budget, a camera path).`;
  return section("frames", "Frame times before and after", lead, element("figure", {}, chart), table(columns, curves, "Frame time percentiles"));
}

/// "atlases as BC1 on a GPU (masks kept exactly, PSNR 38.1 dB)"; formats that were not tried say where their size comes from.
function gpuFormat(format, tried) {
  const name = `atlases as ${format.toUpperCase().replace("_", " ")} on a GPU`;
  if (format === "rgba8") return name;
  if (!tried) return `${name} (computed from their size)`;
  const masks = tried.alpha_exact ? "masks kept exactly" : `${count(tried.alpha_changed_texels)} texels change their mask`;
  return `${name} (${masks}, ${isNumber(tried.opaque_psnr_db) ? `PSNR ${significant(tried.opaque_psnr_db, 3)} dB` : "no colour differs"})`;
}

function memorySection({ metrics, impostors }) {
  const memory = metrics.memory || {}, bound = metrics.bound || {};
  if (impostors.length === 0 && !memory.lods_bytes) return null;
  const rows = [
    ["textures, with gutters (the objective)", bytes(memory.texture_bytes)], ["geometry", bytes(memory.geometry_bytes)],
    ...(memory.lods_bytes ? [["levels of detail: their triangles, on the scene's own vertices where it is glTF (not part of the objective)", bytes(memory.lods_bytes)]] : []),
    ["unused space in the atlases", bytes(memory.atlas_padding_bytes)], ["total", bytes(memory.total_bytes)],
    ...Object.entries(memory.gpu_bytes || {}).map(([format, value]) => [gpuFormat(format, (memory.gpu_compression || {})[format]), bytes(value)]),
    ["lower bound: no choice of these candidates needs less", bytes(bound.memory_lower_bound_bytes)],
    ["gap to the lower bound", percent(bound.gap)],
    ["gap at the sizes that the selection knew", percent(bound.selection_gap)],
  ].filter(([, value]) => value !== NONE);
  const totals = table([{ title: "memory", text: (row) => row[0] }, { title: "", number: true, text: (row) => row[1] }], rows, "Memory");
  return section("memory", "Memory, and where it goes", "", totals, memoryBreakdown(impostors), largestImpostors(impostors));
}

function image(picture, label) {
  return element("img", { src: picture.src, alt: `${label}. ${picture.caption}` });
}

const VIEW_IMAGES = [["original", "Original"], ["with_impostors", "With impostors"], ["difference", "Difference, amplified 4x"]];

/// Pictures are named "view-7/original", "view-7/with_impostors", "view-7/difference".
function viewsSection({ metrics, pictures }) {
  const names = [...new Set(pictures.map((picture) => picture.name).filter((name) => name.startsWith("view-")).map((name) => name.split("/")[0]))];
  const views = names.map((name) => VIEW_IMAGES.map(([part, label]) => ({ label, picture: pictures.find((picture) => picture.name === `${name}/${part}`) })).filter((entry) => entry.picture));
  const triples = views.filter((view) => view.length > 0).map((view) => element("figure", {},
    element("h3", {}, view[0].picture.caption),
    element("div", { class: "triple" }, ...view.map(({ label, picture }) => element("figure", {}, image(picture, label), element("figcaption", {}, label))))));
  if (triples.length === 0) return null;
  const judged = metrics.image || {};
  const facts = isNumber(judged.gap_pixels)
    ? `${count(judged.views)} views inside view cells were judged by rays against the original scene: ${count(judged.gap_pixels)} gap pixels (holes), greatest parallax ratio ${significant(judged.max_parallax_ratio, 3)} (1 is the promise)${isNumber(judged.silhouette_bloat_px) ? `, silhouettes ${significant(judged.silhouette_bloat_px, 2)} pixels too wide` : ""}. Mean image error ${percent(judged.mean_error)}${isNumber(judged.mean_flip) ? `; as an eye sees it (FLIP, 0 to 1) ${significant(judged.mean_flip, 2)}` : ""}.`
    : "";
  return section("views", "Worst views side by side", `The views with the largest image error and the slowest ones. ${facts}`, ...triples);
}

function atlasSection({ pictures }) {
  const pages = pictures.filter((picture) => picture.name.startsWith("atlas-"));
  if (pages.length === 0) return null;
  const figures = pages.map((picture) => element("figure", { class: "atlas" }, image(picture, "Atlas page"), element("figcaption", {}, picture.caption)));
  return section("atlases", "Texture atlases", "All textures that ship; transparent where the checkerboard shows.", element("div", { class: "side" }, ...figures));
}

const CURVE_TITLES = {
  estimator: "Time model: held-out error", visibility: "Visibility: certified missed share of rays", view_space: "View space: how loose the bounds are",
  candidates: "Candidates: memory", select: "Selection: gap to the lower bound", bake_rounds: "Baking and repair: memory", bake: "Bake: texel size",
};

function curveFigure(name, points) {
  const sorted = points.filter((point) => isNumber(point.seconds) && isNumber(point.error)).sort((a, b) => a.seconds - b.seconds);
  if (sorted.length === 0) return null;
  const title = CURVE_TITLES[name] || name, unit = sorted[0].unit || "";
  const spread = (key) => sorted.every((point) => point[key] > 0) && sorted[sorted.length - 1][key] / sorted[0][key];
  const wide = (key) => { const ratio = spread(key); return ratio !== false && Math.max(ratio, 1 / ratio) > 20; };
  const chart = sorted.length < 2 ? null : lineChart({
    label: `${title}, ${unit}, against run time in seconds`, height: 230, xs: sorted.map((point) => point.seconds),
    x: { label: "seconds", format: (value) => significant(value, 3), log: wide("seconds") },
    y: { format: compact, log: wide("error") },
    series: [{ name: unit || "error", colour: "--series-0", points: true, values: sorted.map((point) => point.error) }],
  });
  const columns = [
    ...(sorted.some((point) => point.step) ? [{ title: "after", text: (point) => point.step ?? NONE }] : []),
    { title: "run time", number: true, text: (point) => seconds(point.seconds) },
    { title: "work", number: true, text: (point) => (isNumber(point.work) ? significant(point.work, 6) : String(point.work ?? NONE)) },
    { title: `error${unit ? `, ${unit}` : ""}`, number: true, text: (point) => significant(point.error, 3) },
  ];
  const numbers = table(columns, sorted, `${title}: numbers`);
  return element("figure", {}, element("h3", {}, title), element("figcaption", {}, unit), chart, chart === null ? numbers : folded("Numbers", numbers));
}

function curvesSection({ metrics }) {
  const known = Object.keys(CURVE_TITLES), curves = metrics.curves || {};
  const names = [...known, ...Object.keys(curves).filter((name) => !known.includes(name))];
  const figures = names.map((name) => (Array.isArray(curves[name]) ? curveFigure(name, curves[name]) : null)).filter((figure) => figure !== null);
  if (figures.length === 0) return null;
  return section("curves", "What more run time would buy", "Each stage that approximates can be made more exact for more time; these points are from this run.", element("div", { class: "side" }, ...figures));
}

const STAGE_ORDER = ["load", "view_space", "visibility", "lods", "size_model", "survey", "candidates", "select", "bake", "assemble", "curves", "causes", "gpu_compression", "verify"];

function stagesSection({ metrics }) {
  const rank = ([name]) => (STAGE_ORDER.includes(name) ? STAGE_ORDER.indexOf(name) : STAGE_ORDER.length);
  const stages = Object.entries(metrics.stages_s || {}).filter(([, value]) => isNumber(value)).sort((a, b) => rank(a) - rank(b));
  if (stages.length === 0) return null;
  const total = stages.reduce((sum, [, value]) => sum + value, 0);
  const rows = stages.map(([name, value]) => ({ name: name.replaceAll("_", " "), value }));
  const columns = [
    { title: "stage", text: (row) => row.name }, { title: "time", number: true, text: (row) => seconds(row.value) },
    { title: "share", number: true, text: (row) => percent(total > 0 ? row.value / total : 0) },
  ];
  const facts = [
    isNumber(field(metrics, "candidates.generated")) ? `${count(metrics.candidates.generated)} candidates generated, ${count(metrics.candidates.pruned)} pruned.` : "",
    isNumber(metrics.peak_rss_bytes) ? `Peak memory of the job ${bytes(metrics.peak_rss_bytes)}.` : "",
  ].join(" ");
  return section("stages", `Where the ${seconds(total)} went`, facts, table(columns, rows, "Run time of the stages"));
}

/// metrics.causes: shares of the slow regions' time by kind of work, and the objects that cost most: {draws_share, ..., objects: [{name, ms}]}.
function causesSection({ metrics }) {
  const causes = metrics.causes || {}, objects = causes.objects || [];
  const shares = [["draw calls and state changes", causes.draws_share], ["triangles", causes.triangles_share], ["pixels", causes.pixels_share]]
    .filter(([, share]) => isNumber(share) && share > 0);
  if (objects.length === 0 && shares.length === 0) return null;
  const total = objects.reduce((sum, cause) => sum + cause.ms, 0);
  const columns = [
    { title: "object", text: (cause) => cause.name || `object ${cause.object}` },
    { title: "time over all slow cells", number: true, text: (cause) => milliseconds(cause.ms) },
    { title: "share of those listed", number: true, text: (cause) => percent(total > 0 ? cause.ms / total : 0) },
  ];
  const lead = "What the time goes into where the budget is exceeded, taking the slowest region of each cell.";
  const work = shares.length > 0 ? shareBars("By kind of work", shares.map(([name, share]) => ({ name, share, value: percent(share) }))) : null;
  return section("causes", "Why it is slow", lead, work, objects.length > 0 ? element("h3", {}, "Objects that cost most") : null,
    objects.length > 0 ? table(columns, objects, "Objects that cost most") : null);
}

function blockingText(blocking) {
  return (blocking || []).map((entry) => `${entry.name || `object ${entry.object}`}${isNumber(entry.ms) ? ` (${milliseconds(entry.ms)})` : ""}`).join(", ") || NONE;
}

/// metrics.unsolved: the worst, worst first: [{cpv, bound_before_ms, lowest_budget_ms, residual_ms, blocking: [{object, name, ms}], region}];
/// metrics.unsolved_by_object: all: [{object, name, regions, worst_ms}].
function unsolvedSection({ metrics }) {
  const unsolved = metrics.unsolved || [], all = field(metrics, "cpv.unsolved") || unsolved.length, byObject = metrics.unsolved_by_object || [];
  if (unsolved.length === 0) return null;
  const columns = [
    { title: "region", number: true, text: (row) => String(row.cpv ?? NONE) }, { title: "where", text: (row) => row.region || NONE },
    { title: "bound before", number: true, text: (row) => milliseconds(row.bound_before_ms) },
    { title: "lowest budget that can be met", number: true, text: (row) => milliseconds(row.lowest_budget_ms) },
    { title: "still over by", number: true, text: (row) => milliseconds(row.residual_ms) },
    { title: "because of", text: (row) => blockingText(row.blocking) },
  ];
  const lead = "In these regions no set of impostors keeps the frame within the budget: the objects named are too near, or too deep, for an impostor. Raise the budget, leave the place out of the view space, or simplify or split these objects.";
  const causes = [
    { title: "object", text: (row) => row.name || `object ${row.object}` },
    { title: "regions where it costs most", number: true, text: (row) => count(row.regions) },
    { title: "at most", number: true, text: (row) => milliseconds(row.worst_ms) },
  ];
  return section("unsolved", "Regions without a solution", lead,
    byObject.length > 0 ? table(causes, byObject.slice(0, 20), "What makes them so") : null,
    unsolved.length < all ? element("p", { class: "soft" }, `The worst ${count(unsolved.length)} of ${count(all)}; all are in placement.json.`) : null,
    table(columns, unsolved, "Unsolved regions"));
}

function leftOutSection({ metrics }) {
  const entries = [...(metrics.left_out || []), ...(field(metrics, "verify.left_out") || [])];
  if (entries.length === 0) return null;
  const text = (entry) => (typeof entry === "string" ? entry : [entry.stage || entry.what || entry.name, entry.reason || entry.why].filter(Boolean).join(": "));
  return section("left-out", "What was left out, and why", "", element("ul", {}, ...entries.map((entry) => element("li", {}, text(entry)))));
}

const WORDS = [
  ["impostor", "A textured stand-in for scene objects that are too slow to draw, right from every place in its view cell."],
  ["view cell", "The part of space an impostor may be seen from: a box, or a shaft (a cut pyramid that opens towards the viewer)."],
  ["region", "A cell of positions together with an interval of view directions. One whose time bound exceeds the budget is a slow region (conservative problem view, CPV)."],
  ["time bound", "The predicted frame time with a margin that covers the stated share of frames; a region's bound holds for all views inside it."],
  ["layer", "One of the parallel planes an impostor is drawn on; more layers let the viewer move further."],
  ["lower bound", "Memory that every choice among the same candidates would need at least, so the gap says how much a better choice could save at most."],
  ["parallax ratio", "How far a point is seen from its true direction, in units of the limit (by default one pixel)."],
];

function wordsSection() {
  const entries = WORDS.flatMap(([word, meaning]) => [element("dt", {}, word), element("dd", {}, meaning)]);
  return section("words", "Words used here", "", element("dl", { class: "words" }, ...entries));
}
