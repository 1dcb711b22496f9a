// The service as its users meet it: jobs over HTTP and by the client commands, the same bytes as the command line's, nothing lost by a
// restart, and a plain answer to whatever is wrong.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { cpSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { connect } from "node:net";
import { createHash } from "node:crypto";
import { join } from "node:path";
import test, { after } from "node:test";
import { binary, city, expectExit, scratch, source, standin, target } from "./standin.mjs";

const folder = scratch();
const scenes = join(folder, "scenes");
mkdirSync(scenes);
cpSync(city, join(scenes, "city.glb"));
const children = new Set();
after(() => children.forEach((child) => child.kill("SIGKILL")));

/** Starts a service: {child, url}. */
async function serve(data, ...more) {
  const child = spawn(binary, ["serve", "--data", join(folder, data), "--listen", "127.0.0.1:0", "--scenes", scenes, "--targets", join(source, "configs/targets"), ...more], { stdio: ["ignore", "pipe", "inherit"] });
  children.add(child);
  child.once("exit", () => children.delete(child));
  const url = await new Promise((done, fail) => {
    child.stdout.once("data", (text) => done(String(text).trim()));
    child.once("exit", (code) => fail(new Error(`serve ended with ${code}`)));
  });
  return { child, url };
}

async function stop({ child }, signal = "SIGTERM") {
  const gone = new Promise((done) => child.once("exit", done));
  child.kill(signal);
  await gone;
}

const json = async (answer) => ({ status: answer.status, headers: answer.headers, body: await answer.json() });
const get = async (url, headers = {}) => json(await fetch(url, { headers }));
const post = async (url, body, headers = {}) => json(await fetch(url, { method: "POST", body: JSON.stringify(body), headers: { "Content-Type": "application/json", ...headers } }));
const ended = ({ state }) => !["queued", "running"].includes(state);
async function untilEnded(url, id, most_s = 120) {
  for (let i = 0; i < 10 * most_s; ++i) {
    const { body } = await get(`${url}/v1/jobs/${id}`);
    if (ended(body)) return body;
    await new Promise((done) => setTimeout(done, 100));
  }
  throw new Error(`job ${id} has not ended`);
}
const bytesOf = async (url, id, path) => Buffer.from(await (await fetch(`${url}/v1/jobs/${id}/artifacts/${path}`)).arrayBuffer());
const sha256 = (bytes) => createHash("sha256").update(bytes).digest("hex");

// A job of seconds, by the command line and as a body.
const spec = { budget_ms: 60, view_space: { leaf_m: 46, refine_levels: 0, interval_deg: 22.5 }, visibility: { rays: 20_000 }, select: { size_bakes: 24 }, verify: { views: 2 }, survey: { views: 200 }, lods: { mode: "off" } };
const flags = ["--target", target, "--budget-ms", "60", "--leaf-m", "46", "--refine-levels", "0", "--interval-deg", "22.5", "--visibility-rays", "20000", "--size-bakes", "24", "--verify-views", "2", "--survey-views", "200", "--lods", "off", "--quiet"];
const local = join(folder, "local");
assert.ok(standin("place", city, ...flags, "-o", local).code <= 1);
const place = { kind: "place", scene: { name: "city.glb" }, target: { name: "reference.json" }, spec };

const main = await serve("main");
const { url } = main;

test("a job over HTTP gives the bytes of the command line, and of a server that was killed in it", async () => {
  const { status, headers, body } = await post(`${url}/v1/jobs`, place);
  assert.equal(status, 202, JSON.stringify(body));
  assert.equal(headers.get("location"), `/v1/jobs/${body.id}`);
  const job = await untilEnded(url, body.id);
  assert.equal(job.state, "succeeded", JSON.stringify(job.error));
  for (const file of ["placement.json", "impostors.glb"])
    assert.equal(sha256(await bytesOf(url, body.id, file)), sha256(readFileSync(join(local, file))), file);
  for (const { path, sha256: said, bytes } of job.artifacts) {
    const got = await bytesOf(url, body.id, path);
    assert.equal(sha256(got), said, path);
    assert.equal(got.length, bytes);
    assert.ok(!got.includes(folder), `${path} names a folder of the server`);
  }

  let other = await serve("killed");
  const again = (await post(`${other.url}/v1/jobs`, place)).body;
  for (let i = 0; i < 600 && (await get(`${other.url}/v1/jobs/${again.id}`)).body.stage === ""; ++i) await new Promise((done) => setTimeout(done, 20));
  await stop(other, "SIGKILL");
  other = await serve("killed");
  assert.equal((await untilEnded(other.url, again.id)).state, "succeeded");
  assert.equal(sha256(await bytesOf(other.url, again.id, "placement.json")), sha256(readFileSync(join(local, "placement.json"))));
  await stop(other);
  assert.deepEqual(readdirSync(join(folder, "killed/work")), []);
});

