// The walk: the scene with the impostors that a placement names for the viewer's position and direction, as a runtime would draw it.

import { artifactOf, getJob, getText, isFinal, type Job } from "../api";
import { artifactLink } from "../artifact_link";
import { button, element } from "../elements";
import { jobTitle } from "../job_text";
import { jobAddress, parseTriple, walkAddress, type Route } from "../router";
import { PlacementContent, type ViewContent } from "../runtime/content";
import { PlacementLookup, type Lookup } from "../runtime/lookup";
import type { Placement } from "../runtime/placement";
import { count, milliseconds } from "../text";
import { loadWalk, NotGlb, type WalkFiles } from "../walk/load";
import { Movement, type Pose } from "../walk/movement";
import { fillPanel } from "../walk/panel";
import { Stage, type FrameCost } from "../walk/stage";
import { WalkableSpace } from "../walk/view_space";

const HELP =
  "Click the picture or tab to it. W, A, S, D or arrow keys walk and turn, dragging looks around, Shift walks faster, R and F rise and sink. I switches impostors, H marks them, B goes back into the view space.";

const TELL_MS = 200; // while moving, the panel follows this often

interface StartView {
  readonly name: string;
  readonly pose: Pose;
}
interface SurveyedView {
  position: [number, number, number];
  direction: [number, number, number];
  frame_ms: number;
}

/// Views worth a look: where the survey found the slowest frames.
async function slowViews(job: Job, signal: AbortSignal): Promise<StartView[]> {
  const metrics = artifactOf(job, "metrics.json");
  if (metrics === undefined) return [];
  const { survey } = JSON.parse(await getText(metrics.href, signal)) as { survey?: { worst_views?: SurveyedView[] } };
  return (survey?.worst_views ?? []).map((view, i) => ({
    name: `${i + 1}: ${milliseconds(view.frame_ms)} estimated without impostors`,
    pose: view,
  }));
}

function centreOf(placement: Placement): Pose {
  const box = placement.view_space.boxes[0] ?? placement.scene.objects[0]!.bounds;
  return { position: [0, 1, 2].map((axis) => (box.min[axis]! + box.max[axis]!) / 2) as [number, number, number], direction: [0, 0, -1] };
}

function linkedPose({ query }: Route): Pose | null {
  const position = parseTriple(query.get("position")),
    direction = parseTriple(query.get("direction"));
  return position !== null && direction !== null && direction.some((value) => value !== 0) ? { position, direction } : null;
}

function notAGlb(job: Job): HTMLElement {
  const report = artifactOf(job, "report.html");
  return element(
    "div",
    { class: "empty" },
    element("h2", {}, "The walk needs a GLB"),
    element(
      "p",
      {},
      `${job.scene?.name ?? "The scene"} is of another format, which browsers do not draw. Convert it to GLB and place again to walk through it.`,
    ),
    report !== undefined && element("p", {}, artifactLink(report, "report.html"), " shows the same result as pictures."),
  );
}

class Walk {
  readonly canvas = element("canvas", {
    tabindex: 0,
    role: "application",
    "aria-label": "View of the scene",
    "aria-describedby": "walk-help",
  });
  private readonly panel = element("div", { class: "panel", "aria-live": "off" });
  private readonly status = element("p", { class: "soft status", role: "status" });
  private readonly lookup: PlacementLookup;
  private readonly content: PlacementContent;
  private readonly space: WalkableSpace;
  private readonly stage: Stage;
  private readonly movement: Movement;
  private readonly impostorButton: HTMLButtonElement;
  private readonly markButton: HTMLButtonElement;
  private impostorsOn = true;
  private found: Lookup = { cell: null, cpv: null };
  private shown: ViewContent = { objects: [], levels: [], impostors: [] };
  private drawn: FrameCost = { draws: 0, triangles: 0 };
  private marked = false;
  private stale = true;
  private untold = false; // panel and address lag behind the picture
  private lastFrame = 0;
  private lastTold = 0;

