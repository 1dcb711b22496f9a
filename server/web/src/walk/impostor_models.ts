// impostors.glb as the runtime draws it: unlit, masked, nearest texels, one node per impostor, shown by id.

import * as THREE from "three";
import type { GLTF } from "three/addons/loaders/GLTFLoader.js";

import type { Placement } from "../runtime/placement";

const PLAIN = new THREE.Color(1, 1, 1),
  MARKED = new THREE.Color(1, 0.45, 0.85);

function asStored(texture: THREE.Texture): void {
  texture.colorSpace = THREE.NoColorSpace;
  texture.magFilter = texture.minFilter = THREE.NearestFilter;
  texture.generateMipmaps = false;
}

export class ImpostorModels {
  readonly group = new THREE.Group();
  private readonly byId: readonly (THREE.Object3D | undefined)[];
  private readonly materials = new Set<THREE.MeshBasicMaterial>();

  constructor(placement: Placement, gltf: GLTF) {
    const byName = new Map<string, THREE.Object3D>();
    const json = gltf.parser.json as { nodes?: { name?: string }[] };
    gltf.scene.updateMatrixWorld(true);
    gltf.scene.traverse((node) => {
      const index = gltf.parser.associations.get(node)?.nodes;
      if (index !== undefined) byName.set(json.nodes![index]!.name ?? "", node);
      if (node instanceof THREE.Mesh) this.prepare(node);
    });
    this.byId = placement.impostors.map((impostor) => byName.get(impostor.gltf_node));
    this.group.add(gltf.scene);
    this.show([]);
  }

  private prepare(mesh: THREE.Mesh): void {
    const material = mesh.material as THREE.MeshBasicMaterial;
    if (material.map !== null) asStored(material.map);
    material.color.copy(PLAIN);
    material.toneMapped = false;
    this.materials.add(material);
  }

  show(ids: readonly number[]): void {
    for (const node of this.byId) if (node !== undefined) node.visible = false;
    for (const id of ids) {
      const node = this.byId[id];
      if (node !== undefined) node.visible = true;
    }
  }

  meshesOf(id: number): THREE.Mesh[] {
    const meshes: THREE.Mesh[] = [];
    this.byId[id]?.traverse((node) => node instanceof THREE.Mesh && meshes.push(node));
    return meshes;
  }

  /// Tints what stands in, so that it can be told from what it stands for.
  mark(marked: boolean): void {
    for (const material of this.materials) material.color.copy(marked ? MARKED : PLAIN);
  }
}