test("the client commands do what the local ones do", () => {
  const out = join(folder, "fetched");
  const run = standin("submit", "--server", url, "--scene", city, ...flags, "-o", out);
  assert.ok(run.code <= 1, run.err);
  const id = run.out.trim();
  assert.equal(sha256(readFileSync(join(out, "placement.json"))), sha256(readFileSync(join(local, "placement.json"))));
  assert.match(expectExit(run.code, "status", id, "--server", url).out, /place succeeded/);
  const again = join(folder, "fetched_again");
  expectExit(run.code, "fetch", id, "--server", url, "-o", again);
  assert.deepEqual(readdirSync(again), readdirSync(out));
  const uploads = () => JSON.parse(standin("status", id, "--server", url, "--json").out).request.scene.upload;
  const first = uploads();
  assert.equal(expectExit(0, "submit", "--server", url, "--scene", city, ...flags, "--seed", "2").out.trim().length, 32);
  assert.equal(uploads(), first, "the same bytes are sent once");
  assert.match(expectExit(2, "status", "nobody", "--server", url).err, /no job nobody \[not_found\]/);
  assert.match(expectExit(3, "status", id, "--server", "http://127.0.0.1:9").err, /\[server_unreachable\]/);
});

test("events tell of a job from where a client left off to its end", async () => {
  const { body } = await post(`${url}/v1/jobs`, { ...place, spec: { ...spec, seed: 3 } });
  const answer = await fetch(`${url}/v1/jobs/${body.id}/events`);
  assert.match(answer.headers.get("content-type"), /text\/event-stream/);
  assert.equal(answer.headers.get("x-accel-buffering"), "no");
  const parse = (text) => text.split("\n\n").filter((event) => event.startsWith("id: ")).map((event) => ({ id: Number(event.match(/^id: (\d+)/)[1]), data: JSON.parse(event.match(/data: (.*)/)[1]) }));
  const events = parse(await answer.text());
  assert.equal(events[0].data.state, "queued");
  assert.equal(events.at(-1).data.state, "succeeded");
  assert.ok(events.some(({ data }) => data.stage === "survey"));
  const best = events.map(({ data }) => data.best_so_far).filter((found) => found);
  const { metrics } = { metrics: JSON.parse(await bytesOf(url, body.id, "metrics.json")) };
  assert.equal(best.at(-1).unsolved_cpvs, metrics.cpv.unsolved);
  assert.ok(best.every(({ texture_bytes, impostors }) => texture_bytes > 0 && impostors > 0), JSON.stringify(best));
  const later = parse(await (await fetch(`${url}/v1/jobs/${body.id}/events`, { headers: { "Last-Event-ID": `${events[2].id}` } })).text());
  assert.deepEqual(later, events.slice(3));
});