  constructor(
    private readonly job: Job,
    private readonly files: WalkFiles,
    views: StartView[],
    start: Pose,
    private readonly signal: AbortSignal,
  ) {
    const { placement } = files;
    this.lookup = new PlacementLookup(placement);
    this.content = new PlacementContent(placement);
    this.space = new WalkableSpace(placement);
    this.stage = new Stage(this.canvas, placement, files.objects, files.impostors);
    const onFoot = placement.view_space.kind === "walk";
    const { side } = placement.view_space.root;
    this.movement = new Movement(
      this.canvas,
      start,
      onFoot ? Math.min(4, side / 10) : side / 20,
      onFoot,
      (position) => (onFoot ? this.space.atEyeHeight(position) : position),
      () => (this.stale = true),
      signal,
    );
    this.impostorButton = button("Impostors (I)", () => this.switchImpostors(), { "aria-pressed": "true" });
    this.markButton = button("Mark them (H)", () => this.switchMark(), { "aria-pressed": "false" });
    this.listen();
    this.element = this.layout(views);
    signal.addEventListener("abort", () => this.stage.dispose());
  }

  readonly element: HTMLElement;

  private layout(views: StartView[]): HTMLElement {
    const choice = element(
      "select",
      { id: "views" },
      element("option", { value: "" }, "choose\u2026"),
      ...views.map(({ name }, i) => element("option", { value: i }, name)),
    );
    choice.addEventListener("change", () => choice.value !== "" && this.movement.jump(views[Number(choice.value)]!.pose));
    const controls = element(
      "div",
      { class: "controls" },
      this.impostorButton,
      this.markButton,
      button("Copy link to this view", () => void this.copyLink()),
      button("Back into the view space (B)", () => this.goBack()),
      views.length > 0 && element("label", { for: "views" }, "Slowest views ", choice),
    );
    const { missing } = this.files.objects;
    const warning =
      missing.length > 0 &&
      element(
        "p",
        { class: "problem" },
        `${count(missing.length)} of ${count(this.files.placement.scene.objects.length)} objects were not found in the scene file as this page reads it and are not drawn.`,
      );
    return element(
      "div",
      {},
      controls,
      this.status,
      warning,
      element(
        "div",
        { class: "walk" },
        element("div", { class: "picture" }, this.canvas, element("p", { class: "soft", id: "walk-help" }, HELP)),
        this.panel,
      ),
    );
  }

  private listen(): void {
    addEventListener(
      "keydown",
      (event) => {
        if (
          event.ctrlKey ||
          event.altKey ||
          event.metaKey ||
          event.repeat ||
          (event.target instanceof HTMLElement && event.target.tagName === "SELECT")
        )
          return;
        if (event.code === "KeyI") this.switchImpostors();
        if (event.code === "KeyH") this.switchMark();
        if (event.code === "KeyB") this.goBack();
      },
      { signal: this.signal },
    );
    const observer = new ResizeObserver(() => this.fit());
    observer.observe(this.canvas);
    this.signal.addEventListener("abort", () => observer.disconnect());
  }

