// The results of each kind of job in a real browser, against the mock of the service: what is said of a place and a view, of a calibrated
// machine, a verified placement, a baked impostor and a running job, and that nothing is said of what a result does not have.
import assert from "node:assert/strict";
import test from "node:test";
import { textOf, visit, waitForText } from "./browser.mjs";
import { browser, mock, noFaults, tab } from "./mock_page.mjs";

const result = async (id, selector) => {
  await visit(tab, `#/jobs/${id}/result`, selector);
  await tab.page.waitForNetworkIdle({ idleTime: 150, concurrency: 1 });
};
const artifact = async (id, path) => (await fetch(`${mock.url}/v1/jobs/${id}/artifacts/${path}`)).json();
const bySlowness = async (id) => (await artifact(id, "metrics.json")).heat_map.sort((a, b) => b.before_ms - a.before_ms);
const textsOf = (selector) => tab.page.$$eval(selector, (nodes) => nodes.map((node) => node.textContent));

/** Where a place of the plan is in the window. */
const inWindow = ({ page }, x, z) =>
  page.$eval(
    "svg.plate",
    (svg, ...place) => {
      svg.scrollIntoView({ block: "center", behavior: "instant" });
      const point = new DOMPoint(...place).matrixTransform(svg.getScreenCTM());
      return [point.x, point.y];
    },
    x,
    z,
  );
const pointAt = async ({ x0, z0, x1, z1 }) => tab.page.mouse.move(...(await inWindow(tab, (x0 + x1) / 2, (z0 + z1) / 2)));

test("a cell of the heat map says why it is slow, by keyboard and by pointer", async () => {
  await result("explained", ".plate .objects");
  const [slowest, next, third] = await bySlowness("explained");
  await tab.page.$eval("svg.plate", (node) => node.focus());
  await tab.page.keyboard.press("ArrowRight");
  assert.match(await textOf(tab), /\n80 % triangles, 18 % pixels; most by tree_03 \(12\.3 ms\), house_4 \(3\.04 ms\)\./);
  await pointAt(next);
  assert.match(await textOf(tab), /most by object 17 \(12\.3 ms\)/);
  await pointAt(slowest);
  assert.match(await textOf(tab), /most by tree_03/);
  assert.equal(third.cause, undefined);
  await pointAt(third);
  assert.doesNotMatch(await textOf(tab), /most by/, "a cell without a cause says nothing of it");
  noFaults();
});

/** A tab for one test; before it is closed, the other one is hidden. */
async function newTab(t) {
  const opened = await browser.newPage(mock.url);
  t.after(() => opened.page.close());
  return opened;
}

test("a finger reads a cell by its first touch and walks by its second", async (t) => {
  const telephone = await newTab(t),
    { page } = telephone;
  await page.setViewport({ width: 375, height: 812, hasTouch: true });
  await visit(telephone, "#/jobs/explained/result", ".plate .objects");
  const [{ x0, z0, x1, z1 }] = await bySlowness("explained");
  const tap = async () => page.touchscreen.tap(...(await inWindow(telephone, (x0 + x1) / 2, (z0 + z1) / 2)));
  await tap();
  await waitForText(telephone, /most by tree_03/);
  assert.match(await page.evaluate(() => location.hash), /result$/);
  await tap();
  await page.waitForFunction(() => location.hash.includes("/walk?position="));
  assert.deepEqual(telephone.faults, []);
});

test("a click beside the cells leads nowhere, whatever was pointed at before", async () => {
  await result("explained", ".plate .objects");
  const [slowest] = await bySlowness("explained");
  const heat_map = (await artifact("explained", "metrics.json")).heat_map;
  const [x, z, width] = await tab.page.$eval("svg.plate", ({ viewBox: { baseVal: box } }) => [box.x, box.y, box.width]);
  const margin = Math.min(...heat_map.map(({ x0 }) => x0)) - x;
  assert.ok(margin > 0.01 * width, "there is a margin to click at");
  await pointAt(slowest);
  assert.match(await textOf(tab), /most by tree_03/);
  await tab.page.mouse.click(...(await inWindow(tab, x + margin / 2, z + margin / 2)));
  await new Promise((done) => setTimeout(done, 200));
  assert.match(await tab.page.evaluate(() => location.hash), /result$/);
  noFaults();
});

