// A new job: kind, scene, target, budget; everything else has a default and is folded away.

import {
  getPresets,
  getScenes,
  getSchema,
  getTargets,
  getUploads,
  JOB_KINDS,
  listJobs,
  predictJob,
  ProblemError,
  submitJob,
  type Job,
  type JobKind,
  type JobRequest,
  type Preset,
  type Problem,
} from "../api";
import { button, element, folded } from "../elements";
import { jobTitle, KIND_TEXT } from "../job_text";
import { failureBox } from "../problem";
import { jobAddress, type Route } from "../router";
import { bytes, duration, isNumber } from "../text";
import { FileChoice, namedFiles, uploadedFiles, type ServerFile } from "./file_choice";
import { SchemaForm } from "./schema_form";

interface Choices {
  readonly schema: object;
  readonly presets: Preset[];
  readonly scenes: ServerFile[];
  readonly targets: ServerFile[];
  readonly placements: Job[];
}

async function loadChoices(): Promise<Choices> {
  const [schema, presets, scenes, targets, uploads, jobs] = await Promise.all([
    getSchema(),
    getPresets().catch(() => []),
    getScenes(),
    getTargets(),
    getUploads(),
    listJobs({ state: "succeeded" }),
  ]);
  const isTarget = (name: string) => name.toLowerCase().endsWith(".json");
  const calibrated = jobs.jobs
    .filter((job) => job.kind === "calibrate")
    .map((job) => ({
      value: `job:${job.id}`,
      text: `${jobTitle(job)}, made ${new Date(job.created).toLocaleString()}`,
      reference: { job: job.id },
    }));
  return {
    schema,
    presets,
    scenes: [...namedFiles(scenes), ...uploadedFiles(uploads.filter(({ name }) => !isTarget(name)))],
    targets: [...namedFiles(targets), ...calibrated, ...uploadedFiles(uploads.filter(({ name }) => isTarget(name)))],
    placements: jobs.jobs.filter((job) => job.kind === "place"),
  };
}

/** What a kind is asked for on the form; a calibration does without a scene, too. */
const NEEDS: Record<JobKind, { scene: boolean; target: boolean; budget: "needed" | "optional" | "none"; placement: boolean }> = {
  place: { scene: true, target: true, budget: "needed", placement: false },
  survey: { scene: true, target: true, budget: "optional", placement: false },
  sweep: { scene: true, target: true, budget: "none", placement: false },
  calibrate: { scene: true, target: false, budget: "none", placement: false },
  verify: { scene: false, target: false, budget: "none", placement: true },
  bake: { scene: true, target: false, budget: "none", placement: false },
};

interface Argument {
  readonly name: string;
  readonly label: string;
  readonly help: string;
  readonly numeric: boolean;
}
const ARGUMENTS: Partial<Record<JobKind, readonly Argument[]>> = {
  calibrate: [
    { name: "seconds", label: "seconds", help: "time to spend; empty: the default", numeric: true },
    { name: "target_error", label: "target error", help: "stop at this median error, a share such as 0.1", numeric: true },
    { name: "coverage", label: "coverage", help: "share of frames that the bound is to cover, such as 0.99", numeric: true },
  ],
  bake: [
    { name: "objects", label: "objects", help: "ids to stand for, such as 3-9", numeric: false },
    { name: "view_cell", label: "view cell", help: "such as shaft:1,0,0,45,30", numeric: false },
    { name: "technique", label: "technique", help: "layered, tdm, planar or lod-sprite", numeric: false },
    { name: "views", label: "views", help: "views to judge the image in", numeric: true },
  ],
  verify: [{ name: "judged_views", label: "judged views", help: "views inside view cells to judge by rays", numeric: true }],
};

function field(pointer: string, id: string, label: string, input: HTMLElement, help: string): HTMLElement {
  input.setAttribute("aria-describedby", `${id}-help`);
  return element(
    "div",
    { class: "field", "data-pointer": pointer },
    element("label", { for: id }, label),
    input,
    element("p", { class: "soft", id: `${id}-help` }, help),
  );
}

