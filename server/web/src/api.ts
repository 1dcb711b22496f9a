// The service's HTTP API: the one place of this page that talks to the server.

export type JobKind = "survey" | "place" | "calibrate" | "sweep" | "verify" | "bake";
export const JOB_KINDS: readonly JobKind[] = ["place", "survey", "sweep", "calibrate", "verify", "bake"];
export type JobState = "queued" | "running" | "succeeded" | "failed" | "cancelled";

export interface Problem {
  readonly title: string;
  readonly status: number;
  readonly detail?: string;
  readonly word?: string;
  readonly errors?: readonly { readonly pointer: string; readonly detail: string }[];
}
export interface Artifact {
  readonly path: string;
  readonly bytes: number;
  readonly sha256: string;
  readonly type: string;
  readonly href: string;
}
export interface FileReference {
  readonly upload?: string;
  readonly name?: string;
  readonly job?: string;
}
export interface JobRequest {
  readonly kind: JobKind;
  readonly scene?: FileReference;
  readonly target?: FileReference;
  readonly job?: string;
  readonly label?: string;
  readonly spec?: Record<string, unknown>;
  readonly arguments?: Record<string, unknown>;
  readonly dry_run?: boolean;
}
export interface Job {
  readonly id: string;
  readonly kind: JobKind;
  readonly label: string;
  readonly state: JobState;
  readonly aim_met: boolean | null;
  readonly stage: string | null;
  readonly fraction: number | null;
  readonly created: string;
  readonly started: string | null;
  readonly finished: string | null;
  readonly attempts: number;
  readonly cancel_asked?: boolean;
  readonly best_so_far: Record<string, unknown> | null;
  readonly error: Problem | null;
  readonly request: JobRequest;
  readonly scene: { readonly name: string; readonly bytes: number; readonly href: string } | null;
  readonly artifacts: readonly Artifact[];
}
export interface Progress {
  readonly state?: JobState;
  readonly stage?: string | null;
  readonly fraction?: number | null;
  readonly best_so_far: Job["best_so_far"];
}
export interface Upload {
  readonly id: string;
  readonly name: string;
  readonly bytes: number;
  readonly created: string;
}
export interface NamedFile {
  readonly name: string;
  readonly bytes: number;
}
export interface Preset {
  readonly name: string;
  readonly spec: Record<string, unknown>;
}
export interface Prediction {
  readonly valid: boolean;
  readonly predicted?: { readonly seconds?: number; readonly peak_rss_bytes?: number };
}

export const isFinal = (state: JobState) => state === "succeeded" || state === "failed" || state === "cancelled";

/// Whether the page can walk through its result: browsers draw GLB alone.
export const isWalkable = (job: Job) =>
  job.state === "succeeded" && job.kind === "place" && job.scene !== null && /\.glb$/i.test(job.scene.name);

/// A problem document (RFC 9457), or what a failure without one amounts to.
export class ProblemError extends Error {
  constructor(readonly problem: Problem) {
    super(problem.detail ?? problem.title);
  }
}

const TOKEN_KEY = "standin-token"; // of this tab: gone when it closes
export const setToken = (token: string) => sessionStorage.setItem(TOKEN_KEY, token);
export const hasToken = () => sessionStorage.getItem(TOKEN_KEY) !== null;

function authorization(): Record<string, string> {
  const token = sessionStorage.getItem(TOKEN_KEY);
  return token === null ? {} : { Authorization: `Bearer ${token}` };
}

function problemOf(status: number, text: string): Problem {
  try {
    const problem = JSON.parse(text) as Problem;
    if (typeof problem.title === "string") return problem;
  } catch {
    // not a problem document: something between here and the server answered
  }
  return { title: `The server answered ${status}`, status };
}

async function send(path: string, options: RequestInit = {}): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(path, {
      ...options,
      headers: { ...authorization(), ...(options.headers as Record<string, string> | undefined) },
    });
  } catch (error) {
    if (options.signal?.aborted === true) throw error;
    throw new ProblemError({
      title: "The server cannot be reached",
      status: 0,
      detail: "It may be stopped or restarting; jobs that it accepted are kept.",
    });
  }
  if (!response.ok) throw new ProblemError(problemOf(response.status, await response.text()));
  return response;
}

async function json<T>(path: string, options: RequestInit = {}): Promise<T> {
  return (await (await send(path, options)).json()) as T;
}

const withBody = (method: string, body: unknown): RequestInit => ({
  method,
  body: JSON.stringify(body),
  headers: { "Content-Type": "application/json" },
});
const jobPath = (id: string) => `/v1/jobs/${encodeURIComponent(id)}`;

export const listJobs = (filters: { state?: string; kind?: string; after?: string }, signal?: AbortSignal) => {
  const query = new URLSearchParams({ limit: "50", ...filters });
  return json<{ jobs: Job[]; next: string | null }>(`/v1/jobs?${query}`, signal ? { signal } : {});
};
export const getJob = (id: string, signal?: AbortSignal) => json<Job>(jobPath(id), signal ? { signal } : {});
export const cancelJob = (id: string) => json<Job>(`${jobPath(id)}/cancel`, { method: "POST" });
export const deleteJob = (id: string) => send(jobPath(id), { method: "DELETE" });
export const submitJob = (request: JobRequest, key: string) => {
  const options = withBody("POST", request);
  return json<Job>("/v1/jobs", { ...options, headers: { ...(options.headers as Record<string, string>), "Idempotency-Key": key } });
};
export const predictJob = (request: JobRequest) => json<Prediction>("/v1/jobs", withBody("POST", { ...request, dry_run: true }));
export const getSchema = () => json<object>("/v1/schema");
export const getPresets = async () => (await json<{ presets: Preset[] }>("/v1/presets")).presets;
export const getScenes = async () => (await json<{ scenes: NamedFile[] }>("/v1/scenes")).scenes;
export const getTargets = async () => (await json<{ targets: NamedFile[] }>("/v1/targets")).targets;
export const getUploads = async () => (await json<{ uploads: Upload[] }>("/v1/uploads")).uploads;

