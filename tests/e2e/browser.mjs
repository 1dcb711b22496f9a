// A headless Chromium for tests of the page: fails on what the page writes to its console, and on serious accessibility findings.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import puppeteer from "puppeteer-core";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
// No GPU and no user namespaces: what build machines and containers have.
const FLAGS = ["--headless", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

export async function openBrowser() {
  const browser = await puppeteer.launch({ executablePath: process.env.STANDIN_CHROMIUM || "/usr/bin/chromium", args: FLAGS });
  return {
    close: () => browser.close(),
    /** A page of the browser, watched: {page, faults}. */
    async newPage(url) {
      const page = await browser.newPage();
      const faults = [];
      page.on("console", (message) => ["error", "warn"].includes(message.type()) && faults.push(`${message.text()} ${message.location().url ?? ""}`));
      page.on("pageerror", (error) => faults.push(error.message));
      await page.setViewport({ width: 1280, height: 900 });
      await page.setBypassCSP(true); // for axe, which is put into the page
      return { page, faults, url };
    },
  };
}

/** Goes to a view of the page and waits until `selector` is there. */
export async function visit({ page, url }, address, selector = "h1") {
  await page.goto("about:blank");
  await page.goto(`${url}/${address}`);
  await page.waitForSelector(selector, { timeout: 30_000 });
}

export async function setScheme({ page }, scheme) {
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }]);
}

/** No serious or critical finding of axe-core. */
export async function expectAccessible({ page }, what) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => globalThis.axe.run());
  const bad = violations.filter(({ impact }) => impact === "serious" || impact === "critical");
  assert.deepEqual(
    bad.map(({ id, nodes }) => `${what}: ${id}: ${nodes[0].html.slice(0, 200)}`),
    [],
  );
}

/** The page's text. */
export const textOf = ({ page }) => page.$eval("main", (node) => node.innerText);

export async function waitForText({ page }, pattern, timeout = 20_000) {
  const { source, flags } = pattern;
  await page.waitForFunction(
    (text, how) => new RegExp(text, how).test(document.querySelector("main").innerText),
    { timeout },
    source,
    flags,
  );
}
