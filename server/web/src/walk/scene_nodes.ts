// A scene file's drawn nodes in the program's order (render/scene/gltf_import.cpp): depth first, parents before children, instances one by
// one. Each becomes an object of the placement, or several when it was split.

import * as THREE from "three";
import type { GLTF } from "three/addons/loaders/GLTFLoader.js";

export interface ScenePart {
  readonly geometry: THREE.BufferGeometry;
  readonly material: THREE.Material;
  readonly primitive: number;
}
export interface SceneNode {
  readonly name: string; // "" where the file has none
  readonly mesh: number;
  readonly parts: readonly ScenePart[];
  readonly worldFromNode: THREE.Matrix4;
}

interface NodeJson {
  name?: string;
  mesh?: number;
  children?: number[];
  matrix?: number[];
  translation?: number[];
  rotation?: number[];
  scale?: number[];
  extensions?: { EXT_mesh_gpu_instancing?: { attributes: Record<string, number> }; MSFT_lod?: { ids?: number[] } };
}
interface SceneJson {
  scene?: number;
  scenes?: { nodes?: number[] }[];
  nodes?: NodeJson[];
  meshes?: { primitives: unknown[] }[];
}

function parentFromNode(node: NodeJson): THREE.Matrix4 {
  if (node.matrix !== undefined) return new THREE.Matrix4().fromArray(node.matrix);
  const [t = 0, u = 0, v = 0] = node.translation ?? [],
    [x = 0, y = 0, z = 0, w = 1] = node.rotation ?? [],
    [a = 1, b = 1, c = 1] = node.scale ?? [];
  return new THREE.Matrix4().compose(new THREE.Vector3(t, u, v), new THREE.Quaternion(x, y, z, w).normalize(), new THREE.Vector3(a, b, c));
}

function roots(json: SceneJson): number[] {
  if (json.scenes !== undefined && json.scenes.length > 0) return json.scenes[json.scene ?? 0]?.nodes ?? [];
  const children = new Set((json.nodes ?? []).flatMap((node) => node.children ?? []));
  return (json.nodes ?? []).map((_, id) => id).filter((id) => !children.has(id));
}

class NodeWalk {
  private readonly json: SceneJson;
  private readonly parts = new Map<number, Promise<ScenePart[]>>();
  private readonly lowerLevels: ReadonlySet<number>; // drawn in place of others, never beside them
  readonly found: SceneNode[] = [];

  constructor(private readonly gltf: GLTF) {
    this.json = gltf.parser.json as SceneJson;
    this.lowerLevels = new Set((this.json.nodes ?? []).flatMap((node) => node.extensions?.MSFT_lod?.ids ?? []));
  }

  async run(worldFromFile: THREE.Matrix4): Promise<void> {
    for (const root of roots(this.json)) await this.visit(root, worldFromFile);
  }

  private async visit(id: number, worldFromParent: THREE.Matrix4): Promise<void> {
    const node = this.json.nodes?.[id];
    if (node === undefined || this.lowerLevels.has(id)) return;
    const worldFromNode = worldFromParent.clone().multiply(parentFromNode(node));
    if (node.mesh !== undefined) {
      const parts = await this.partsOf(node.mesh);
      const places = await this.instances(node);
      if (parts.length > 0)
        for (const place of places)
          this.found.push({ name: node.name ?? "", mesh: node.mesh, parts, worldFromNode: worldFromNode.clone().multiply(place) });
    }
    for (const child of node.children ?? []) await this.visit(child, worldFromNode);
  }

  private partsOf(mesh: number): Promise<ScenePart[]> {
    const known = this.parts.get(mesh);
    if (known !== undefined) return known;
    const loading = this.loadParts(mesh);
    this.parts.set(mesh, loading);
    return loading;
  }

  private async loadParts(mesh: number): Promise<ScenePart[]> {
    const loaded = (await this.gltf.parser.getDependency("mesh", mesh)) as THREE.Object3D;
    const primitives = this.json.meshes![mesh]!.primitives.length === 1 ? [loaded] : loaded.children;
    return primitives.flatMap((primitive, index) => {
      if (!(primitive instanceof THREE.Mesh)) return []; // points and lines
      return [
        {
          geometry: prepared(primitive.geometry as THREE.BufferGeometry),
          material: primitive.material as THREE.Material,
          primitive: index,
        },
      ];
    });
  }

  private async instances(node: NodeJson): Promise<THREE.Matrix4[]> {
    const instancing = node.extensions?.EXT_mesh_gpu_instancing;
    if (instancing === undefined) return [new THREE.Matrix4()];
    const read = async (name: string) => {
      const accessor = instancing.attributes[name];
      return accessor === undefined ? null : ((await this.gltf.parser.getDependency("accessor", accessor)) as THREE.BufferAttribute);
    };
    const [translations, rotations, scales] = [await read("TRANSLATION"), await read("ROTATION"), await read("SCALE")];
    const count = Math.max(translations?.count ?? 0, rotations?.count ?? 0, scales?.count ?? 0);
    return Array.from({ length: count }, (_, i) => {
      const at = (attribute: THREE.BufferAttribute | null, otherwise: number) =>
        attribute === null ? new THREE.Vector3().setScalar(otherwise) : new THREE.Vector3().fromBufferAttribute(attribute, i);
      const rotation =
        rotations === null
          ? new THREE.Quaternion()
          : new THREE.Quaternion().fromArray([0, 1, 2, 3].map((k) => rotations.getComponent(i, k))).normalize();
      return new THREE.Matrix4().compose(at(translations, 0), rotation, at(scales, 1));
    });
  }
}

/// With an index, normals and texture coordinates, which splitting and shading need.
function prepared(geometry: THREE.BufferGeometry): THREE.BufferGeometry {
  const vertices = geometry.getAttribute("position").count;
  if (geometry.index === null) geometry.setIndex(Array.from({ length: vertices }, (_, i) => i));
  if (!geometry.hasAttribute("normal")) geometry.computeVertexNormals();
  if (!geometry.hasAttribute("uv")) geometry.setAttribute("uv", new THREE.BufferAttribute(new Float32Array(2 * vertices), 2));
  return geometry;
}

export async function sceneNodes(gltf: GLTF, worldFromFile: THREE.Matrix4): Promise<SceneNode[]> {
  const walk = new NodeWalk(gltf);
  await walk.run(worldFromFile);
  return walk.found;
}
