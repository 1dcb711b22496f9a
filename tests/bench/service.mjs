// What the service withstands, and what it costs (service.md holds results).
//
//     node tests/bench/service.mjs kill   BINARY SCENE [JOBS] [KILLS] [SEED]
//     node tests/bench/service.mjs cancel BINARY SCENE [CANCELS] [SEED]
//     node tests/bench/service.mjs load   BINARY SCENE [POLLERS] [STREAMS] [SECONDS]
//     node tests/bench/service.mjs hostile BINARY SCENE [REQUESTS] [SEED] [WORKER_MEMORY_GB]
//
// kill: server or worker, in turn by chance, at random moments over a queue of jobs: none lost, none doubled, no orphan, the bytes of an
// undisturbed run. cancel: at random moments: how long it takes, what is left. load: clients that poll and listen while a job runs: errors, the
// server's memory and processor time, and the 99th percentile of GET /v1/jobs/{id} beside that of an idle server. hostile: requests that are
// malformed as HTTP, as JSON, as a body of ours, or as an upload, and surveys of such uploads: no answer above 499 but those that the routes
// name, no worker that dies, and the server lives until it is asked to end. Of a build with sanitizers (which leave no sense to
// WORKER_MEMORY_GB: 0), whatever they find ends a process: a promise is broken then. Exits with 1 where one is.
import { spawn } from "node:child_process";
import { cpSync, existsSync, mkdtempSync, mkdirSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { Agent, request } from "node:http";
import { connect } from "node:net";
import { tmpdir } from "node:os";
import { basename, dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const source = resolve(dirname(fileURLToPath(import.meta.url)), "../..");
const [, , what, binary, scene, ...numbers] = process.argv;
const folder = mkdtempSync(join(tmpdir(), "standin-service-"));
const scenes = join(folder, "scenes");
mkdirSync(scenes);
cpSync(scene, join(scenes, basename(scene)));
const children = new Set();
process.on("exit", () => {
  children.forEach((child) => child.kill("SIGKILL"));
  rmSync(folder, { recursive: true, force: true });
});

/** Of [0, 1), by a seed (mulberry32). */
function random(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

let child;
async function serve(...more) {
  child = spawn(binary, ["serve", "--data", join(folder, "data"), "--listen", "127.0.0.1:0", "--scenes", scenes, "--targets", join(source, "configs/targets"), ...more], { stdio: ["ignore", "pipe", "inherit"] });
  const own = child;
  children.add(own);
  own.once("exit", () => children.delete(own));
  return new Promise((done, fail) => {
    own.stdout.once("data", (text) => done(String(text).trim()));
    own.once("exit", (code) => fail(new Error(`serve ended with ${code}`)));
  });
}
async function killServer(signal) {
  const gone = new Promise((done) => child.once("exit", done));
  child.kill(signal);
  await gone;
}
const json = async (answer) => answer.json();
const get = async (url) => json(await fetch(url));
const post = async (url, body) => json(await fetch(url, { method: "POST", body: JSON.stringify(body), headers: { "Content-Type": "application/json" } }));
const ended = ({ state }) => !["queued", "running"].includes(state);

const spec = { budget_ms: 52, view_space: { leaf_m: 46, refine_levels: 0 }, verify: { views: 0 }, survey: { views: 200 }, visibility: { mode: "off" } };
const place = (seed, more = {}) => ({ kind: "place", scene: { name: basename(scene) }, target: { name: "reference.json" }, spec: { ...spec, seed, ...more } });

/** Processes that run a job in this bench's folder. */
function workers() {
  const found = [];
  for (const id of readdirSync("/proc").filter((name) => /^\d+$/.test(name))) {
    try {
      const words = readFileSync(`/proc/${id}/cmdline`, "utf8").split("\0");
      if (words[1] === "work" && words[2].startsWith(folder)) found.push(Number(id));
    } catch {} // it has ended
  }
  return found;
}
const promise = (held, sentence) => {
  console.log(`${held ? "held  " : "BROKEN"} ${sentence}`);
  if (!held) process.exitCode = 1;
};
const quantile = (values, share) => values.sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(share * values.length))];

async function artifacts(url, id) {
  const { state, error, artifacts: files } = await get(`${url}/v1/jobs/${id}`);
  return { state, error, sums: Object.fromEntries(files.filter(({ path }) => ["placement.json", "impostors.glb"].includes(path)).map(({ path, sha256 }) => [path, sha256])) };
}

async function kill(jobs = 20, kills = 50, seed = 1) {
  const chance = random(seed);
  const attempts = ["--attempts", "1000"];
  let url = await serve(...attempts);
  const ids = [];
  for (let i = 0; i < jobs; ++i) ids.push((await post(`${url}/v1/jobs`, place(i + 1))).id);
  const done = { server: 0, worker: 0 };
  let orphans = 0;
  while (done.server + done.worker < kills) {
    await sleep(100 + 1500 * chance());
    if (chance() < 0.5) {
      const of = workers()[0];
      if (of === undefined) continue;
      process.kill(of, "SIGKILL");
      ++done.worker;
    } else {
      await killServer("SIGKILL");
      ++done.server;
      await sleep(300);
      orphans += workers().length;
      url = await serve(...attempts);
    }
    if ((await Promise.all(ids.map((id) => get(`${url}/v1/jobs/${id}`)))).every(ended)) break;
  }
  const all = await get(`${url}/v1/jobs?limit=200`);
  promise(all.jobs.length === jobs && new Set(all.jobs.map(({ id }) => id)).size === jobs, `${jobs} jobs submitted, ${all.jobs.length} known after ${done.server} kills of the server and ${done.worker} of a worker`);
  for (let i = 0; i < 6000 && !(await Promise.all(ids.map((id) => get(`${url}/v1/jobs/${id}`)))).every(ended); ++i) await sleep(200);
  const disturbed = await Promise.all(ids.map((id) => artifacts(url, id)));
  await killServer("SIGTERM");
  promise(orphans === 0 && workers().length === 0, `${orphans} orphans after the server's death`);
  promise(readdirSync(join(folder, "data/work")).length === 0, "no work folder is left");
  promise(disturbed.every(({ state }) => state === "succeeded"), `states: ${[...new Set(disturbed.map(({ state, error }) => state + (error ? ` (${error.detail})` : "")))].join(", ")}`);

  rmSync(join(folder, "data"), { recursive: true });
  url = await serve();
  const calm = [];
  for (let i = 0; i < jobs; ++i) calm.push((await post(`${url}/v1/jobs`, place(i + 1))).id);
  while (!(await Promise.all(calm.map((id) => get(`${url}/v1/jobs/${id}`)))).every(ended)) await sleep(200);
  const undisturbed = await Promise.all(calm.map((id) => artifacts(url, id)));
  const same = disturbed.filter(({ sums }, i) => JSON.stringify(sums) === JSON.stringify(undisturbed[i].sums) && Object.keys(sums).length === 2).length;
  promise(same === jobs, `${same} of ${jobs} results have the bytes of an undisturbed run`);
  await killServer("SIGTERM");
}

async function cancel(cancels = 20, seed = 1) {
  const chance = random(seed);
  const url = await serve();
  const took = [];
  for (let i = 0; i < cancels; ++i) {
    const { id } = await post(`${url}/v1/jobs`, place(i + 1, { visibility: { mode: "on" }, survey: { views: 20000 } }));
    while ((await get(`${url}/v1/jobs/${id}`)).state === "queued") await sleep(10);
    await sleep(6000 * chance());
    const start = performance.now();
    await post(`${url}/v1/jobs/${id}/cancel`, {});
    let job;
    while (!ended((job = await get(`${url}/v1/jobs/${id}`)))) await sleep(5);
    if (job.state === "cancelled") took.push(performance.now() - start);
    await fetch(`${url}/v1/jobs/${id}`, { method: "DELETE" });
  }
  promise(took.length >= cancels / 2 && Math.max(...took) <= 2000, `${took.length} of ${cancels} were cancelled before their end: median ${quantile(took, 0.5).toFixed(0)} ms, slowest ${Math.max(...took).toFixed(0)} ms`);
  promise(workers().length === 0 && readdirSync(join(folder, "data/work")).length === 0, "no worker and no work folder is left");
  await killServer("SIGTERM");
}

const agent = new Agent({ keepAlive: true, maxSockets: Infinity });
function timedGet(url) {
  return new Promise((done, fail) => {
    const start = performance.now();
    request(url, { agent }, (answer) => {
      answer.resume();
      answer.on("end", () => done({ status: answer.statusCode, ms: performance.now() - start }));
    })
      .on("error", fail)
      .end();
  });
}
const cpu_s = (id) => {
  const fields = readFileSync(`/proc/${id}/stat`, "utf8").split(") ")[1].split(" ");
  return (Number(fields[11]) + Number(fields[12])) / 100;
};
const rss_mb = (id) => Number(readFileSync(`/proc/${id}/status`, "utf8").match(/VmRSS:\s+(\d+)/)[1]) / 1e3;
const workerCpu_s = async (url) => Number((await (await fetch(`${url}/metrics`)).text()).match(/worker_cpu_seconds_total ([\d.e+-]+)/)[1]);

/** `pollers` clients ask every half second, each on a connection of its own. */
async function poll(url, id, pollers, seconds) {
  const times = [], wrong = [];
  const until = performance.now() + 1e3 * seconds;
  await Promise.all(
    Array.from({ length: pollers }, async (_, i) => {
      await sleep((500 * i) / pollers);
      while (performance.now() < until) {
        try {
          const { status, ms } = await timedGet(`${url}/v1/jobs/${id}`);
          times.push(ms);
          if (status !== 200) wrong.push(status);
        } catch (error) {
          wrong.push(error.code);
        }
        await sleep(500);
      }
    }),
  );
  return { times, wrong };
}

async function load(pollers = 200, streams = 50, seconds = 60) {
  const url = await serve();
  const first = await post(`${url}/v1/jobs`, place(1));
  while (!ended(await get(`${url}/v1/jobs/${first.id}`))) await sleep(100);
  const idle = await poll(url, first.id, pollers, Math.min(20, seconds));
  const rssBefore = rss_mb(child.pid);
  const jobs = [];
  for (let i = 0; i < 50; ++i) jobs.push((await post(`${url}/v1/jobs`, place(100 + i, { visibility: { mode: "on" }, survey: { views: 20000 } }))).id);
  let heard = 0, refused = 0;
  const listening = new AbortController();
  const listeners = Array.from({ length: streams }, async () => {
    try {
      const answer = await fetch(`${url}/v1/jobs/${jobs[0]}/events`, { signal: listening.signal });
      if (answer.status !== 200) ++refused;
      for await (const piece of answer.body) heard += piece.length > 0 ? 1 : 0;
    } catch {} // the end of the bench
  });
  const before = { server: cpu_s(child.pid), worker: await workerCpu_s(url), start: performance.now() };
  const busy = await poll(url, jobs[0], pollers, seconds);
  const worker = workers().map(cpu_s).reduce((a, b) => a + b, 0) + (await workerCpu_s(url)) - before.worker;
  const server = cpu_s(child.pid) - before.server;
  const wall_s = (performance.now() - before.start) / 1e3;
  listening.abort();
  await Promise.all(listeners);
  const p99 = { idle: quantile(idle.times, 0.99), busy: quantile(busy.times, 0.99) };
  promise(busy.wrong.length === 0 && refused === 0, `${busy.times.length} requests of ${pollers} clients in ${wall_s.toFixed(1)} s beside ${streams} event streams (${heard} pieces heard): ${busy.wrong.length} errors, ${refused} refused`);
  promise(server <= 0.05 * worker, `server ${server.toFixed(2)} s of processor time, ${((1e3 * server) / busy.times.length).toFixed(3)} s for 1,000 requests; workers ${worker.toFixed(1)} s: ${((100 * server) / worker).toFixed(1)} %`);
  console.log(`       GET /v1/jobs/{id}: median ${quantile(busy.times, 0.5).toFixed(2)} ms, p99 ${p99.busy.toFixed(2)} ms; idle server: median ${quantile(idle.times, 0.5).toFixed(2)}, p99 ${p99.idle.toFixed(2)} ms; ratio of p99 ${(p99.busy / p99.idle).toFixed(2)}`);
  const rssAfter = rss_mb(child.pid);
  promise(rssAfter < rssBefore + 50, `memory of the server: ${rssBefore.toFixed(1)} MB before, ${rssAfter.toFixed(1)} MB after`);
  await killServer("SIGTERM");
  promise(workers().length === 0, "no worker is left");
}

/** Raw bytes to the server; what it answers until it closes or is silent. */
function exchange(url, bytes) {
  const { hostname, port } = new URL(url);
  return new Promise((done) => {
    const socket = connect(Number(port), hostname, () => socket.end(bytes));
    let got = "";
    socket.setTimeout(2000, () => socket.destroy());
    socket.on("data", (piece) => (got += piece.toString("latin1")));
    socket.on("error", () => {});
    socket.on("close", () => done(got));
  });
}

/** Requests that no honest client sends. */
class Hostile {
  constructor(seed, sceneBytes) {
    this.chance = random(seed);
    this.sceneBytes = sceneBytes;
    this.uploads = []; // ids of those that were taken
  }
  below(n) {
    return Math.floor(this.chance() * n);
  }
  pick(list) {
    return list[this.below(list.length)];
  }
  text(most) {
    return Array.from({ length: this.below(most) }, () => String.fromCharCode(this.below(256))).join("");
  }
  value(depth = 0) {
    const kinds = [
      () => null, () => this.chance() < 0.5, () => this.pick([0, -1, 1e308, -1e308, 1e-320, 4294967296, -9223372036854775808, 0.1]), () => this.text(20),
      () => "x".repeat(this.below(5000)), () => this.pick(["../../etc/passwd", "path:/etc/passwd", "file:///etc/passwd", "\u0000", "\ud800", "%2e%2e"]),
      () => (depth > 3 ? [] : Array.from({ length: this.below(4) }, () => this.value(depth + 1))),
      () => (depth > 3 ? {} : Object.fromEntries(Array.from({ length: this.below(4) }, () => [this.pick(["a", "budget_ms", "kind", "name", "upload", "a/b~"]), this.value(depth + 1)]))),
    ];
    return this.pick(kinds)();
  }
  /** A good body with some of it changed. */
  body() {
    const body = place(1);
    for (let i = 0; i <= this.below(3); ++i) {
      const holder = this.pick([body, body.spec, body.spec?.view_space, body.scene, body.target].filter((part) => part !== null && typeof part === "object"));
      const keys = Object.keys(holder);
      if (this.chance() < 0.3) delete holder[this.pick(keys)];
      else holder[this.chance() < 0.6 ? this.pick(keys) : this.pick(["arguments", "dry_run", "job", "label", "cache", "camera", "x"])] = this.value();
    }
    let text = JSON.stringify(body);
    if (this.chance() < 0.3) text = text.slice(0, this.below(text.length)) + this.text(5) + text.slice(this.below(text.length));
    return text;
  }
  path() {
    return this.pick(["/", "/v1/jobs", "/v1/jobs/", "/v1/jobs/none/events", "/v1/jobs/../jobs", "/v1/uploads?name=", "/v1/uploads/%00", "/%", "/v1/jobs?limit=-1", "/v1/jobs?after=99999999999999999999", "//", "/v1/jobs/none/artifacts/../../x", `/${this.text(30)}`]);
  }
  http() {
    const method = this.pick(["GET", "POST", "PUT", "DELETE", "HEAD", "OPTIONS", "TRACE", "\0", "G E T", "x".repeat(this.below(9000))]);
    const headers = [`Host: ${this.pick(["localhost", "127.0.0.1", "evil.example", "", "[::1]:x"])}`];
    for (let i = this.below(6); i > 0; --i)
      headers.push(this.pick(["Content-Length: -1", "Content-Length: 5", "Content-Length: 99999999999999999999", "Transfer-Encoding: chunked", "Transfer-Encoding: gzip", "Range: bytes=5-1", "Expect: 100-continue", "Content-Type: application/json", "Content-Type: application/octet-stream", "Origin: null", `Idempotency-Key: ${"k".repeat(this.below(400))}`, "Last-Event-ID: -9", `X-${this.text(10)}`, "Connection: close, keep-alive"]));
    return Buffer.from(`${method} ${this.path()} ${this.pick(["HTTP/1.1", "HTTP/1.0", "HTTP/9.9", ""])}\r\n${headers.join("\r\n")}\r\n\r\n${this.text(60)}`, "latin1");
  }
  json(text = this.body()) {
    const body = Buffer.from(text);
    return Buffer.concat([Buffer.from(`POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nConnection: close\r\nContent-Length: ${body.length}\r\n\r\n`), body]);
  }
  upload() {
    const bytes = Buffer.from(this.sceneBytes.subarray(0, this.below(this.sceneBytes.length)));
    for (let i = this.below(50); i > 0; --i) if (bytes.length > 0) bytes[this.below(Math.min(bytes.length, 4000))] = this.below(256);
    return Buffer.concat([Buffer.from(`POST /v1/uploads?name=${encodeURIComponent(this.text(12))}.glb HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/octet-stream\r\nConnection: close\r\nContent-Length: ${bytes.length + this.pick([0, 0, 0, 1000])}\r\n\r\n`), bytes]);
  }
  /** A job whose scene is one of the broken uploads. */
  survey() {
    const { spec, target } = place(1);
    return this.json(JSON.stringify({ kind: "survey", scene: { upload: this.pick(this.uploads) ?? "none" }, target, spec }));
  }
  next() {
    return this.pick([() => this.http(), () => this.json(), () => this.json(), () => this.upload(), () => this.survey()])();
  }
  hear(answer) {
    if (answer.startsWith("HTTP/1.1 201")) this.uploads.push(JSON.parse(answer.slice(answer.indexOf("\r\n\r\n"))).id);
  }
}

async function hostile(requests = 1000, seed = 1, memory_gb = 8) {
  const url = await serve("--queue", "5", "--deadline-minutes", "0.2", "--attempts", "2", "--worker-memory-gb", String(memory_gb));
  const strange = new Hostile(seed, readFileSync(scene));
  const statuses = {};
  for (let i = 0; i < requests; ++i) {
    const answer = await exchange(url, strange.next());
    strange.hear(answer);
    const status = answer.match(/^HTTP\/1\.[01] (?!100)(\d+)|\r\n\r\nHTTP\/1\.[01] (\d+)/);
    const said = status ? (status[1] ?? status[2]) : "none";
    statuses[said] = (statuses[said] ?? 0) + 1;
    if (child.exitCode !== null || child.signalCode !== null) break;
  }
  promise(child.exitCode === null && child.signalCode === null && (await get(`${url}/healthz`)).status === "ok", `${requests} hostile requests (seed ${seed}); the server lives`);
  promise(Object.keys(statuses).every((status) => status < "500" || ["503", "505", "507", "none"].includes(status)), `answers by status: ${JSON.stringify(statuses)}`);
  let jobs;
  while (!(jobs = await allJobs(url)).every(ended)) await sleep(200);
  const ends = {};
  for (const { state, error } of jobs) ends[error?.word ?? state] = (ends[error?.word ?? state] ?? 0) + 1;
  promise(!("worker_lost" in ends) && !("internal" in ends), `${jobs.length} jobs by their end: ${JSON.stringify(ends)}`);
  await killServer("SIGTERM");
  promise(child.exitCode === 0, `the server ends with ${child.exitCode ?? child.signalCode} when it is asked to`);
  promise(workers().length === 0, "no worker is left");
}

async function allJobs(url) {
  const jobs = [];
  for (let after = ""; after !== null; ) {
    const page = await get(`${url}/v1/jobs?limit=200${after && `&after=${after}`}`);
    jobs.push(...page.jobs);
    after = page.next;
  }
  return jobs;
}

if (!existsSync(binary ?? "") || !["kill", "cancel", "load", "hostile"].includes(what)) {
  console.error("node tests/bench/service.mjs kill|cancel|load|hostile BINARY SCENE ...");
  process.exit(2);
}
await { kill, cancel, load, hostile }[what](...numbers.map(Number));
process.exit();
