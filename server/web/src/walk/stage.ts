// The scene as drawn: shows what the runtime module says, draws when something changed, and counts.

import * as THREE from "three";

import type { ViewContent } from "../runtime/content";
import type { Placement, Vector } from "../runtime/placement";
import type { ImpostorModels } from "./impostor_models";
import type { ObjectModels } from "./object_models";

export interface FrameCost {
  readonly draws: number;
  readonly triangles: number;
}

export class Stage {
  readonly camera: THREE.PerspectiveCamera;
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly frustum = new THREE.Frustum();

  constructor(
    readonly canvas: HTMLCanvasElement,
    placement: Placement,
    private readonly objects: ObjectModels,
    private readonly impostors: ImpostorModels,
  ) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // colours are encoded already (shaded_material.ts)
    this.renderer.setClearColor(new THREE.Color(0.62, 0.71, 0.79));
    const { fov_y_deg, width, height } = placement.camera;
    const far = 4 * Math.max(1, ...placement.scene.objects.flatMap(({ bounds }) => [...bounds.min, ...bounds.max].map(Math.abs)));
    this.camera = new THREE.PerspectiveCamera(fov_y_deg, width / height, Math.max(0.02, far * 1e-5), far);
    for (const model of objects.models) if (model !== null) this.scene.add(...model.meshes);
    this.scene.add(impostors.group);
    this.scene.updateMatrixWorld(true);
    this.scene.matrixWorldAutoUpdate = false;
  }

  resize(width: number, height: number): void {
    this.renderer.setSize(width, height, false);
  }

  look(position: Vector, direction: Vector): void {
    this.camera.position.set(...position);
    this.camera.up.set(
      0,
      Math.abs(direction[1]) > 0.999 * Math.hypot(...direction) ? 0 : 1,
      Math.abs(direction[1]) > 0.999 * Math.hypot(...direction) ? 1 : 0,
    );
    this.camera.lookAt(position[0] + direction[0], position[1] + direction[1], position[2] + direction[2]);
    this.camera.updateMatrixWorld();
  }

  show(content: ViewContent): void {
    for (const model of this.objects.models) if (model !== null) for (const mesh of model.meshes) mesh.visible = false;
    content.objects.forEach((id, i) => {
      const model = this.objects.models[id] ?? null;
      if (model === null) return;
      const form = model.forms[Math.min(content.levels[i]!, model.forms.length - 1)]!;
      model.meshes.forEach((mesh, part) => {
        const geometry = form[part] ?? null;
        mesh.visible = geometry !== null;
        if (geometry !== null) mesh.geometry = geometry;
      });
    });
    this.impostors.show(content.impostors);
  }

  /// What the renderer drew.
  draw(): FrameCost {
    this.renderer.render(this.scene, this.camera);
    const { calls, triangles } = this.renderer.info.render;
    return { draws: calls, triangles };
  }

  /// What drawing a view's content costs, without drawing it: what lies in the camera's frustum.
  cost(content: ViewContent): FrameCost {
    this.frustum.setFromProjectionMatrix(
      new THREE.Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse),
    );
    let draws = 0,
      triangles = 0;
    const add = (geometry: THREE.BufferGeometry, worldFromMesh: THREE.Matrix4) => {
      if (geometry.boundingSphere === null) geometry.computeBoundingSphere();
      if (!this.frustum.intersectsSphere(geometry.boundingSphere!.clone().applyMatrix4(worldFromMesh))) return;
      ++draws;
      triangles += geometry.index!.count / 3;
    };
    content.objects.forEach((id, i) => {
      const model = this.objects.models[id] ?? null;
      if (model === null) return;
      const form = model.forms[Math.min(content.levels[i]!, model.forms.length - 1)]!;
      form.forEach((geometry, part) => geometry !== null && add(geometry, model.meshes[part]!.matrixWorld));
    });
    for (const id of content.impostors) for (const mesh of this.impostors.meshesOf(id)) add(mesh.geometry, mesh.matrixWorld);
    return { draws, triangles };
  }

  dispose(): void {
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}
