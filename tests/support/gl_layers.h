// The oracle of the impostor recorder: one layer drawn by OpenGL, the way the thesis records (N passes between near and far planes).
//
// Same shading and textures as the recorder; coverage by pixel centres, so that a recorder with closed coverage must cover at least these
// texels, and one with centre sampling the same up to ties on edges.
#pragma once

#include <cmath>

#include "render/device/renderer.h"
#include "render/impostor/impostor.h"

namespace standin::test {

/// Clip space whose viewport of frame.width x frame.height pixels has the frame's texels as its pixels, between layer.near_m > 0 and
/// layer.far_m (infinity allowed).
[[nodiscard]] inline Mat4 clip_from_world(const ImpostorFrame& frame, const Layer& layer) {
  const double left = frame.slope_min.x;
  const double right = left + frame.width * frame.slope_step.x;
  const double top = frame.slope_min.y;
  const double bottom = top - frame.height * frame.slope_step.y;
  const double n = layer.near_m;
  const double f = layer.far_m;
  Mat4 clip_from_frame(0.0);  // frame: right, up, -forward, as an eye's
  clip_from_frame[0][0] = 2.0 / (right - left);
  clip_from_frame[1][1] = 2.0 / (top - bottom);
  clip_from_frame[2][0] = (right + left) / (right - left);
  clip_from_frame[2][1] = (top + bottom) / (top - bottom);
  clip_from_frame[2][2] = std::isinf(f) ? -1.0 : -(f + n) / (f - n);
  clip_from_frame[2][3] = -1.0;
  clip_from_frame[3][2] = std::isinf(f) ? -2.0 * n : -2.0 * f * n / (f - n);
  const Mat3 world_from_frame(frame.right, frame.up, -frame.forward);
  Mat4 frame_from_world(glm::transpose(world_from_frame));
  frame_from_world[3] = Vec4(-(glm::transpose(world_from_frame) * frame.reference_viewpoint), 1.0);
  return clip_from_frame * frame_from_world;
}

/// Texels of one layer, rows from the top; alpha 255 where an object covers the texel's centre within the layer's depth range, else 0.
[[nodiscard]] inline Texture draw_layer(Renderer& renderer, const std::vector<std::uint32_t>& objects, const ImpostorFrame& frame,
                                        const Layer& layer) {
  renderer.draw_projected(clip_from_world(frame, layer), frame.reference_viewpoint, {.objects = objects, .impostors = {}});
  return renderer.read_pixels();
}

/// All layers, one after the other, from a renderer made for the frame's size.
[[nodiscard]] inline std::vector<Texture> draw_layers(Context& context, const Scene& scene, const std::vector<std::uint32_t>& objects,
                                                      const ImpostorFrame& frame, const std::vector<Layer>& layers) {
  Camera camera;
  camera.width = static_cast<int>(frame.width);
  camera.height = static_cast<int>(frame.height);
  Renderer renderer(context, scene, camera);
  std::vector<Texture> textures;
  for (const auto& layer : layers) textures.push_back(draw_layer(renderer, objects, frame, layer));
  return textures;
}

}  // namespace standin::test
