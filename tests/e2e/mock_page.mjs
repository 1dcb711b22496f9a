// The service's page in a browser, served by the mock of the service that shows the placed city; both end with the tests of the file.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after } from "node:test";
import { startMock } from "../../server/web/mock/server.mjs";
import { openBrowser } from "./browser.mjs";
import { city, fixture, placed } from "./standin.mjs";

export const mock = await startMock({ page: process.env.STANDIN_WEB, result: placed, scene: city, survey: join(fixture, "survey") });
after(() => mock.close());
export const browser = await openBrowser();
after(() => browser.close());
export const tab = await browser.newPage(mock.url);
/** Nothing was written to the page's console since this was asked last. */
export const noFaults = () => assert.deepEqual(tab.faults.splice(0), []);