class SubmitForm {
  private kind: JobKind = "place";
  private readonly scene: FileChoice;
  private readonly target: FileChoice;
  private readonly settings: SchemaForm;
  private readonly budget = element("input", { id: "budget", type: "number", min: 0, step: "any", inputmode: "decimal" });
  private readonly budgets = element("input", { id: "budgets", type: "text", inputmode: "decimal" });
  private readonly placement: HTMLSelectElement;
  private readonly preset: HTMLSelectElement;
  private readonly label = element("input", { id: "label", type: "text", maxlength: 200 });
  private readonly argumentFields = element("div");
  private readonly outcome = element("div", { "aria-live": "polite", tabindex: -1 });
  private readonly parts: Record<"scene" | "target" | "budget" | "budgets" | "placement" | "settings", HTMLElement>;
  // One key per form: a click too many, or a retry after a broken connection, makes no second job.
  private key = crypto.randomUUID();
  readonly element: HTMLFormElement;

  constructor(choices: Choices, signal: AbortSignal) {
    this.scene = new FileChoice(
      "scene",
      "GLB, through which the page can walk; glTF, OBJ, PLY, STL and others; several files of one scene as a ZIP archive",
      choices.scenes,
      signal,
    );
    this.target = new FileChoice(
      "target",
      "A target file says what costs how much on the machine that is to draw; calibrate makes one",
      choices.targets,
      signal,
    );
    this.settings = new SchemaForm(choices.schema, new Set(["budget_ms", "sweep.budgets_ms"]));
    this.placement = element(
      "select",
      { id: "placement" },
      element("option", { value: "" }, choices.placements.length === 0 ? "no finished placement" : "choose\u2026"),
      ...choices.placements.map((job) =>
        element("option", { value: job.id }, `${jobTitle(job)}, made ${new Date(job.created).toLocaleString()}`),
      ),
    );
    this.preset = element(
      "select",
      { id: "preset" },
      element("option", { value: "" }, "defaults"),
      ...choices.presets.map(({ name }) => element("option", { value: name }, name)),
    );
    this.preset.addEventListener("change", () =>
      this.settings.apply(choices.presets.find(({ name }) => name === this.preset.value)?.spec ?? {}),
    );
    this.parts = {
      scene: element("fieldset", {}, element("legend", {}, "Scene"), this.scene.element),
      target: element("fieldset", {}, element("legend", {}, "Target machine"), this.target.element),
      placement: field("/job", "placement", "placement", this.placement, "the finished job of kind place to verify"),
      budget: field("/spec/budget_ms", "budget", "budget, ms", this.budget, ""),
      budgets: field(
        "/spec/sweep/budgets_ms",
        "budgets",
        "budgets, ms",
        this.budgets,
        "with commas between; empty: 10 between reachable and needless",
      ),
      settings: folded("More settings", field("", "preset", "preset", this.preset, "fills in the settings below"), this.settings.element),
    };
    this.element = this.layout();
    this.element.addEventListener("input", () => (this.key = crypto.randomUUID()));
    this.element.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.submit();
    });
    this.choose("place");
  }

  private layout(): HTMLFormElement {
    const kinds = JOB_KINDS.map((kind) => {
      const radio = element("input", { type: "radio", name: "kind", id: `kind-${kind}`, value: kind, checked: kind === "place" });
      radio.addEventListener("change", () => this.choose(kind));
      return element("label", { for: `kind-${kind}` }, radio, KIND_TEXT[kind]);
    });
    const goal = element(
      "fieldset",
      {},
      element("legend", {}, "Job"),
      this.parts.placement,
      this.parts.budget,
      this.parts.budgets,
      this.argumentFields,
      field("/label", "label", "label", this.label, "free text, to find the job again"),
      this.parts.settings,
    );
    return element(
      "form",
      { novalidate: true },
      element("fieldset", {}, element("legend", {}, "Kind"), element("div", { class: "options" }, ...kinds)),
      this.parts.scene,
      this.parts.target,
      goal,
      element(
        "div",
        { class: "actions" },
        element("button", { type: "submit", class: "primary" }, "Submit"),
        button("Check, and predict time and memory", () => void this.predict()),
      ),
      this.outcome,
    );
  }

  private choose(kind: JobKind): void {
    this.kind = kind;
    const needs = NEEDS[kind];
    this.parts.scene.hidden = !needs.scene;
    this.parts.scene.querySelector("legend")!.textContent =
      kind === "calibrate" ? "Scene that is to be placed (none: built-in cities, for any scene with textures)" : "Scene";
    this.parts.target.hidden = !needs.target;
    this.parts.placement.hidden = !needs.placement;
    this.parts.budget.hidden = needs.budget === "none";
    this.parts.budgets.hidden = kind !== "sweep";
    this.parts.budget.querySelector("p")!.textContent =
      needs.budget === "needed" ? "time that no frame may take; a survey says how low it can go" : "optional: colours the heat map by it";
    this.argumentFields.replaceChildren(
      ...(ARGUMENTS[kind] ?? []).map(({ name, label, help, numeric }) =>
        field(
          `/arguments/${name}`,
          `argument-${name}`,
          label,
          element("input", { id: `argument-${name}`, type: numeric ? "number" : "text", step: "any" }),
          help,
        ),
      ),
    );
  }

  private request(): JobRequest {
    const needs = NEEDS[this.kind];
    const spec = this.settings.spec();
    if (needs.budget !== "none" && this.budget.value !== "") spec["budget_ms"] = Number(this.budget.value);
    if (this.kind === "sweep" && this.budgets.value.trim() !== "")
      spec["sweep"] = { ...(spec["sweep"] as object | undefined), budgets_ms: this.budgets.value.split(",").map(Number) };
    const values = (ARGUMENTS[this.kind] ?? []).flatMap(({ name, numeric }) => {
      const { value } = this.argumentFields.querySelector<HTMLInputElement>(`#argument-${name}`)!;
      return value === "" ? [] : [[name, numeric ? Number(value) : value] as const];
    });
    const scene = needs.scene ? this.scene.reference : undefined,
      target = needs.target ? this.target.reference : undefined;
    return {
      kind: this.kind,
      ...(scene && { scene }),
      ...(target && { target }),
      ...(needs.placement && { job: this.placement.value }),
      ...(this.label.value !== "" && { label: this.label.value }),
      ...(Object.keys(spec).length > 0 && { spec }),
      ...(values.length > 0 && { arguments: Object.fromEntries(values) }),
    };
  }

  private async submit(): Promise<void> {
    if (this.scene.busy || this.target.busy)
      return this.say(element("p", { role: "status" }, "An upload is still running; submit when it has finished."));
    await this.guarded(async () => {
      const job = await submitJob(this.request(), this.key);
      location.hash = jobAddress(job.id);
    });
  }

  private async predict(): Promise<void> {
    await this.guarded(async () => {
      const { predicted } = await predictJob(this.request());
      const parts = [
        isNumber(predicted?.seconds) && `about ${duration(predicted.seconds)}`,
        isNumber(predicted?.peak_rss_bytes) && `${bytes(predicted.peak_rss_bytes)} of memory`,
      ].filter((part) => part !== false);
      this.say(
        element(
          "p",
          { role: "status" },
          parts.length > 0 ? `The request is valid; it should take ${parts.join(" and ")}.` : "The request is valid.",
        ),
      );
    });
  }

  private say(node: Node): void {
    this.outcome.replaceChildren(node);
  }

  private async guarded(action: () => Promise<void>): Promise<void> {
    this.markFields([]);
    this.outcome.replaceChildren();
    try {
      await action();
    } catch (error) {
      if (error instanceof ProblemError) this.markFields(error.problem.errors ?? []);
      this.say(failureBox(error));
    }
  }

  /// Says at each field what the server says about it; the first gets the focus.
  private markFields(errors: NonNullable<Problem["errors"]>): void {
    for (const node of this.element.querySelectorAll(".error")) node.remove();
    for (const node of this.element.querySelectorAll(".wrong")) node.classList.remove("wrong");
    let first: HTMLElement | null = null;
    for (const { pointer, detail } of errors) {
      const host = [...this.element.querySelectorAll<HTMLElement>("[data-pointer]")].find(
        (node) => node.dataset["pointer"] !== "" && pointer.startsWith(node.dataset["pointer"]!) && !(node.closest("[hidden]") !== null),
      );
      if (host === undefined) continue;
      host.classList.add("wrong");
      host.append(element("p", { class: "error" }, detail));
      for (let outer = host.closest("details"); outer !== null; outer = outer.parentElement?.closest("details") ?? null) outer.open = true;
      first ??= host.querySelector<HTMLElement>("input, select");
    }
    first?.focus();
  }
}

export async function showSubmit(host: HTMLElement, _: Route, signal: AbortSignal): Promise<void> {
  document.title = "New job \u2014 Standin";
  host.append(element("h1", {}, "New job"));
  const choices = await loadChoices();
  if (!signal.aborted) host.append(new SubmitForm(choices, signal).element);
}