test("cancelled within two seconds, and nothing is left", async () => {
  const { body } = await post(`${url}/v1/jobs`, { ...place, spec: { ...spec, visibility: { mode: "on", rays: 100_000_000, missed_share: 1e-6 } } });
  assert.ok(body.id, JSON.stringify(body));
  for (let i = 0; i < 600 && (await get(`${url}/v1/jobs/${body.id}`)).body.stage !== "visibility"; ++i) await new Promise((done) => setTimeout(done, 20));
  assert.equal((await fetch(`${url}/v1/jobs/${body.id}`, { method: "DELETE" })).status, 409);
  const asked = performance.now();
  assert.equal((await post(`${url}/v1/jobs/${body.id}/cancel`, {})).status, 202);
  const job = await untilEnded(url, body.id);
  assert.equal(job.state, "cancelled");
  assert.ok(performance.now() - asked < 2000, `${performance.now() - asked} ms`);
  assert.deepEqual(readdirSync(join(folder, "main/work")), []);
  assert.equal((await fetch(`${url}/v1/jobs/${body.id}`, { method: "DELETE" })).status, 204);
  assert.equal((await get(`${url}/v1/jobs/${body.id}`)).status, 404);
});

test("a bad scene kills one job and says why", async () => {
  const upload = await fetch(`${url}/v1/uploads?name=..%2F..%2Fbroken.glb`, { method: "POST", body: readFileSync(city).subarray(0, 5000), headers: { "Content-Type": "model/gltf-binary" } });
  assert.equal(upload.status, 201);
  const { id, name } = await upload.json();
  assert.equal(name, "broken.glb");
  const { body } = await post(`${url}/v1/jobs`, { ...place, scene: { upload: id } });
  const job = await untilEnded(url, body.id);
  assert.equal(job.state, "failed");
  assert.equal(job.error.word, "file_broken");
  assert.match(job.error.detail, /inputs\/scene\/broken\.glb/);
  assert.equal((await get(`${url}/healthz`)).status, 200);
});

test("the same key is the same job; with another body it is refused", async () => {
  const survey = { ...place, label: "survey" };
  const first = await post(`${url}/v1/jobs`, survey, { "Idempotency-Key": "night-17" });
  const second = await post(`${url}/v1/jobs`, survey, { "Idempotency-Key": "night-17" });
  assert.equal(second.body.id, first.body.id);
  const other = await post(`${url}/v1/jobs`, { ...survey, label: "other" }, { "Idempotency-Key": "night-17" });
  assert.deepEqual([other.status, other.body.word], [422, "key_reused"]);
});

test("every field that is wrong is named by its pointer", async () => {
  const { status, body } = await post(`${url}/v1/jobs`, {
    kind: "place", scene: { nme: "x" }, target: { name: "nobody.json" }, colour: 1, arguments: { seconds: 3 },
    spec: { budget_ms: -1, foo: { bar: 1 }, view_space: { leaf_m: "wide", kind: "path:/etc/passwd" }, cache: { folder: "/etc" }, camera: { width: 1e30 } },
  });
  assert.equal(status, 422);
  assert.deepEqual(body.errors.map(({ pointer }) => pointer).sort(), ["/arguments/seconds", "/colour", "/scene", "/spec/budget_ms", "/spec/cache/folder", "/spec/camera/width", "/spec/foo", "/spec/view_space/kind", "/spec/view_space/leaf_m"].sort());
  const missing = await post(`${url}/v1/jobs`, { ...place, target: { name: "nobody.json" } });
  assert.deepEqual(missing.body.errors.map(({ pointer }) => pointer), ["/target"]);
  const { body: dry } = await post(`${url}/v1/jobs`, { ...place, dry_run: true });
  assert.equal(dry.valid, true);
  assert.equal(dry.spec.budget_ms, spec.budget_ms);
  assert.ok(dry.predicted.seconds > 0 && dry.predicted.peak_rss_bytes > 1e6, "by the job that was done above");
});

