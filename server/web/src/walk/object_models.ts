// The scene file's geometry as the placement's objects: for each id what to draw, in each of its levels of detail.

import * as THREE from "three";

import type { Placement, SceneObject } from "../runtime/placement";
import { readIndices, type Glb } from "./glb";
import { splitIntoPieces, type Piece } from "./pieces";
import type { SceneNode, ScenePart } from "./scene_nodes";
import { shadedMaterial } from "./shaded_material";

/// What one level of an object draws: per mesh a geometry; none: the mesh is not part of the level.
export type Form = readonly (THREE.BufferGeometry | null)[];
export interface ObjectModel {
  readonly meshes: readonly THREE.Mesh[];
  readonly forms: readonly Form[];
}
export interface ObjectModels {
  readonly models: readonly (ObjectModel | null)[]; // per object id
  readonly missing: readonly SceneObject[]; // not found in the scene file
}

interface PlacementSpec {
  spec?: { scene?: { split_triangles?: number; split_extent?: number } };
}

const PIECE = /^(.*)#(\d+)$/;

/// Same attributes, other triangles.
function withTriangles(geometry: THREE.BufferGeometry, corners: ArrayLike<number>): THREE.BufferGeometry {
  const part = new THREE.BufferGeometry();
  for (const [name, attribute] of Object.entries(geometry.attributes)) part.setAttribute(name, attribute);
  part.setIndex(new THREE.BufferAttribute(corners instanceof Uint16Array ? corners : Uint32Array.from(corners), 1));
  const sphere = new THREE.Box3();
  const point = new THREE.Vector3(),
    position = geometry.getAttribute("position") as THREE.BufferAttribute;
  for (let i = 0; i < corners.length; ++i) sphere.expandByPoint(point.fromBufferAttribute(position, corners[i]!));
  part.boundingSphere = sphere.getBoundingSphere(new THREE.Sphere());
  return part;
}

class Builder {
  private readonly materials = new Map<THREE.Material, THREE.ShaderMaterial>();
  private readonly levelForms = new Map<string, Form | null>();
  private readonly levelNodes = new Map<string, number>();
  private readonly levelsOf = new Map<number, readonly string[]>();
  private readonly splits = new Map<string, Piece[]>();
  private readonly diagonal: number;
  readonly models: (ObjectModel | null)[];

  constructor(
    private readonly placement: Placement,
    private readonly lods: Glb | null,
  ) {
    this.models = placement.scene.objects.map(() => null);
    const bounds = new THREE.Box3();
    for (const object of placement.scene.objects) bounds.union(boxOf(object));
    this.diagonal = bounds.getSize(new THREE.Vector3()).length();
    lods?.json.nodes?.forEach((node, id) => this.levelNodes.set(node.name ?? "", id));
    for (const { object, levels } of placement.lods?.objects ?? [])
      this.levelsOf.set(
        object,
        levels.map((level) => level.gltf_node),
      );
  }

  /// Nodes and objects come in the same order; the program dropped nodes that have no counterpart. Where names do not tell, bounds do.
  match(nodes: readonly SceneNode[]): void {
    const { objects } = this.placement.scene;
    const uses = new Map<string, number>();
    for (const { name } of nodes) uses.set(name, (uses.get(name) ?? 0) + 1);
    let next = 0;
    for (const node of nodes) {
      const object = objects[next];
      if (object === undefined) return;
      if (object.gltf_node !== node.name) continue;
      const pieces = this.pieceCount(next);
      const isSure = node.name !== "" && uses.get(node.name) === 1;
      if (!isSure && !this.fits(node, objects.slice(next, next + Math.max(pieces, 1)))) continue;
      if (pieces === 0) this.addWhole(node, next);
      else this.addPieces(node, next, pieces);
      next += Math.max(pieces, 1);
    }
  }

  private pieceCount(first: number): number {
    const { objects } = this.placement.scene;
    const base = PIECE.exec(objects[first]!.name);
    if (base === null || base[2] !== "0") return 0;
    let count = 1;
    while (objects[first + count]?.name === `${base[1]}#${count}`) ++count;
    return count > 1 ? count : 0;
  }

  private fits(node: SceneNode, objects: readonly SceneObject[]): boolean {
    const stated = objects.reduce((box, object) => box.union(boxOf(object)), new THREE.Box3());
    return this.same(stated, boundsOf(node.parts, node.worldFromNode));
  }

  private same(a: THREE.Box3, b: THREE.Box3): boolean {
    const tolerance = 1e-3 * this.diagonal;
    return a.min.distanceTo(b.min) <= tolerance && a.max.distanceTo(b.max) <= tolerance;
  }

