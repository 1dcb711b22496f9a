// One job: how far it is, what it was asked, what went wrong, and the files that it made.

import { cancelJob, deleteJob, getJob, isFinal, isWalkable, watchJob, type Artifact, type Job, type JobKind, type Progress } from "../api";
import { artifactLink } from "../artifact_link";
import { bestSoFar } from "../best_so_far";
import { button, element, factList, folded, replaceIfChanged, section, table } from "../elements";
import { jobTitle, KIND_TEXT, progressElement, stageText, stateElement, stateWord, tookText, whatItIs } from "../job_text";
import { failureBox, problemBox } from "../problem";
import { jobAddress, type Route } from "../router";
import { bytes, percent } from "../text";

const CONTENT: Record<string, string> = {
  "placement.json": "what to draw for any view: the runtime contract",
  "impostors.glb": "the impostors, glTF 2.0",
  "lods.glb": "simpler forms of objects",
  "metrics.json": "every number",
  "report.html": "the result as one page, pictures first",
  "sweep.json": "memory against the budget",
  "verify.json": "what was measured",
  "target.json": "the machine's time model",
  "result.json": "what the command printed: the main numbers",
};
const WORST_VIEW = /^worst_view_\d+\.png$/;
const contentOf = (path: string) => CONTENT[path] ?? (WORST_VIEW.test(path) ? "a worst view: original, with impostors, difference" : "");

/// What it means that the aim was not met.
const MISSED_TEXT: Record<JobKind, string> = {
  place: "not every view could be brought within the budget; the result names those",
  survey: "not every view can be brought within the budget; the result names those",
  sweep: "not every budget is met, or the curve is worse than what it was held against; the result says which",
  calibrate: "frame times are not predicted as well as was asked; the result says how well",
  verify: "the placement does not keep what it promises; the result says what was found",
  bake: "the impostor does not keep its promise; the result says what was found",
};

function stateText(job: Job): string {
  switch (job.state) {
    case "queued":
      return "Waits for its turn. Timing stages run alone on the machine, so a queue is normal.";
    case "running":
      return job.cancel_asked === true
        ? "Cancelling: it stops at its next check point."
        : `${percent(job.fraction)}, ${stageText(job.stage) || "starting"}; running for ${tookText(job)}${job.attempts > 1 ? `, attempt ${job.attempts}` : ""}`;
    case "succeeded":
      return job.aim_met === false
        ? `Took ${tookText(job)}. The results are there, but ${MISSED_TEXT[job.kind]}.`
        : `Took ${tookText(job)}.`;
    case "failed":
      return "Nothing was written. What went wrong is below; a job with the fault mended can be submitted again.";
    case "cancelled":
      return "Stopped on request; nothing was written.";
  }
}

const inHand = (job: Job) => (job.best_so_far === null || isFinal(job.state) ? null : bestSoFar(job.best_so_far));

function artifacts(job: Job): HTMLElement {
  if (job.artifacts.length === 0)
    return section(
      "files",
      "Files",
      isFinal(job.state) ? "This job left no files." : "Files appear when the job has finished, all at once.",
    );
  const columns = [
    { title: "file", cell: (file: Artifact) => artifactLink(file, file.path, { save: true, class: "file-name" }) },
    { title: "holds", cell: (file: Artifact) => contentOf(file.path) },
    { title: "size", number: true, cell: (file: Artifact) => bytes(file.bytes) },
    { title: "SHA-256", cell: (file: Artifact) => element("code", { title: file.sha256 }, file.sha256.slice(0, 16)) },
  ];
  return section("files", "Files", "", table(columns, job.artifacts, "Files of the job"));
}

function facts(job: Job): HTMLElement {
  const times = [
    ["created", job.created],
    ["started", job.started],
    ["finished", job.finished],
  ] as const;
  return section(
    "asked",
    "What was asked",
    "",
    factList([
      ["kind", KIND_TEXT[job.kind]],
      ["scene", job.scene === null ? "none" : `${job.scene.name}, ${bytes(job.scene.bytes)}`],
      ...times.flatMap(([name, time]): [string, HTMLElement][] =>
        time === null ? [] : [[name, element("time", { datetime: time }, new Date(time).toLocaleString())]],
      ),
    ]),
    folded("The whole request", element("pre", { tabindex: 0, class: "scroll" }, JSON.stringify(job.request, null, 2))),
  );
}

