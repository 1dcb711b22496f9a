// The service's page in a real browser, against the mock of the service that shows the placed city: every view opens without a word on the
// console or a serious accessibility finding, in light and dark; the walk draws what placement.json names; a job goes from form to walk.
import assert from "node:assert/strict";
import test from "node:test";
import { expectAccessible, setScheme, textOf, visit, waitForText } from "./browser.mjs";
import { browser, mock, noFaults, tab } from "./mock_page.mjs";
import { city, placed, resultOf } from "./standin.mjs";

const { placement, metrics } = resultOf(placed);
const canvas = () => tab.page.$eval("canvas", (node) => ({ ...node.dataset }));
const address = ({ position, direction }) => `position=${position.join(",")}&direction=${direction.join(",")}`;
const press = async (key) => {
  await tab.page.keyboard.press(key);
  await new Promise((done) => setTimeout(done, 400));
};

/** The middle of the problem view whose impostors save most. */
function solvedView() {
  const saves = ({ bound_before_ms, bound_after_ms }) => bound_before_ms - bound_after_ms;
  const id = placement.cpvs.reduce((best, cpv, at) => (saves(cpv) > saves(placement.cpvs[best]) ? at : best), 0);
  const { min, max } = placement.cells[placement.cpvs[id].cell];
  const { face, u_deg, v_deg } = placement.intervals[placement.cpvs[id].interval];
  const { n, u, v } = placement.faces[face];
  const tangent = ([from, to]) => Math.tan((((from + to) / 2) * Math.PI) / 180);
  return {
    id,
    position: min.map((low, axis) => (low + max[axis]) / 2),
    direction: n.map((along, axis) => along + tangent(u_deg) * u[axis] + tangent(v_deg) * v[axis]),
  };
}

const VIEWS = {
  jobs: "#/",
  "new job": "#/new",
  "running job": "#/jobs/running",
  "failed job": "#/jobs/failed",
  "finished job": "#/jobs/done",
  result: "#/jobs/done/result",
  "result with causes and pictures": "#/jobs/explained/result",
  survey: "#/jobs/survey/result",
  sweep: "#/jobs/swept/result",
  "sweep worse than its baseline": "#/jobs/regressed/result",
  calibration: "#/jobs/calibrated/result",
  verification: "#/jobs/missed/result",
  bake: "#/jobs/baked/result",
  "no result": "#/jobs/cancelled/result",
  "nothing to walk through": "#/jobs/failed/walk",
  "unknown address": "#/elsewhere",
};

for (const scheme of ["light", "dark"])
  test(`every view opens and is accessible, ${scheme}`, async () => {
    await setScheme(tab, scheme);
    for (const [name, hash] of Object.entries(VIEWS)) {
      await visit(tab, hash);
      await tab.page.waitForNetworkIdle({ idleTime: 150, concurrency: 1 });
      await expectAccessible(tab, `${name}, ${scheme}`);
      assert.equal(await tab.page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false, `${name} fits the window`);
      noFaults();
    }
  });

test("every view fits a telephone", async () => {
  await tab.page.setViewport({ width: 375, height: 812 });
  for (const [name, hash] of Object.entries(VIEWS)) {
    await visit(tab, hash);
    await tab.page.waitForNetworkIdle({ idleTime: 150, concurrency: 1 });
    assert.equal(await tab.page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false, name);
  }
  await tab.page.setViewport({ width: 1280, height: 900 });
  noFaults();
});

test("states say what they mean", async () => {
  await visit(tab, "#/jobs/failed");
  assert.match(await textOf(tab), /The scene file is broken[^]*accessor 4 reaches 12 bytes[^]*file-broken/);
  await visit(tab, "#/jobs/running");
  assert.match(await textOf(tab), /40 %, choosing impostors/);
  await visit(tab, "#/?state=queued&kind=bake");
  await waitForText(tab, /No job of this kind and state/);
  await visit(tab, "#/jobs/gone");
  assert.match(await textOf(tab), /There is no such job/);
  assert.equal(tab.faults.splice(0).length, 1, "the browser itself reports the 404");
});

test("the walk draws the impostors of the view's region, and the originals when they are off", async () => {
  const view = solvedView();
  await visit(tab, `#/jobs/done/walk?${address(view)}`, "canvas[data-draws]");
  await expectAccessible(tab, "walk");
  const cpv = placement.cpvs[view.id];
  const visible = placement.cells[cpv.cell].visible_objects?.length ?? placement.scene.objects.length;
  const seen = new Set(placement.cells[cpv.cell].visible_objects ?? placement.scene.objects.map(({ id }) => id));
  const replaced = new Set(cpv.impostors.flatMap((id) => placement.impostors[id].objects).filter((id) => seen.has(id)));
  const on = await canvas();
  assert.deepEqual([on.cpv, on.impostors, on.objects].map(Number), [view.id, cpv.impostors.length, visible - replaced.size]);
  const pictureOn = await (await tab.page.$("canvas")).screenshot();
  await press("i");
  const off = await canvas();
  assert.deepEqual([off.impostors, off.objects].map(Number), [0, visible]);
  assert.ok(Number(off.triangles) > Number(on.triangles), `${off.triangles} triangles without, ${on.triangles} with impostors`);
  assert.notDeepEqual(await (await tab.page.$("canvas")).screenshot(), pictureOn);
  assert.match(await textOf(tab), /switched off/);
  const table = await tab.page.$$eval("table[aria-label='Frame statistics'] tbody td", (cells) =>
    cells.map((cell) => Number(cell.textContent.replaceAll(",", ""))),
  );
  assert.deepEqual(table.slice(0, 2), [off.draws, off.triangles].map(Number), "what is counted is what was drawn");
  assert.deepEqual(table.slice(2), [on.draws, on.triangles].map(Number));
  noFaults();
});