test("whatever else is wrong has its own word and status", async () => {
  const small = await serve("small", "--upload-mb", "0.01", "--queue", "1");
  const words = async (answer) => [answer.status, (await answer.json()).word];
  const raw = (path, options) => fetch(`${small.url}${path}`, options);
  assert.deepEqual(await words(await raw("/v1/jobs", { method: "PUT" })), [405, "method_not_allowed"]);
  assert.deepEqual(await words(await raw("/v1/nothing")), [404, "not_found"]);
  assert.deepEqual(await words(await raw("/v1/jobs", { method: "POST", body: "{", headers: { "Content-Type": "application/json" } })), [400, "bad_request"]);
  assert.deepEqual(await words(await raw("/v1/jobs", { method: "POST", body: "{}", headers: { "Content-Type": "text/plain" } })), [415, "media_unsupported"]);
  assert.deepEqual(await words(await raw("/v1/uploads?name=a.glb", { method: "POST", body: Buffer.alloc(20_000), headers: { "Content-Type": "application/octet-stream" } })), [413, "too_large"]);
  assert.deepEqual(await words(await raw("/v1/uploads?name=a.glb", { method: "POST", body: new Blob([Buffer.alloc(20_000)]).stream(), duplex: "half", headers: { "Content-Type": "application/octet-stream" } })), [413, "too_large"]);
  assert.deepEqual(await words(await raw("/v1/jobs?limit=0")), [400, "bad_request"]);
  assert.deepEqual(await words(await raw("/v1/jobs", { headers: { Origin: "http://elsewhere.example" }, method: "POST", body: "{}" })), [403, "forbidden"]);
  const running = (await (await raw("/v1/jobs", { method: "POST", body: JSON.stringify(place), headers: { "Content-Type": "application/json" } })).json()).id;
  for (let i = 0; i < 100 && (await get(`${small.url}/v1/jobs/${running}`)).body.state === "queued"; ++i) await new Promise((done) => setTimeout(done, 20));
  assert.equal((await post(`${small.url}/v1/jobs`, place)).status, 202);
  const full = await post(`${small.url}/v1/jobs`, place);
  assert.deepEqual([full.status, full.body.word], [429, "queue_full"]);
  assert.ok(full.headers.get("retry-after"));
  assert.deepEqual(await words(await raw(`/v1/jobs/${running}/artifacts/placement.json`)), [409, "not_finished"]);
  await stop(small);
});

/** What comes back for raw bytes, until the server closes or falls silent. */
function exchange(text, { host, port } = { host: new URL(url).hostname, port: new URL(url).port }) {
  return new Promise((done) => {
    const socket = connect(port, host, () => socket.write(text));
    let got = "";
    socket.setTimeout(1500, () => socket.destroy());
    socket.on("data", (bytes) => (got += bytes));
    socket.on("error", () => {});
    socket.on("close", () => done(got));
  });
}

test("malformed HTTP and names that resolve to this machine reach nothing", async () => {
  for (const host of ["evil.example", "[evil.example"]) assert.match(await exchange(`GET /v1/jobs HTTP/1.1\r\nHost: ${host}\r\n\r\n`), /^HTTP\/1\.1 403 /);
  assert.match(await exchange("GET / HTTP/1.1\r\nHost: localhost\r\nX: " + "a".repeat(100_000) + "\r\n\r\n"), /^HTTP\/1\.1 431 |^$/);
  assert.doesNotMatch(await exchange("GET /../../../../etc/passwd HTTP/1.1\r\nHost: localhost\r\n\r\n"), /root:/);
  assert.doesNotMatch(await exchange("GET /assets/%2e%2e/%2e%2e/etc/passwd HTTP/1.1\r\nHost: localhost\r\n\r\n"), /root:/);
  await exchange("\0\0\0\0\r\n\r\n");
  await exchange("POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 99999999999999999999\r\n\r\n{");
  assert.equal((await get(`${url}/healthz`)).status, 200);
});

test("artifacts come in ranges, and not at all where they are known", async () => {
  const job = (await get(`${url}/v1/jobs?kind=place&state=succeeded`)).body.jobs.at(-1);
  const { href, bytes, sha256: sum } = job.artifacts.find(({ path }) => path === "placement.json");
  const range = await fetch(url + href, { headers: { Range: "bytes=10-19" } });
  assert.deepEqual([range.status, range.headers.get("content-range")], [206, `bytes 10-19/${bytes}`]);
  assert.deepEqual(Buffer.from(await range.arrayBuffer()), readFileSync(join(local, "placement.json")).subarray(10, 20));
  const beyond = await fetch(url + href, { headers: { Range: `bytes=${bytes}-` } });
  assert.deepEqual([beyond.status, beyond.headers.get("content-range")], [416, `bytes */${bytes}`]);
  assert.equal((await fetch(url + href, { headers: { "If-None-Match": `"${sum}"` } })).status, 304);
  assert.equal((await fetch(url + href, { method: "HEAD" })).headers.get("content-length"), `${bytes}`);
});

