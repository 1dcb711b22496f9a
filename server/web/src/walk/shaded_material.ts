// The one shading rule (render/scene/shading.h) as a material: impostors were recorded with it, and originals must look the same beside them.
//
// It works on encoded colours, so textures are read as they are and the renderer encodes nothing.

import * as THREE from "three";

const VERTEX = `
varying vec3 worldNormal;
varying vec2 textureUv;
uniform mat3 uvTransform;
void main() {
  worldNormal = transpose(inverse(mat3(modelMatrix))) * normal;
  textureUv = (uvTransform * vec3(uv, 1.0)).xy;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;
const FRAGMENT = `
varying vec3 worldNormal;
varying vec2 textureUv;
uniform vec4 baseColour;
uniform sampler2D map;
uniform float alphaCutoff;
uniform bool lit;
void main() {
  vec4 colour = baseColour;
  #ifdef TEXTURED
  colour *= texture2D(map, textureUv);
  #endif
  if (colour.a < alphaCutoff) discard;
  float square = dot(worldNormal, worldNormal);
  float along = square > 0.0 ? abs(dot(worldNormal, normalize(vec3(0.4, 0.8, 0.45)))) * inversesqrt(square) : 0.0;
  gl_FragColor = vec4(lit ? colour.rgb * (0.45 + 0.55 * along) : colour.rgb, 1.0);
}`;

type Loaded = THREE.Material & { color?: THREE.Color; map?: THREE.Texture | null; alphaTest: number };

export function shadedMaterial(loaded: Loaded): THREE.ShaderMaterial {
  const map = loaded.map ?? null;
  if (map !== null) map.colorSpace = THREE.NoColorSpace;
  map?.updateMatrix();
  const { r, g, b } = (loaded.color ?? new THREE.Color(1, 1, 1)).clone().convertLinearToSRGB();
  return new THREE.ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    side: loaded.side,
    defines: map === null ? {} : { TEXTURED: "" },
    uniforms: {
      baseColour: { value: new THREE.Vector4(r, g, b, loaded.opacity) },
      map: { value: map },
      uvTransform: { value: map?.matrix ?? new THREE.Matrix3() },
      alphaCutoff: { value: loaded.alphaTest },
      lit: { value: !(loaded instanceof THREE.MeshBasicMaterial) },
    },
  });
}