export const artifactOf = (job: Job, path: string) => job.artifacts.find((artifact) => artifact.path === path);
export const getText = async (href: string, signal?: AbortSignal) => (await send(href, signal ? { signal } : {})).text();
export const getBlob = async (href: string, signal?: AbortSignal) => (await send(href, signal ? { signal } : {})).blob();

/// Bytes with progress: `onBytes` hears how many have come.
export async function getBytes(href: string, signal: AbortSignal, onBytes: (received: number) => void): Promise<ArrayBuffer> {
  const reader = (await send(href, { signal })).body!.getReader();
  const chunks: Uint8Array[] = [];
  let received = 0;
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    chunks.push(part.value);
    onBytes((received += part.value.length));
  }
  const whole = new Uint8Array(received);
  let at = 0;
  for (const chunk of chunks) {
    whole.set(chunk, at);
    at += chunk.length;
  }
  return whole.buffer;
}

/// Uploads by XMLHttpRequest, since fetch tells nothing about bytes sent.
export function upload(file: File, onShare: (share: number) => void, signal: AbortSignal): Promise<Upload> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("POST", `/v1/uploads?name=${encodeURIComponent(file.name)}`);
    for (const [name, value] of Object.entries(authorization())) request.setRequestHeader(name, value);
    request.setRequestHeader("Content-Type", file.name.endsWith(".json") ? "application/json" : "application/octet-stream");
    request.upload.addEventListener("progress", (event) => event.lengthComputable && onShare(event.loaded / event.total));
    request.addEventListener("load", () =>
      request.status < 300
        ? resolve(JSON.parse(request.responseText) as Upload)
        : reject(new ProblemError(problemOf(request.status, request.responseText))),
    );
    request.addEventListener("error", () =>
      reject(new ProblemError({ title: "The upload broke off", status: 0, detail: "The server cannot be reached or refused the file." })),
    );
    request.addEventListener("abort", () => reject(new DOMException("The upload was given up", "AbortError")));
    signal.addEventListener("abort", () => request.abort());
    request.send(file);
  });
}

interface ServerEvent {
  id: string;
  data: string;
}

/// Complete events of a stream's text, and what is left of it.
export function splitEvents(text: string): { events: ServerEvent[]; rest: string } {
  const blocks = text.replaceAll("\r\n", "\n").split("\n\n");
  const rest = blocks.pop()!;
  const events = blocks.map((block) => {
    const field = (name: string) =>
      block
        .split("\n")
        .filter((line) => line.startsWith(`${name}:`))
        .map((line) => line.slice(name.length + 1).trimStart())
        .join("\n");
    return { id: field("id"), data: field("data") };
  });
  return { events: events.filter((event) => event.data !== ""), rest };
}

const pause = (milliseconds: number, signal: AbortSignal) =>
  new Promise<void>((resolve) => {
    const end = () => {
      clearTimeout(timer);
      signal.removeEventListener("abort", end);
      resolve();
    };
    const timer = setTimeout(end, milliseconds);
    signal.addEventListener("abort", end);
  });

const isRefusal = (error: unknown) => error instanceof ProblemError && error.problem.status >= 400 && error.problem.status < 500;
const isBusy = (error: unknown) => error instanceof ProblemError && error.problem.word === "busy";

/// A job's events until its final state (true) or the end of the connection. By fetch, since EventSource sends no token.
async function readEvents(
  id: string,
  last: { id: string },
  signal: AbortSignal,
  onProgress: (progress: Progress) => void,
): Promise<boolean> {
  const response = await send(`${jobPath(id)}/events`, {
    signal,
    headers: { Accept: "text/event-stream", ...(last.id === "" ? {} : { "Last-Event-ID": last.id }) },
  });
  const reader = response.body!.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    const { events, rest } = splitEvents(text + part.value);
    text = rest;
    for (const event of events) {
      if (event.id !== "") last.id = event.id;
      const progress = JSON.parse(event.data) as Progress;
      onProgress(progress);
      if (progress.state !== undefined && isFinal(progress.state)) return true;
    }
  }
  return false;
}

const POLL_MS = 3000;
const LONGEST_PAUSE_MS = 10_000;

/// What becomes of a job, until its final state: by its events, resumed when the connection breaks, or, where the service has no stream left
/// for this page (`busy`), by asking every few seconds.
export async function watchJob(id: string, signal: AbortSignal, onProgress: (progress: Progress) => void): Promise<void> {
  const last = { id: "" };
  let failures = 0,
    polls = false;
  const heard = (progress: Progress) => {
    failures = 0;
    onProgress(progress);
  };
  const poll = async () => {
    const job = await getJob(id, signal);
    heard(job);
    return isFinal(job.state);
  };
  while (!signal.aborted) {
    try {
      if (await (polls ? poll() : readEvents(id, last, signal, heard))) return;
    } catch (error) {
      if (signal.aborted) return;
      if (isRefusal(error)) throw error;
      polls ||= isBusy(error);
    }
    await pause(polls ? POLL_MS : Math.min(LONGEST_PAUSE_MS, 500 * 2 ** failures++), signal);
  }
}