class JobPage {
  private readonly state = element("section", { "aria-label": "State" });
  private readonly rest = element("div");
  private readonly failure = element("div");
  private restShown = "";

  constructor(
    host: HTMLElement,
    private job: Job,
    private readonly signal: AbortSignal,
  ) {
    host.append(
      element("h1", {}, jobTitle(job)),
      element("p", { class: "context" }, [job.label && whatItIs(job), `id ${job.id}`].filter(Boolean).join(" \u00b7 ")),
      this.failure,
      this.state,
      this.rest,
    );
    this.show();
  }

  private show(): void {
    const { job } = this;
    document.title = `${stateWord(job)}: ${jobTitle(job)} \u2014 Standin`;
    replaceIfChanged(
      this.state,
      element("p", { role: "status" }, stateElement(job)),
      element("p", {}, stateText(job)),
      ...[progressElement(job), inHand(job)].filter((node) => node !== null),
    );
    const key = `${job.state} ${job.cancel_asked} ${job.started} ${job.artifacts.length}`;
    if (key === this.restShown) return; // what is unfolded or focused there stays so
    this.restShown = key;
    const actions = element("div", { class: "actions" }, ...this.actions());
    this.rest.replaceChildren(actions, ...(job.error === null ? [] : [problemBox(job.error)]), artifacts(job), facts(job));
  }

  private actions(): Node[] {
    const { job } = this;
    if (job.cancel_asked === true && !isFinal(job.state)) return [];
    if (!isFinal(job.state)) return [button("Cancel this job", () => void this.act(async () => (this.job = await cancelJob(job.id))))];
    const result = job.state === "succeeded" && [element("a", { class: "button primary", href: jobAddress(job.id, "result") }, "Result")];
    const walk = isWalkable(job) && [element("a", { class: "button", href: jobAddress(job.id, "walk") }, "Walk through it")];
    const remove = button(
      "Delete job and files",
      () =>
        confirm("Delete this job and its files? This cannot be undone.") &&
        void this.act(async () => {
          await deleteJob(job.id);
          location.hash = "#/";
        }),
    );
    return [...(result || []), ...(walk || []), remove];
  }

  private async act(action: () => Promise<unknown>): Promise<void> {
    try {
      await action();
      this.failure.replaceChildren();
      this.show();
    } catch (error) {
      this.failure.replaceChildren(failureBox(error));
    }
  }

  /// Follows the job to its end; what comes over the stream is little, so the final document is fetched.
  async follow(): Promise<void> {
    if (isFinal(this.job.state)) return;
    const tick = setInterval(() => this.show(), 1000); // the time that it runs
    this.signal.addEventListener("abort", () => clearInterval(tick));
    await watchJob(this.job.id, this.signal, (progress) => this.apply(progress));
    clearInterval(tick);
    if (this.signal.aborted) return;
    this.job = await getJob(this.job.id, this.signal);
    this.show();
  }

  private apply({ state, stage, fraction, best_so_far }: Progress): void {
    if (state !== undefined && isFinal(state)) return; // files and outcome come with the document
    this.job = {
      ...this.job,
      ...(state && { state }),
      ...(stage !== undefined && { stage }),
      ...(fraction !== undefined && { fraction }),
      best_so_far: best_so_far ?? null,
      started: this.job.started ?? (state === "running" ? new Date().toISOString() : null),
    };
    this.show();
  }
}

export async function showJob(host: HTMLElement, { id }: Route, signal: AbortSignal): Promise<void> {
  document.title = "Job \u2014 Standin";
  const job = await getJob(id, signal);
  if (signal.aborted) return;
  await new JobPage(host, job, signal).follow();
}