test("verify looks at the placement of a job", async () => {
  const job = (await get(`${url}/v1/jobs?kind=place&state=succeeded`)).body.jobs.at(-1);
  const { body } = await post(`${url}/v1/jobs`, { kind: "verify", job: job.id, arguments: { judged_views: 20 }, spec: { verify: { views: 4 } } });
  const end = await untilEnded(url, body.id);
  assert.equal(end.state, "succeeded", JSON.stringify(end.error));
  assert.ok(end.artifacts.some(({ path }) => path === "verify.json"));
});

test("what strangers gave is never a page, and hostile bodies end nothing", async () => {
  const upload = await (await fetch(`${url}/v1/uploads?name=evil%FF.html`, { method: "POST", body: "<script>alert(1)</script>", headers: { "Content-Type": "application/octet-stream" } })).json();
  const { body } = await post(`${url}/v1/jobs`, { ...place, scene: { upload: upload.id } }, { "Idempotency-Key": "evil" });
  assert.equal((await untilEnded(url, body.id)).state, "failed");
  const scene = await fetch(`${url}/v1/jobs/${body.id}/scene`);
  assert.equal(scene.headers.get("content-type"), "application/octet-stream");
  assert.match(scene.headers.get("content-security-policy"), /sandbox/);
  await fetch(`${url}/v1/uploads/${upload.id}`, { method: "DELETE" });
  assert.equal((await post(`${url}/v1/jobs`, { ...place, scene: { upload: upload.id } }, { "Idempotency-Key": "evil" })).body.id, body.id, "a key replays though its upload is gone");
  for (const text of ["[".repeat(60_000), `{"kind":"survey","dry_run":${"[".repeat(20_000)}`, `{"a":"${"\\\\".repeat(3)}[[["}`]) {
    const answer = await fetch(`${url}/v1/jobs`, { method: "POST", body: text, headers: { "Content-Type": "application/json" } });
    assert.ok([400, 422].includes(answer.status), `${answer.status}`);
  }
  assert.equal((await fetch(`${url}/v1/jobs`, { method: "POST", body: "{}", headers: { Origin: "x", "Content-Type": "application/json" } })).status, 403);
  const head = await exchange(`HEAD /v1/jobs/${body.id}/events HTTP/1.1\r\nHost: localhost\r\n\r\nGET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n`);
  assert.equal(head.match(/HTTP\/1\.1 200/g).length, 2, head);
});

test("a job that uses up its processor time says so, at its first attempt", async () => {
  const short = await serve("short", "--worker-cpu-hours", "0.0005");
  const { body } = await post(`${short.url}/v1/jobs`, { ...place, spec: { ...spec, visibility: { mode: "on", rays: 100_000_000, missed_share: 1e-6 } } });
  const job = await untilEnded(short.url, body.id);
  assert.deepEqual([job.state, job.error.word, job.attempts], ["failed", "worker_lost", 1]);
  assert.match(job.error.detail, /processor time/);
  await stop(short);
});

test("a scene above the server's limits ends its job with the limit's name", async () => {
  const strict = await serve("strict", "--scene-mtriangles", "0.001");
  const job = await untilEnded(strict.url, (await post(`${strict.url}/v1/jobs`, { ...place, kind: "survey" })).body.id);
  assert.deepEqual([job.state, job.error.word, job.attempts], ["failed", "too_large", 1]);
  assert.match(job.error.detail, /more than the 1000 allowed/);
  await stop(strict);
});