  start(): void {
    this.fit();
    const frame = (now: number) => {
      if (this.signal.aborted) return;
      const seconds = Math.min(0.1, (now - this.lastFrame) / 1000);
      this.lastFrame = now;
      this.movement.advance(seconds);
      if (this.stale) this.draw();
      if (this.untold && (!this.movement.moving || now - this.lastTold > TELL_MS)) this.tell(now);
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  private fit(): void {
    const scale = Math.min(devicePixelRatio, 2);
    this.stage.resize(Math.max(1, Math.round(this.canvas.clientWidth * scale)), Math.max(1, Math.round(this.canvas.clientHeight * scale)));
    this.stale = true;
  }

  private draw(): void {
    this.stale = false;
    this.untold = true;
    const { pose } = this.movement;
    this.found = this.lookup.find(pose.position, pose.direction);
    this.shown = this.content.of(this.found, this.impostorsOn);
    this.stage.look(pose.position, pose.direction);
    this.stage.show(this.shown);
    this.drawn = this.stage.draw();
  }

  /// The panel; the state as attributes, for whoever tests this page; and the address, so that a reload comes back here.
  private tell(now: number): void {
    this.untold = false;
    this.lastTold = now;
    const { pose } = this.movement;
    const costWith = this.stage.cost(this.content.of(this.found)),
      costWithout = this.stage.cost(this.content.of(this.found, false));
    fillPanel(this.panel, this.files.placement, {
      pose,
      lookup: this.found,
      content: this.shown,
      impostorsOn: this.impostorsOn,
      with: costWith,
      without: costWithout,
    });
    Object.assign(this.canvas.dataset, {
      cell: this.found.cell,
      cpv: this.found.cpv,
      objects: this.shown.objects.length,
      impostors: this.shown.impostors.length,
      draws: this.drawn.draws,
      triangles: this.drawn.triangles,
    });
    history.replaceState(null, "", walkAddress(this.job.id, [...pose.position], [...pose.direction]));
  }

  private switchImpostors(): void {
    this.impostorsOn = !this.impostorsOn;
    this.impostorButton.setAttribute("aria-pressed", String(this.impostorsOn));
    this.say(this.impostorsOn ? "Impostors on" : "Impostors off: originals are drawn");
    this.stale = true;
  }

  private switchMark(): void {
    this.marked = !this.marked;
    this.markButton.setAttribute("aria-pressed", String(this.marked));
    this.files.impostors.mark(this.marked);
    this.say(this.marked ? "Impostors are tinted pink" : "Impostors as they are");
    this.stale = true;
  }

  private goBack(): void {
    const { pose } = this.movement;
    this.movement.jump({ ...pose, position: this.space.nearest(pose.position) });
    this.say("Back in the view space");
  }

  private async copyLink(): Promise<void> {
    try {
      await navigator.clipboard.writeText(location.href);
      this.say("Link copied");
    } catch {
      this.say("The browser does not let pages copy here; the address bar holds the link.");
    }
  }

  private say(text: string): void {
    this.status.textContent = text;
  }
}

export async function showWalk(host: HTMLElement, route: Route, signal: AbortSignal): Promise<void> {
  document.title = "Walk \u2014 Standin";
  const progress = element("p", { role: "status" }, "Loading the job");
  const job = await getJob(route.id, signal);
  if (signal.aborted) return;
  host.append(
    element("h1", {}, `Walk: ${job.scene?.name ?? job.id}`),
    element(
      "p",
      { class: "context" },
      element("a", { href: jobAddress(job.id, "result") }, "Result"),
      " \u00b7 ",
      element("a", { href: jobAddress(job.id) }, "Job"),
      `: ${jobTitle(job)}`,
    ),
  );
  if (job.kind !== "place" || !isFinal(job.state) || artifactOf(job, "placement.json") === undefined) {
    host.append(
      element(
        "div",
        { class: "empty" },
        element("h2", {}, "Nothing to walk through yet"),
        element(
          "p",
          {},
          "Only a finished job of kind place has impostors. ",
          element("a", { href: jobAddress(job.id) }, "See how far this one is"),
          ".",
        ),
      ),
    );
    return;
  }
  host.append(progress);
  try {
    const views = await slowViews(job, signal);
    const files = await loadWalk(job, signal, (what) => (progress.textContent = what));
    if (signal.aborted) return;
    const walk = new Walk(job, files, views, linkedPose(route) ?? views[0]?.pose ?? centreOf(files.placement), signal);
    progress.replaceWith(walk.element);
    walk.start();
  } catch (error) {
    if (signal.aborted) return;
    progress.remove();
    if (!(error instanceof NotGlb)) throw error;
    host.append(notAGlb(job));
  }
}