test("keys walk, the address follows, and leaving the view space is said", async () => {
  const start = await tab.page.evaluate(() => location.hash);
  await tab.page.focus("canvas");
  await tab.page.keyboard.down("w");
  await new Promise((done) => setTimeout(done, 600));
  await tab.page.keyboard.up("w");
  await tab.page.waitForFunction((from) => location.hash !== from, {}, start);
  await visit(tab, `#/jobs/done/walk?position=0,5000,0&direction=0,0,-1`, "canvas[data-draws]");
  assert.match(await textOf(tab), /Outside the view space/);
  assert.deepEqual([(await canvas()).objects, (await canvas()).impostors].map(Number), [placement.scene.objects.length, 0]);
  await press("b");
  assert.doesNotMatch(await textOf(tab), /Outside the view space/);
  noFaults();
});

test("the heat map leads into the walk by keyboard", async () => {
  await visit(tab, "#/jobs/done/result", "svg.plate .objects");
  await tab.page.$eval("svg.plate", (node) => node.focus());
  await press("ArrowRight");
  const slowest = Math.max(...metrics.heat_map.map((cell) => cell.before_ms));
  assert.match(await textOf(tab), new RegExp(`${slowest.toPrecision(3).replace(/\.?0+$/, "")} ms before`), "the first cell is the slowest");
  await press("Enter");
  await tab.page.waitForSelector("canvas[data-draws]", { timeout: 30_000 });
  assert.notEqual((await canvas()).cell, "null");
  noFaults();
});

test("a job goes from the form over its progress to the walk", async () => {
  await visit(tab, "#/new", "#scene-file");
  await tab.page.click("button[type=submit]");
  await waitForText(tab, /is required/);
  assert.equal(await tab.page.evaluate(() => document.activeElement.id), "scene", "the first wrong field has the focus");
  await (await tab.page.$("#scene-file")).uploadFile(city);
  await waitForText(tab, /city\.glb is uploaded and chosen/);
  await tab.page.select("#target", "name:reference.json");
  await tab.page.type("#budget", "30");
  await tab.page.type("#label", "from the form");
  await tab.page.evaluate(() => [...document.querySelectorAll("button")].find((node) => node.textContent.startsWith("Check")).click());
  await waitForText(tab, /about 2 min 20 s and 1\.2 GB of memory/);
  await tab.page.evaluate(() => document.querySelectorAll("details").forEach((node) => (node.open = true)));
  await expectAccessible(tab, "form, unfolded");
  await tab.page.$eval("#set-view_space-leaf_m", (node) => (node.value = "12"));
  await tab.page.click("button[type=submit]");
  await waitForText(tab, /running[^]*%/);
  await waitForText(tab, /succeeded[^]*placement\.json/);
  assert.match(await tab.page.$eval("pre", (node) => node.textContent), /"leaf_m": 12/);
  await tab.page.evaluate(() => [...document.querySelectorAll("a")].find((node) => node.textContent === "Walk through it").click());
  await tab.page.waitForSelector("canvas[data-draws]", { timeout: 30_000 });
  assert.equal(tab.faults.splice(0).length, 1, "the browser itself reports the refusal");
});

test("the form offers the settings that the service names, all and no others", async (t) => {
  const { page, url } = await browser.newPage(mock.url);
  t.after(() => page.close());
  const group = (...names) => ({ type: "object", properties: Object.fromEntries(names.map((name) => [name, { type: "integer" }])) });
  const schema = { properties: { budget_ms: { type: "number" }, seed: { type: "integer" }, threads: { type: "integer" }, cache: group("size", "age") } };
  await page.setRequestInterception(true);
  page.on("request", (request) =>
    request.url().endsWith("/v1/schema") ? request.respond({ contentType: "application/json", body: JSON.stringify(schema) }) : request.continue(),
  );
  const offered = () => page.$$eval("[id^=set-]:is(input, select)", (inputs) => inputs.map(({ id }) => id));
  await visit({ page, url }, "#/new", "#scene-file");
  assert.deepEqual(await offered(), ["set-seed", "set-threads", "set-cache-size", "set-cache-age"]);
});

test("a running job can be cancelled", async () => {
  await visit(tab, "#/jobs/running");
  await tab.page.evaluate(() => [...document.querySelectorAll("button")].find((node) => node.textContent === "Cancel this job").click());
  await waitForText(tab, /Stopped on request/);
  noFaults();
});
