// A stand-in for the service, to work on the page and to test it without one: a finished job from a result folder, and made-up ones
// (jobs.mjs). Answers in the API's form and checks nothing but what the page is to show as refused.
//
//     node mock/server.mjs --result FOLDER --scene SCENE.glb [--port 8081] [--page dist] [--survey FOLDER]
import { createHash, randomUUID } from "node:crypto";
import { createReadStream, existsSync, readFileSync, readdirSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { basename, dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";

import { madeUpJobs } from "./jobs.mjs";
import { problem } from "./problem.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const TYPES = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript",
  ".css": "text/css",
  ".json": "application/json",
  ".glb": "model/gltf-binary",
  ".wasm": "application/wasm",
  ".png": "image/png",
};
const STAGES = ["load", "visibility", "view_space", "survey", "candidates", "select", "bake", "verify"];
const BEST = {
  survey: { worst_bound_ms: 210.5 },
  select: { worst_bound_ms: 210.5, texture_bytes: 912_345, impostors: 41, unsolved_cpvs: 0 },
};
const POLICY =
  "default-src 'self'; img-src 'self' blob: data:; connect-src 'self' blob:; style-src 'self'; script-src 'self' 'wasm-unsafe-eval'";

const OF_THE_SERVICE = { "": ["cache", "threads", "device"], scene: ["texture_folders", "max_triangles", "max_texels"] };

/// The settings of a job, without those that are the service's own.
function offeredSchema() {
  const schema = JSON.parse(readFileSync(join(here, "../../../configs/job.schema.json"), "utf8"));
  for (const [group, keys] of Object.entries(OF_THE_SERVICE))
    for (const key of keys) delete (group === "" ? schema : schema.properties[group]).properties[key];
  return schema;
}

class Mock {
  constructor({ page, result, scene, survey }) {
    this.page = page;
    this.uploads = new Map();
    this.jobs = [];
    this.result = result;
    for (const job of madeUpJobs({ result, scene, survey })) this.add(job);
  }

  add(job) {
    this.jobs.unshift(job);
  }

  document(job) {
    const { scene, folder: _, files: __, ...rest } = job;
    const path = `/v1/jobs/${job.id}`;
    const artifacts = [...filesOf(job)].map(([name, read]) => {
      const content = read();
      return {
        path: name,
        bytes: content.length,
        sha256: createHash("sha256").update(content).digest("hex"),
        type: TYPES[extname(name)] ?? "application/octet-stream",
        href: `${path}/artifacts/${name}`,
      };
    });
    const file = scene && { name: basename(scene), bytes: statSync(scene).size, href: `${path}/scene` };
    return { ...rest, scene: file, artifacts };
  }

  submit(request) {
    const errors = [];
    if (!request.scene) errors.push({ pointer: "/scene", detail: "is required" });
    if (["place", "verify"].includes(request.kind) && !(request.spec?.budget_ms > 0))
      errors.push({ pointer: "/spec/budget_ms", detail: "must be greater than 0" });
    if (errors.length > 0) return problem(422, "The job's request is not valid", `${errors.length} fields`, { word: "bad-usage", errors });
    if (request.dry_run)
      return {
        status: 200,
        body: { valid: true, kind: request.kind, spec: request.spec, predicted: { seconds: 140, peak_rss_bytes: 1.2e9 } },
      };
    const job = {
      ...this.jobs.find((known) => known.id === "done"),
      id: randomUUID().slice(0, 8),
      kind: request.kind,
      label: request.label ?? "",
      state: "queued",
      aim_met: null,
      created: new Date().toISOString(),
      started: null,
      finished: null,
      folder: null,
      request,
    };
    this.add(job);
    this.run(job, this.result);
    return { status: 202, body: this.document(job) };
  }

  run(job, folder) {
    let step = 0;
    const timer = setInterval(() => {
      if (job.state === "cancelled") return clearInterval(timer);
      Object.assign(job, {
        state: "running",
        started: job.started ?? new Date().toISOString(),
        stage: STAGES[step],
        fraction: (step + 1) / (STAGES.length + 1),
        best_so_far: BEST[STAGES[step]] ?? job.best_so_far,
      });
      if (++step < STAGES.length) return;
      clearInterval(timer);
      Object.assign(job, {
        state: "succeeded",
        aim_met: true,
        finished: new Date().toISOString(),
        stage: null,
        fraction: 1,
        best_so_far: null,
        folder,
      });
    }, 120);
  }

  cancel(job) {
    if (["queued", "running"].includes(job.state)) Object.assign(job, { state: "cancelled", finished: new Date().toISOString() });
    return { status: 202, body: this.document(job) };
  }

  events(job, response) {
    response.writeHead(200, { "Content-Type": "text/event-stream", "Cache-Control": "no-store" });
    let id = 0,
      last = "";
    const send = () => {
      const data = JSON.stringify({ state: job.state, stage: job.stage, fraction: job.fraction, best_so_far: job.best_so_far });
      if (data !== last) response.write(`id: ${++id}\nevent: progress\ndata: ${data}\n\n`);
      last = data;
      if (job.state !== "queued" && job.state !== "running") {
        clearInterval(timer);
        response.end();
      }
    };
    const timer = setInterval(send, 60);
    response.on("close", () => clearInterval(timer));
    response.write(": hello\n\n");
    send();
  }

  list(query) {
    const jobs = this.jobs.filter(
      (job) => (!query.get("state") || job.state === query.get("state")) && (!query.get("kind") || job.kind === query.get("kind")),
    );
    const documents = jobs.map((job) => ({ ...this.document(job), request: undefined })); // a list leaves requests out
    return { status: 200, body: { jobs: documents, next: null } };
  }

  async upload(request, name) {
    const parts = [];
    for await (const part of request) parts.push(part);
    const content = Buffer.concat(parts);
    if (content.length === 0) return problem(422, "The upload is empty", `${name} has no bytes`);
    const upload = {
      id: randomUUID().slice(0, 8),
      name,
      bytes: content.length,
      sha256: createHash("sha256").update(content).digest("hex"),
      created: new Date().toISOString(),
    };
    this.uploads.set(upload.id, upload);
    return { status: 201, body: upload };
  }

  async answer(request, response, url) {
    const [, , collection, id, part, ...rest] = url.pathname.split("/").map(decodeURIComponent);
    if (collection === "schema") return { status: 200, body: offeredSchema() };
    if (collection === "presets")
      return {
        status: 200,
        body: {
          presets: [
            { name: "walk", spec: { view_space: { kind: "walk" } } },
            { name: "orbit", spec: { view_space: { kind: "orbit", leaf_m: 4 } } },
          ],
        },
      };
    if (collection === "scenes") return { status: 200, body: { scenes: [{ name: "harbour.glb", bytes: 12_345_678 }] } };
    if (collection === "targets") return { status: 200, body: { targets: [{ name: "reference.json", bytes: 2700 }] } };
    if (collection === "uploads")
      return request.method === "POST"
        ? this.upload(request, url.searchParams.get("name"))
        : { status: 200, body: { uploads: [...this.uploads.values()] } };
    if (collection !== "jobs") return problem(404, "Nothing here", url.pathname);
    if (id === undefined) return request.method === "POST" ? this.submit(JSON.parse(await text(request))) : this.list(url.searchParams);
    const job = this.jobs.find((candidate) => candidate.id === id);
    if (job === undefined) return problem(404, "There is no such job", `${id} was deleted, or never was`, { word: "not-found" });
    if (part === "cancel") return this.cancel(job);
    if (part === "events") return this.events(job, response);
    if (part === "scene") return file(response, job.scene);
    if (part === "artifacts") return this.artifact(job, response, rest.join("/"));
    if (request.method === "DELETE") {
      this.jobs = this.jobs.filter((other) => other !== job);
      return (response.writeHead(204).end(), null);
    }
    return { status: 200, body: this.document(job) };
  }

  artifact(job, response, path) {
    const read = filesOf(job).get(path);
    if (read === undefined) return problem(404, "There is no such artifact", `job ${job.id} has no artifact ${path}`);
    return bytes(response, path, read());
  }

  async serve(request, response) {
    const url = new URL(request.url, "http://localhost");
    if (!url.pathname.startsWith("/v1/")) return page(response, this.page, url.pathname);
    const answer = await this.answer(request, response, url);
    if (!answer) return;
    response.writeHead(answer.status, { "Content-Type": answer.status < 400 ? "application/json" : "application/problem+json" });
    response.end(JSON.stringify(answer.body));
  }
}

/// Name to what reads it: of the job's folder, and the made-up ones in their place.
function filesOf({ folder, files = {} }) {
  const names = folder === null ? [] : readdirSync(folder).filter((name) => !name.startsWith("."));
  const found = new Map(names.map((name) => [name, () => readFileSync(join(folder, name))]));
  for (const [name, content] of Object.entries(files)) found.set(name, () => content);
  return found;
}

async function text(request) {
  let all = "";
  for await (const part of request) all += part;
  return all;
}

function file(response, path) {
  response.writeHead(200, { "Content-Type": TYPES[extname(path)] ?? "application/octet-stream", "Content-Length": statSync(path).size });
  createReadStream(path).pipe(response);
  return null;
}

function bytes(response, name, content) {
  response.writeHead(200, { "Content-Type": TYPES[extname(name)] ?? "application/octet-stream", "Content-Length": content.length });
  response.end(content);
  return null;
}

function page(response, folder, path) {
  const wanted = join(folder, normalize(path));
  const found = extname(path) !== "" && existsSync(wanted) ? wanted : join(folder, "index.html");
  response.setHeader("Content-Security-Policy", POLICY);
  file(response, found);
}

/// Resolves to {url, close, update}; `update` changes members of a job.
export function startMock(options) {
  const mock = new Mock(options);
  const server = createServer((request, response) =>
    mock.serve(request, response).catch((error) => {
      if (!response.headersSent) response.writeHead(500, { "Content-Type": "application/problem+json" });
      response.end(JSON.stringify({ title: "The mock failed", status: 500, detail: String(error) }));
    }),
  );
  return new Promise((resolve) =>
    server.listen(options.port ?? 0, "127.0.0.1", () =>
      resolve({
        url: `http://127.0.0.1:${server.address().port}`,
        close: () => (server.closeAllConnections(), server.close()),
        update: (id, members) =>
          Object.assign(
            mock.jobs.find((job) => job.id === id),
            members,
          ),
      }),
    ),
  );
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const { values } = parseArgs({
    options: {
      result: { type: "string" },
      scene: { type: "string" },
      survey: { type: "string" },
      port: { type: "string", default: "8081" },
      page: { type: "string", default: join(here, "../dist") },
    },
  });
  if (!values.result || !values.scene) {
    console.error("node mock/server.mjs --result FOLDER --scene SCENE.glb [--port 8081] [--page dist] [--survey FOLDER]");
    process.exit(2);
  }
  console.log((await startMock({ ...values, port: Number(values.port) })).url);
}