test("the table of the slowest cells has the causes, where there are any", async () => {
  await result("explained", ".plate .objects");
  const table = "table[aria-label='Slowest cells of the view space']";
  assert.deepEqual((await textsOf(`${table} th`)).slice(4, 6), ["slowest direction", "why"]);
  assert.match((await textsOf(`${table} tbody tr`))[0], /80 % triangles, 18 % pixels; most by tree_03/);
  await result("older", ".plate .objects");
  assert.ok(!(await textsOf(`${table} th`)).includes("why"));
  await tab.page.$eval("svg.plate", (node) => node.focus());
  await tab.page.keyboard.press("ArrowRight");
  assert.match(await textOf(tab), /ms before,[^]*Slowest looking/);
  assert.doesNotMatch(await textOf(tab), /most by/);
  noFaults();
});

/** Of each pane of the first worst view: its place in the window, and how much of the file lies left of it, in panes. */
const panes = () =>
  tab.page.$$eval(".worst-view:first-of-type .crop", (crops) =>
    crops.map((crop) => {
      crop.scrollIntoView({ behavior: "instant" });
      const { left, right, width, height } = crop.getBoundingClientRect();
      return { left, right, height, skipped: Math.round(((left - crop.firstChild.getBoundingClientRect().left) / width) * 10) / 10 };
    }),
  );
const imagesShown = () =>
  tab.page.waitForFunction(() => {
    const images = [...document.querySelectorAll(".worst-view img")];
    for (const image of images) image.loading = "eager";
    return images.length === 6 && images.every(({ complete, naturalWidth }) => complete && naturalWidth === 3 * 96);
  });

test("worst views stand side by side, each pane under its head", async () => {
  await result("explained", ".worst-view");
  await imagesShown();
  const { pictures, frames } = (await artifact("explained", "metrics.json")).verify;
  const shown = frames[pictures[0].frame];
  const captions = await textsOf(".worst-view figcaption");
  assert.equal(captions.length, pictures.length);
  assert.match(captions[0], /^Worst view 1 . [\d.]+ ms \(estimated\) before, [\d.]+ ms \(estimated\) with impostors; image error [\d.]+ %, FLIP [\d.e-]+; at .* m/);
  assert.match(captions[1], /^Worst view 2 . [\d.]+ ms \(estimated\) before, [\d.]+ ms with impostors; image/, "each time for itself");
  const inFirst = (selector, read) => tab.page.$$eval(`.worst-view:first-of-type ${selector}`, (nodes, key) => nodes.map((node) => node[key]), read);
  assert.deepEqual(await inFirst(".pane", "textContent"), ["Original", "With impostors", "Difference, amplified 4\u00d7"]);
  assert.deepEqual(await inFirst("img", "alt"), ["original", "with impostors", "difference, amplified 4\u00d7"].map((pane) => `Worst view 1: ${pane}`));
  const [walk, whole] = [...(await inFirst("figcaption a", "href")), ...(await inFirst("a.panes", "href"))];
  assert.ok(walk.includes(`#/jobs/explained/walk?position=${Number(shown.position[0].toPrecision(7))},`), walk);
  assert.equal(whole, `${mock.url}/v1/jobs/explained/artifacts/worst_view_1.png`, "it opens in full size");
  const [first, second, third] = await panes();
  assert.deepEqual([first.skipped, second.skipped, third.skipped], [0, 1, 2], "each shows its third of the file");
  assert.ok(first.right < second.left && second.right < third.left, "side by side");
  assert.ok(Math.abs(first.height - (first.right - first.left)) < 3, "in its proportions");
  noFaults();
});

test("in a narrow window worst views fit, below each other", async () => {
  await tab.page.setViewport({ width: 375, height: 812 });
  await result("explained", ".worst-view");
  await imagesShown();
  for (const { left, right, skipped } of await panes()) assert.ok(left >= 0 && right <= 375 && right - left > 280, `${left} to ${right}, ${skipped}`);
  assert.deepEqual((await panes()).map(({ skipped }) => skipped), [0, 1, 2]);
  await tab.page.setViewport({ width: 1280, height: 900 });
  noFaults();
});

