// What the walk needs of a finished job: the placement, its impostors and levels of detail, and the scene file that it was made for.

import * as THREE from "three";
import { GLTFLoader, type GLTF } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";

import { artifactOf, getBytes, getText, type Job } from "../api";
import { parsePlacement, type Placement } from "../runtime/placement";
import { bytes } from "../text";
import { isGlb, readGlb } from "./glb";
import { ImpostorModels } from "./impostor_models";
import { objectModels, type ObjectModels } from "./object_models";
import { sceneNodes } from "./scene_nodes";

export interface WalkFiles {
  readonly placement: Placement;
  readonly objects: ObjectModels;
  readonly impostors: ImpostorModels;
}

/// The scene is no GLB: nothing this page could draw.
export class NotGlb extends Error {}

const parse = (file: ArrayBuffer): Promise<GLTF> => new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).parseAsync(file, "");

export async function loadWalk(job: Job, signal: AbortSignal, say: (what: string) => void): Promise<WalkFiles> {
  const need = (path: string) => {
    const artifact = artifactOf(job, path);
    if (artifact === undefined) throw new Error(`This job has no ${path}; only finished jobs of kind place have one.`);
    return artifact;
  };
  const fetchBytes = (name: string, href: string, total: number) =>
    getBytes(href, signal, (received) => say(`Loading ${name}: ${bytes(received)} of ${bytes(total)}`));
  const placementFile = need("placement.json"),
    impostorFile = need("impostors.glb"),
    levelFile = artifactOf(job, "lods.glb");
  if (job.scene === null) throw new Error("The server names no scene of this job.");
  say(`Loading placement.json: ${bytes(placementFile.bytes)}`);
  const placement = parsePlacement(await getText(placementFile.href, signal));
  const sceneFile = await fetchBytes(job.scene.name, job.scene.href, job.scene.bytes);
  if (!isGlb(sceneFile)) throw new NotGlb(job.scene.name);
  const impostors = await parse(await fetchBytes("impostors.glb", impostorFile.href, impostorFile.bytes));
  const lods =
    placement.lods !== null && levelFile !== undefined ? readGlb(await fetchBytes("lods.glb", levelFile.href, levelFile.bytes)) : null;
  say("Preparing the scene");
  const worldFromFile = (placement as { units?: { world_from_file?: number[] } }).units?.world_from_file;
  const nodes = await sceneNodes(
    await parse(sceneFile),
    worldFromFile ? new THREE.Matrix4().fromArray(worldFromFile) : new THREE.Matrix4(),
  );
  return { placement, objects: objectModels(placement, nodes, lods), impostors: new ImpostorModels(placement, impostors) };
}
