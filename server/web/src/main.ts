// Starts the page: shows the view that the address names, and takes it away when the address changes.

import "../../report/page/style.css";
import "uplot/dist/uPlot.min.css";
import "./page.css";

import { ProblemError } from "./api";
import { element } from "./elements";
import { failureBox } from "./problem";
import { parseRoute, type Route } from "./router";
import { showJob } from "./views/job";
import { showJobs } from "./views/jobs";
import { showSubmit } from "./views/submit";

/// Fills `host`; `signal` aborts when the view goes.
export type View = (host: HTMLElement, route: Route, signal: AbortSignal) => Promise<void>;

const showUnknown: View = async (host) => {
  document.title = "Not found \u2014 Standin";
  host.append(
    element("h1", {}, "Nothing here"),
    element("p", {}, "This address names no view of the page. ", element("a", { href: "#/" }, "To the jobs")),
  );
};
const notLoaded = (): never => {
  throw new ProblemError({
    title: "This part of the page cannot be loaded",
    status: 0,
    detail: "The server was updated or cannot be reached; reload the page.",
  });
};
// Charts and three.js are most of the page's bytes, and the first views need neither.
const showResult: View = async (...view) => (await import("./views/result").catch(notLoaded)).showResult(...view);
const showWalk: View = async (...view) => (await import("./views/walk").catch(notLoaded)).showWalk(...view);
const VIEWS: Record<Route["view"], View> = {
  jobs: showJobs,
  new: showSubmit,
  job: showJob,
  result: showResult,
  walk: showWalk,
  unknown: showUnknown,
};

const host = document.getElementById("content")!;
let leave = new AbortController();

async function show(): Promise<void> {
  leave.abort();
  leave = new AbortController();
  const { signal } = leave;
  const route = parseRoute(location.hash);
  document.body.dataset["view"] = route.view;
  host.replaceChildren();
  for (const link of document.querySelectorAll("header.bar nav a"))
    link.setAttribute("aria-current", link.getAttribute("href") === (route.view === "new" ? "#/new" : "#/") ? "page" : "false");
  try {
    await VIEWS[route.view](host, route, signal);
  } catch (error) {
    if (signal.aborted) return;
    if (host.querySelector("h1") === null) host.replaceChildren(element("h1", {}, "This cannot be shown"));
    host.append(failureBox(error));
  }
}

document.querySelector(".skip")!.addEventListener("click", (event) => {
  event.preventDefault(); // "#content" is no view's address
  host.focus();
});
addEventListener("hashchange", (event) => {
  void show();
  if (event.oldURL !== "") host.focus();
});
void show();