test("with a token, which no image sends, pictures are fetched by the page", async () => {
  const images = [];
  const note = (request) => request.url().endsWith("worst_view_1.png") && images.push(request.headers()["authorization"]);
  tab.page.on("request", note);
  await tab.page.evaluate(() => sessionStorage.setItem("standin-token", "secret"));
  await result("explained", ".worst-view");
  await imagesShown();
  assert.match(await tab.page.$eval(".worst-view img", ({ src }) => src), /^blob:/);
  assert.deepEqual(images, ["Bearer secret"]);
  tab.page.off("request", note);
  await tab.page.evaluate(() => sessionStorage.clear());
  noFaults();
});

test("a view that goes takes the copies of its pictures along, those under way too", async (t) => {
  const leaving = await newTab(t),
    { page } = leaving;
  await page.evaluateOnNewDocument(() => {
    const { createObjectURL, revokeObjectURL } = URL;
    globalThis.kept = new Set();
    URL.createObjectURL = (blob) => (globalThis.made = createObjectURL.call(URL, blob), globalThis.kept.add(globalThis.made), globalThis.made);
    URL.revokeObjectURL = (url) => (globalThis.kept.delete(url), revokeObjectURL.call(URL, url));
  });
  await visit(leaving, "", "table");
  await page.evaluate(() => sessionStorage.setItem("standin-token", "secret"));
  let hold;
  const held = new Promise((done) => (hold = done));
  await page.setRequestInterception(true);
  page.on("request", (request) => (request.url().endsWith("worst_view_2.png") ? hold(request) : request.continue()));
  await visit(leaving, "#/jobs/explained/result", ".worst-view");
  const late = await held;
  await page.waitForFunction(() => globalThis.kept.size === 1);
  await page.evaluate(() => (location.hash = "#/"));
  await page.waitForSelector("table[aria-label='Jobs, newest first']");
  await late.continue().catch(() => {}); // the page gave it up
  await new Promise((done) => setTimeout(done, 500));
  assert.deepEqual(await page.evaluate(() => [...globalThis.kept]), []);
  assert.deepEqual(leaving.faults, []);
});

/** A tab that gets no answer from some addresses. */
async function tabWithout(t, addresses) {
  const broken = await newTab(t);
  await broken.page.setRequestInterception(true);
  broken.page.on("request", (request) => (addresses.test(request.url()) ? request.abort() : request.continue()));
  return broken;
}

test("a result without pictures shows its worst views as numbers", async () => {
  await result("older", "#views table");
  assert.deepEqual(await textsOf(".worst-view"), []);
  assert.equal(await tab.page.$("#views details"), null, "nothing is folded away");
  assert.match(await textOf(tab), /Side by side, with their differences: report\.html/);
});

test("the numbers are there before the placement, and without it", async (t) => {
  const broken = await tabWithout(t, /placement\.json$/);
  await visit(broken, "#/jobs/older/result", "svg.plate");
  await waitForText(broken, /The plan of the scene cannot be shown/);
  assert.match(await textOf(broken), /Budget met[^]*Frame times[^]*Worst views[^]*Memory/);
  assert.equal(broken.faults.length, 1, "the browser itself reports the failure");
});

test("a part of the page that is no longer there says what to do", async (t) => {
  const broken = await tabWithout(t, /\/assets\/result-.*\.js$/);
  await visit(broken, "#/jobs/older/result");
  assert.match(await textOf(broken), /This part of the page cannot be loaded[^]*reload the page/);
  assert.equal(broken.faults.length, 1, "the browser itself reports the failure");
});

test("a budget that no view exceeds needs no impostor, and saves none", async () => {
  await result("needless", ".tiles");
  assert.match(await textOf(tab), /Nothing to do[^]*Slow regions\s+none[^]*Memory\s+0 B\s+no impostors/);
  assert.doesNotMatch(await textOf(tab), /could be saved/);
  noFaults();
});