test("with tokens, nobody takes it all", async () => {
  const tokens = join(folder, "two_tokens");
  writeFileSync(tokens, `anna ${sha256("a-token")}\nbert ${sha256("b-token")}\n`);
  const shared = await serve("taken", "--tokens", tokens, "--owner-share", "0.5", "--streams", "2", "--queue", "2");
  const as = (token) => ({ Authorization: `Bearer ${token}` });
  const body = { ...place, spec: { ...spec, visibility: { mode: "on", rays: 100_000_000, missed_share: 1e-6 } } };
  const submit = async (token) => (await post(`${shared.url}/v1/jobs`, body, as(token))).body;
  const running = await submit("a-token");
  for (let i = 0; i < 100 && (await get(`${shared.url}/v1/jobs/${running.id}`, as("a-token"))).body.state === "queued"; ++i) await new Promise((done) => setTimeout(done, 20));
  assert.equal((await submit("a-token")).state, "queued");
  assert.equal((await submit("a-token")).word, "queue_full", "one of two places is anna's share");
  const berts = await submit("b-token");
  assert.equal(berts.state, "queued");
  const watch = (id, token, signal) => fetch(`${shared.url}/v1/jobs/${id}/events`, { headers: as(token), signal });
  const closing = new AbortController();
  assert.equal((await watch(running.id, "a-token", closing.signal)).status, 200);
  assert.equal((await (await watch(running.id, "a-token")).json()).word, "busy");
  assert.equal((await watch(berts.id, "b-token", closing.signal)).status, 200);
  closing.abort();
  await stop(shared);

  const narrow = await serve("narrow", "--tokens", tokens, "--owner-share", "0.5", "--quota-gb", "0.01");
  const upload = async (token, bytes) => (await fetch(`${narrow.url}/v1/uploads?name=a.glb`, { method: "POST", body: Buffer.alloc(bytes, token), headers: { "Content-Type": "application/octet-stream", ...as(token) } })).json();
  assert.ok((await upload("a-token", 6_000_000)).id, "under the half when it begins");
  const refused = await upload("a-token", 10);
  assert.deepEqual([refused.status, refused.word], [507, "quota_full"]);
  assert.ok((await upload("b-token", 10)).id);
  await stop(narrow);
});

test("with tokens, nobody sees what is another's", async () => {
  const tokens = join(folder, "tokens");
  writeFileSync(tokens, `# owners\nanna ${sha256("a-token")}\nbert ${sha256("b-token")}\n`);
  const shared = await serve("shared", "--tokens", tokens);
  const as = (token) => ({ Authorization: `Bearer ${token}` });
  assert.equal((await get(`${shared.url}/v1/jobs`)).status, 401);
  assert.equal((await get(`${shared.url}/v1/jobs`, as("c-token"))).status, 401);
  assert.equal((await get(`${shared.url}/healthz`)).status, 200);
  const { body } = await post(`${shared.url}/v1/jobs`, { ...place, kind: "survey" }, as("a-token"));
  assert.equal((await get(`${shared.url}/v1/jobs/${body.id}`, as("a-token"))).status, 200);
  assert.equal((await get(`${shared.url}/v1/jobs/${body.id}`, as("b-token"))).status, 404);
  assert.deepEqual((await get(`${shared.url}/v1/jobs`, as("b-token"))).body.jobs, []);
  assert.equal((await post(`${shared.url}/v1/jobs/${body.id}/cancel`, {}, as("b-token"))).status, 404);
  await stop(shared);
  assert.match(expectExit(2, "serve", "--data", join(folder, "wide"), "--listen", "0.0.0.0:0").err, /needs --tokens/);
});

test("openapi.json names exactly what is routed, and the data folder is one service's", async () => {
  const { body } = await get(`${url}/openapi.json`);
  assert.equal(body.openapi, "3.1.0");
  for (const [path, operations] of Object.entries(body.paths))
    for (const [method, { responses }] of Object.entries(operations)) {
      const answer = await fetch(url + path.replace(/\{\w+\}/g, "none"), { method: method.toUpperCase() });
      assert.ok(`${answer.status}` in responses || [415].includes(answer.status), `${method} ${path} answers ${answer.status}, which it does not name`);
    }
  assert.match(expectExit(2, "serve", "--data", join(folder, "main"), "--listen", "127.0.0.1:0").err, /\[output_occupied\]/);
  const metrics = await (await fetch(`${url}/metrics`)).text();
  assert.match(metrics, /^standin_jobs\{state="succeeded"\} [1-9]/m);
});