  private mesh(part: ScenePart, geometry: THREE.BufferGeometry, worldFromNode: THREE.Matrix4): THREE.Mesh {
    let material = this.materials.get(part.material);
    if (material === undefined) this.materials.set(part.material, (material = shadedMaterial(part.material)));
    const mesh = new THREE.Mesh(geometry, material);
    mesh.matrixAutoUpdate = false;
    mesh.matrix.copy(worldFromNode);
    return mesh;
  }

  private addWhole(node: SceneNode, id: number): void {
    this.models[id] = this.model(node, id, node.parts);
  }

  private model(node: SceneNode, id: number, parts: readonly ScenePart[]): ObjectModel {
    const own: Form = parts.map((part) => part.geometry);
    let coarsest = own;
    const levels = (this.levelsOf.get(id) ?? []).map((name) => (coarsest = this.levelForm(name, node.mesh, parts) ?? coarsest));
    return { meshes: parts.map((part) => this.mesh(part, part.geometry, node.worldFromNode)), forms: [own, ...levels] };
  }

  /// Null where the level is not made of the object's own mesh.
  private levelForm(name: string, mesh: number, parts: readonly ScenePart[]): Form | null {
    const key = `${name} of mesh ${mesh}`;
    const known = this.levelForms.get(key);
    if (known !== undefined) return known;
    const form = this.readLevel(name, mesh, parts);
    this.levelForms.set(key, form);
    return form;
  }

  private readLevel(name: string, mesh: number, parts: readonly ScenePart[]): Form | null {
    const levelNode = this.levelNodes.get(name);
    if (this.lods === null || levelNode === undefined) return null;
    const { primitives } = this.lods.json.meshes![this.lods.json.nodes![levelNode]!.mesh!]!;
    if (primitives.some((primitive) => primitive.extras?.scene_mesh !== mesh)) return null;
    return parts.map((part) => {
      const primitive = primitives.find((candidate) => candidate.extras?.scene_primitive === part.primitive);
      if (primitive === undefined) return null;
      return primitive.indices === undefined ? part.geometry : withTriangles(part.geometry, readIndices(this.lods!, primitive.indices));
    });
  }

  private addPieces(node: SceneNode, first: number, count: number): void {
    const pieces = this.split(node);
    for (let k = 0; k < count; ++k) {
      const piece = pieces[k];
      if (piece === undefined || pieces.length !== count) return;
      const parts = piece.map(({ part, corners }) => ({
        ...node.parts[part]!,
        geometry: withTriangles(node.parts[part]!.geometry, corners),
      }));
      if (this.same(boxOf(this.placement.scene.objects[first + k]!), boundsOf(parts, node.worldFromNode)))
        this.models[first + k] = this.model(node, first + k, parts);
    }
  }

  private split(node: SceneNode): Piece[] {
    const { split_triangles = 0, split_extent = 0 } = (this.placement as PlacementSpec).spec?.scene ?? {};
    const scale = new THREE.Vector3().setFromMatrixScale(node.worldFromNode);
    const key = `${node.mesh} ${scale.toArray().join(" ")}`;
    const known = this.splits.get(key);
    if (known !== undefined) return known;
    const pieces = splitIntoPieces(
      node.parts.map((part) => part.geometry),
      [scale.x, scale.y, scale.z],
      { triangles: split_triangles, extent: split_extent * this.diagonal },
    );
    this.splits.set(key, pieces);
    return pieces;
  }
}

const boxOf = ({ bounds: { min, max } }: SceneObject) => new THREE.Box3(new THREE.Vector3(...min), new THREE.Vector3(...max));

function cornerBounds(geometry: THREE.BufferGeometry, corners: ArrayLike<number>, matrix: THREE.Matrix4): THREE.Box3 {
  const box = new THREE.Box3(),
    point = new THREE.Vector3(),
    position = geometry.getAttribute("position") as THREE.BufferAttribute;
  for (let i = 0; i < corners.length; ++i) box.expandByPoint(point.fromBufferAttribute(position, corners[i]!).applyMatrix4(matrix));
  return box;
}

const boundsOf = (parts: readonly ScenePart[], matrix: THREE.Matrix4) =>
  parts.reduce((box, { geometry }) => box.union(cornerBounds(geometry, geometry.index!.array, matrix)), new THREE.Box3());

export function objectModels(placement: Placement, nodes: readonly SceneNode[], lods: Glb | null): ObjectModels {
  const builder = new Builder(placement, lods);
  builder.match(nodes);
  return { models: builder.models, missing: placement.scene.objects.filter((_, id) => builder.models[id] === null) };
}