test("a calibration says what work costs, how well times are predicted, and what more seconds would buy", async () => {
  await result("calibrated", "#costs table");
  const text = await textOf(tab);
  assert.match(text, /Calibrated[^]*within 7\.72 %, nine of ten within 21\.9 %\. 99\.8 % of them kept their bound, 99 % is stated/);
  assert.match(text, /Median error\s+7\.72 %[^]*Frames timed\s+757/);
  assert.match(text, /The time bound is 1\.73 times the prediction/);
  assert.match(text, /Left out[^]*switches between impostors' atlas pages: costs nothing measurable/);
  const costs = await tab.page.$$eval("#costs tbody tr", (rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent)));
  assert.deepEqual(costs[0], ["frame, whatever is in it", "0.16 ms", "each", "0.1598"]);
  assert.deepEqual(costs[1], ["draw calls", "2.22 ms", "a thousand", "0.002224"]);
  assert.deepEqual(costs[3], ["triangles submitted", "11.9 ms", "a million", "1.194e-5"]);
  assert.equal(costs.length, 11);
  assert.equal(await tab.page.$$eval("#learning .scroll tbody tr", (rows) => rows.length), 5);
  assert.ok(await tab.page.$("#learning canvas"), "as a curve, too");
  noFaults();
});

test("a verification says what was kept and what was not", async () => {
  const VERDICTS = {
    verified: ["good", /^Verified: all of 8 frames kept [\d.]+ ms; rays in \d+ views found no gap/],
    missed: ["bad", /^Budget missed: 3 of 8 frames took longer than [\d.]+ ms; rays/],
    few_slow: ["good", /^Verified: 8 of 800 frames took longer than [\d.]+ ms, 1 % may; rays/],
    untimed: ["plain", /^Not timed here: all of 8 frames are estimated within [\d.]+ ms, but none was timed/],
    gaps: ["bad", /^Image promise broken: rays in \d+ views found 3 gap pixels/],
  };
  for (const [id, [tone, sentence]] of Object.entries(VERDICTS)) {
    await result(id, ".verdict");
    const [classes, said] = await tab.page.$eval(".verdict", (node) => [node.className, [...node.children].map(({ textContent }) => textContent).join(": ")]);
    assert.equal(classes, `verdict ${tone}`, id);
    assert.match(said, sentence);
  }
  await visit(tab, "#/jobs/missed", "#files table");
  assert.match(await textOf(tab), /finished, aim not met[^]*the placement does not keep what it promises/);
  await result("missed", "#frames");
  assert.match(await textOf(tab), /Slowest frame with impostors\s+125 %[^]*with impostors, measured[^]*Image errors/);
  const walk = await tab.page.$eval("#views a", ({ href }) => href);
  assert.match(walk, /#\/jobs\/done\/walk\?position=/, "views lead into the placement that was verified");
  noFaults();
});

test("a verification outlives its placement", async () => {
  mock.update("verified", { request: { kind: "verify", job: "gone" } });
  await result("verified", ".verdict");
  assert.match(await textOf(tab), /The placement that was verified is gone[^]*all of 8 frames kept the budget/);
  assert.equal(await tab.page.$("#views a"), null, "there is nothing to walk through");
  assert.equal(tab.faults.splice(0).length, 1, "the browser itself reports the 404");
});

test("a bake shows its impostor's weight, errors and file", async () => {
  await result("baked", ".verdict.good");
  assert.match(await textOf(tab), /Image promise kept[^]*no gap and a parallax of at most 0\.95/);
  assert.match(await textOf(tab), /Textures\s+371 kB[^]*Geometry\s+13\.6 kB\s+148 quads\s+Layers\s+25/);
  const rows = await textsOf("#errors tbody tr");
  assert.deepEqual(rows, ["mean of 50 views2.57 %0.11", "from the reference viewpoint2.09 %0.099", "nearest00.58", "bilinear00.58", "mipmapped1490.58"]);
  assert.match(await tab.page.$eval(".actions a", ({ href }) => href), /artifacts\/impostors\.glb$/);
  await tab.page.waitForFunction(() => document.querySelector("#pictures img").naturalWidth > 0);
  noFaults();
});

test("a picture that cannot be loaded says so", async (t) => {
  const broken = await tabWithout(t, /picture\.png$/);
  await visit(broken, "#/jobs/baked/result", "#pictures");
  await waitForText(broken, /picture\.png cannot be loaded/);
  assert.equal(await broken.page.$("#pictures img"), null);
  assert.equal(broken.faults.length, 1, "the browser itself reports the failure");
});

test("a sweep says how low the budget can go", async () => {
  await result("swept", "#curve canvas");
  assert.match(await textOf(tab), /3 of 4 budgets met[^]*the lowest that is met, 38 ms, takes 176 kB of textures/);
  assert.deepEqual((await textsOf("#curve .scroll tbody td:nth-child(2)")), ["5 unsolved", "met", "met", "nothing to place"]);
  noFaults();
});

test("a sweep that meets every budget, but fails against a baseline or a criterion, says so first", async () => {
  await result("regressed", ".verdict.bad");
  assert.match(await textOf(tab), /Worse than the baseline\s+at 38 ms: 175828 bytes of texture before, 300000 now \(\+71 %\)\./);
  assert.match(await textOf(tab), /3 budgets compared; memory may grow by 2 %\. Not in both curves, so not compared: 36 ms\./);
  assert.deepEqual(await textsOf("#baseline tbody td"), ["38 ms", "176 kB", "300 kB"]);
  await result("unaccepted", ".verdict.bad");
  assert.match(await textOf(tab), /Criteria not met\s+at 38 ms: failed, 300000 bytes of texture, 200000 allowed\./);
  assert.deepEqual((await textsOf("#criteria li")).length, 2);
  assert.equal(await tab.page.$("#baseline"), null, "there was none");
  noFaults();
});

test("what has no view of its own is shown as it is", async () => {
  await result("odd", "section");
  assert.deepEqual(await textsOf("section h2"), ["other.json"]);
  assert.deepEqual(JSON.parse((await textsOf("section pre"))[0]), { a: 1 });
});

test("a job without a label is called by what it does, and files by what they hold", async () => {
  await visit(tab, "#/", "table");
  const names = await textsOf("table[aria-label='Jobs, newest first'] td:first-child");
  for (const name of ["Survey of city.glb", "Sweep of city.glb", "Verification of city.glb", "Calibration", "the city at night"])
    assert.ok(names.includes(name), `${name} is in ${names}`);
  await visit(tab, "#/jobs/calibrated");
  assert.deepEqual(await textsOf("h1"), ["Calibration"]);
  await visit(tab, "#/jobs/older", "#files table");
  assert.match(await textOf(tab), /result\.json\s+what the command printed/);
  await visit(tab, "#/jobs/explained", "#files table");
  assert.match(await textOf(tab), /worst_view_1\.png\s+a worst view: original, with impostors, difference/);
  noFaults();
});

test("the best so far is told in words, and follows the job", async () => {
  await visit(tab, "#/jobs/running", ".best");
  assert.match(await textOf(tab), /Best so far\s+textures\s+812 kB\s+impostors\s+37\s+slow regions not solved\s+12/);
  await tab.page.evaluate(() => (globalThis.stays = true));
  mock.update("running", { best_so_far: { texture_bytes: 1_650_000, impostors: 41, unsolved_cpvs: 0, rounds_left: 3 } });
  await waitForText(tab, /textures\s+1\.65 MB\s+impostors\s+41\s+slow regions not solved\s+0\s+rounds left\s+3/);
  assert.equal(await tab.page.evaluate(() => globalThis.stays), true, "without a reload");
  mock.update("running", { best_so_far: null });
  await tab.page.waitForFunction(() => document.querySelector(".best") === null);
  mock.update("running", { best_so_far: { impostors: 43 } });
  await waitForText(tab, /impostors\s+43/);
  mock.update("running", { state: "succeeded", aim_met: true });
  await waitForText(tab, /succeeded/);
  assert.equal(await tab.page.$(".best"), null, "a finished job has a result instead");
  noFaults();
});

test("a page that gets no event stream asks every few seconds, to the final state", async (t) => {
  const { page, faults, url } = await newTab(t);
  const refusal = { title: "The service is busy", status: 503, word: "busy", detail: "you have 4 event streams open, no more may be" };
  await page.setRequestInterception(true);
  page.on("request", (request) =>
    request.url().endsWith("/events")
      ? request.respond({ status: 503, contentType: "application/problem+json", body: JSON.stringify(refusal) })
      : request.continue(),
  );
  await visit({ page, url }, "#/jobs/queued");
  await waitForText({ page }, /Waits for its turn/);
  mock.update("queued", { state: "running", stage: "survey", fraction: 0.25, started: new Date().toISOString() });
  await waitForText({ page }, /25 %, timing views/);
  mock.update("queued", { state: "succeeded", aim_met: true, finished: new Date().toISOString() });
  await waitForText({ page }, /succeeded[^]*Took/);
  assert.equal(faults.length, 1, "the stream is asked for once; the browser itself reports the refusal");
});
