// The list of jobs, kept fresh by asking again.

import { isWalkable, JOB_KINDS, listJobs, type Job } from "../api";
import { button, element, replaceIfChanged, table, type Column } from "../elements";
import { jobTitle, progressElement, stageText, stateElement, tookText } from "../job_text";
import { failureBox } from "../problem";
import { jobAddress, type Route } from "../router";
import { ago, percent } from "../text";

const REFRESH_MS = 2000;

function actions(job: Job): HTMLElement {
  const link = (view: "result" | "walk", text: string) =>
    element("a", { href: jobAddress(job.id, view), "aria-label": `${text} of ${jobTitle(job)}` }, text);
  if (job.state !== "succeeded" || job.artifacts.length === 0) return element("span");
  return element("span", {}, link("result", "Result"), isWalkable(job) && " \u00b7 ", isWalkable(job) && link("walk", "Walk"));
}

function progressCell(job: Job): HTMLElement {
  if (job.state !== "running") return element("span", {}, tookText(job));
  return element("span", {}, progressElement(job), ` ${percent(job.fraction)} ${stageText(job.stage)}`);
}

// Of a narrow window only the first are seen without scrolling.
const COLUMNS: readonly Column<Job>[] = [
  { title: "Job", cell: (job) => element("a", { href: jobAddress(job.id) }, jobTitle(job)) },
  { title: "State", cell: stateElement },
  { title: "Look at", cell: actions },
  { title: "Progress or time taken", cell: progressCell },
  { title: "Kind", cell: (job) => job.kind },
  { title: "Scene", cell: (job) => job.scene?.name ?? "" },
  { title: "Created", cell: (job) => element("time", { datetime: job.created, title: job.created }, ago(job.created)) },
];

function nothing(filtered: boolean): HTMLElement {
  if (filtered)
    return element(
      "div",
      { class: "empty" },
      element("h2", {}, "No job of this kind and state"),
      element("p", {}, "Others may be there: choose \u201call\u201d."),
    );
  return element(
    "div",
    { class: "empty" },
    element("h2", {}, "No job yet"),
    element(
      "p",
      {},
      "A job takes a scene and a frame-time budget and finds the views that are too slow, and the impostors that make them fast enough.",
    ),
    element("p", {}, element("a", { class: "button primary", href: "#/new" }, "Submit the first one")),
  );
}

function choice(id: string, label: string, values: readonly string[], current: string): { node: HTMLElement; select: HTMLSelectElement } {
  const select = element(
    "select",
    { id },
    element("option", { value: "" }, "all"),
    ...values.map((value) => element("option", { value, selected: value === current }, value)),
  );
  return { node: element("label", { for: id }, `${label} `, select), select };
}

class JobList {
  private readonly kind;
  private readonly state;
  private readonly list = element("div", { class: "jobs" });
  private readonly more = element("div", { class: "actions" });
  private older: Job[] = []; // pages after the first, as they were when asked for
  private next: string | null = null;

  constructor(
    host: HTMLElement,
    query: URLSearchParams,
    private readonly signal: AbortSignal,
  ) {
    this.kind = choice("kind", "Kind", JOB_KINDS, query.get("kind") ?? "");
    this.state = choice("state", "State", ["queued", "running", "succeeded", "failed", "cancelled"], query.get("state") ?? "");
    for (const { select } of [this.kind, this.state]) select.addEventListener("change", () => this.refilter());
    host.append(
      element("div", { class: "controls" }, this.kind.node, this.state.node, element("a", { class: "button", href: "#/new" }, "New job")),
      this.list,
      this.more,
    );
  }

  private get filters(): { kind?: string; state?: string } {
    const { value: kind } = this.kind.select,
      { value: state } = this.state.select;
    return { ...(kind !== "" && { kind }), ...(state !== "" && { state }) };
  }

  private refilter(): void {
    this.older = [];
    void this.refresh();
  }

  async refresh(): Promise<void> {
    try {
      const page = await listJobs(this.filters, this.signal);
      if (this.older.length === 0) this.next = page.next;
      const known = new Set(page.jobs.map((job) => job.id));
      this.show([...page.jobs, ...this.older.filter((job) => !known.has(job.id))]);
    } catch (error) {
      if (!this.signal.aborted) replaceIfChanged(this.list, failureBox(error));
    }
  }

  private show(jobs: readonly Job[]): void {
    replaceIfChanged(
      this.list,
      jobs.length === 0 ? nothing(Object.keys(this.filters).length > 0) : table(COLUMNS, jobs, "Jobs, newest first"),
    );
    this.more.replaceChildren(...(this.next === null ? [] : [button("Older jobs", () => void this.showOlder())]));
  }

  private async showOlder(): Promise<void> {
    const page = await listJobs({ ...this.filters, after: this.next! }, this.signal);
    this.older.push(...page.jobs);
    this.next = page.next;
    await this.refresh();
  }
}

export async function showJobs(host: HTMLElement, { query }: Route, signal: AbortSignal): Promise<void> {
  document.title = "Jobs \u2014 Standin";
  host.append(element("h1", {}, "Jobs"));
  const list = new JobList(host, query, signal);
  const timer = setInterval(() => document.visibilityState === "visible" && void list.refresh(), REFRESH_MS);
  signal.addEventListener("abort", () => clearInterval(timer));
  await list.refresh();
}
