// The page and the service together: a scene uploaded by the form, its job watched, its result opened, the walk with impostors on and off.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { join } from "node:path";
import { createInterface } from "node:readline";
import test, { after, before } from "node:test";
import { expectAccessible, openBrowser, textOf, visit, waitForText } from "./browser.mjs";
import { binary, expectExit, scratch, source } from "./standin.mjs";

const folder = scratch();
const scene = join(folder, "city.glb");
let service, browser, tab;

async function serve() {
  const targets = join(source, "configs/targets");
  const child = spawn(
    binary,
    ["serve", "--data", join(folder, "data"), "--listen", "127.0.0.1:0", "--targets", targets, "--web", process.env.STANDIN_WEB],
    { stdio: ["ignore", "pipe", "inherit"] },
  );
  const [url] = await new Promise((done) => createInterface({ input: child.stdout }).once("line", (line) => done(line.match(/http:\S+/))));
  return { child, url };
}

before(async () => {
  expectExit(0, "make-city", "--objects", "60", "--triangles", "60000", "--seed", "1", "-o", scene);
  service = await serve();
  browser = await openBrowser();
  tab = await browser.newPage(service.url);
});
after(async () => {
  await browser?.close();
  if (!service) return;
  service.child.kill("SIGTERM");
  await new Promise((done) => service.child.once("exit", done));
});

const set = (id, value) => tab.page.$eval(`#${id}`, (node, text) => (node.value = text), value);
const canvas = () => tab.page.$eval("canvas", (node) => ({ ...node.dataset }));

// A placement that takes seconds, with a budget that the slowest views miss.
async function fillIn() {
  await (await tab.page.$("#scene-file")).uploadFile(scene);
  await waitForText(tab, /city\.glb is uploaded and chosen/);
  await tab.page.select("#target", "name:reference.json");
  await set("label", "small city");
  const settings = {
    "view_space-interval_deg": 22.5,
    "view_space-refine_levels": 2,
    "visibility-rays": 20000,
    "select-size_bakes": 24,
    "survey-views": 500,
    "verify-views": 8,
  };
  for (const [key, value] of Object.entries(settings)) await set(`set-${key}`, String(value));
}

test("a refusal of the service is shown at the field that it names", async () => {
  await visit(tab, "#/new", "#scene-file");
  await fillIn();
  await tab.page.click("button[type=submit]");
  await waitForText(tab, /place needs a budget/);
  assert.equal(await tab.page.evaluate(() => document.activeElement.id), "budget");
  const faults = tab.faults.splice(0).filter((fault) => !fault.endsWith("/v1/presets")); // a service may have none
  assert.deepEqual(
    faults.map((fault) => fault.match(/status of (\d+)/)?.[1] ?? fault),
    ["422"],
    "the browser itself reports the refusal",
  );
});

test("a job is submitted, watched to its end, and its result opened", async () => {
  await set("budget", "23.5");
  await tab.page.click("button[type=submit]");
  await waitForText(tab, /running|succeeded/, 60_000);
  await expectAccessible(tab, "job");
  await waitForText(tab, /(succeeded|aim not met)[^]*placement\.json/, 240_000);
  await tab.page.evaluate(() => [...document.querySelectorAll("main a")].find((node) => node.textContent === "Result").click());
  await tab.page.waitForSelector("svg.plate", { timeout: 30_000 });
  assert.match(await textOf(tab), /small city[^]*60 objects/);
  await tab.page.waitForFunction(() => [...document.querySelectorAll(".worst-view")].some((view) => view.querySelector("img").naturalWidth > 0));
  await tab.page.$eval("svg.plate", (node) => node.focus());
  await tab.page.keyboard.press("ArrowRight");
  assert.match(await textOf(tab), /\d % triangles.*most by \S+ \([\d.]+ ms\)/, "the slowest cell has a cause");
  await expectAccessible(tab, "result");
  assert.deepEqual(tab.faults.splice(0), []);
});

test("the walk switches the impostors that the service's placement names", async () => {
  const id = (await tab.page.evaluate(() => location.hash)).split("/")[2];
  const placement = await (await fetch(`${service.url}/v1/jobs/${id}/artifacts/placement.json`)).json();
  const cpv = placement.cpvs.find(({ impostors }) => impostors.length > 0);
  assert.ok(cpv, "the budget asks for impostors");
  const { min, max } = placement.cells[cpv.cell],
    { face, u_deg, v_deg } = placement.intervals[cpv.interval],
    { n, u, v } = placement.faces[face];
  const tangent = ([from, to]) => Math.tan((((from + to) / 2) * Math.PI) / 180);
  const position = min.map((low, axis) => (low + max[axis]) / 2),
    direction = n.map((along, axis) => along + tangent(u_deg) * u[axis] + tangent(v_deg) * v[axis]);
  await visit(tab, `#/jobs/${id}/walk?position=${position}&direction=${direction}`, "canvas[data-draws]");
  assert.equal(Number((await canvas()).impostors), cpv.impostors.length);
  await tab.page.keyboard.press("i");
  await tab.page.waitForFunction(() => document.querySelector("canvas").dataset.impostors === "0");
  await visit(tab, "#/", "table");
  assert.match(await textOf(tab), /small city/);
  assert.deepEqual(tab.faults.splice(0), []);
});

/** Submits what is filled in, and opens its result. */
async function resultOfSubmitted() {
  await tab.page.click("button[type=submit]");
  await waitForText(tab, /succeeded[^]*result\.json/, 60_000);
  await tab.page.evaluate(() => [...document.querySelectorAll("main a")].find((node) => node.textContent === "Result").click());
  await tab.page.waitForSelector(".verdict", { timeout: 30_000 });
}
const newJob = async (kind) => {
  await visit(tab, "#/new", "#scene-file");
  await tab.page.click(`#kind-${kind}`);
};
const first = (select) => tab.page.$eval(`${select} option:nth-child(2)`, (node) => ((node.parentElement.value = node.value), node.textContent));

test("a placement is verified, and one impostor baked, from the form", async () => {
  await newJob("verify");
  assert.match(await first("#placement"), /small city/);
  await set("argument-judged_views", "4");
  await set("set-verify-views", "4");
  await resultOfSubmitted();
  assert.match(await textOf(tab), /Of small city[^]*rays in 4 views found no gap[^]*Image errors/);
  await newJob("bake");
  await first("#scene");
  await set("argument-objects", "2");
  await set("argument-view_cell", "shaft:1,0.2,0,30,300");
  await set("argument-views", "4");
  await resultOfSubmitted();
  assert.match(await textOf(tab), /impostor of object 2 of city\.glb[^]*rays in 4 views of its view cell found no gap[^]*impostors\.glb/);
  assert.deepEqual(tab.faults.splice(0).filter((fault) => !fault.endsWith("/v1/presets")), []);
});
