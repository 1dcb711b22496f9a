// Panes across -z before a small camera, and the impostors that stand for them.
#pragma once

#include <glm/gtc/matrix_transform.hpp>
#include <utility>
#include <vector>

#include "server/verify/impostor_rays.h"
#include "tests/render/visibility/hand_made_scene.h"
#include "tests/server/verify/hand_made_glb.h"

namespace standin::test {

/// Square panes: half widths and depths.
[[nodiscard]] inline Scene panes(const std::vector<std::pair<double, double>>& half_width_and_depth) {
  SceneMaker maker;
  const auto mesh = maker.pane_mesh();
  for (const auto& [half_width, depth] : half_width_and_depth)
    maker.add_object(mesh, glm::scale(glm::translate(Mat4(1.0), Vec3(0, 0, -depth)), Vec3(half_width, half_width, 1)));
  return maker.take();
}

[[nodiscard]] inline JudgedImpostor judged(const Scene& scene, std::vector<Layer> layers) {
  JudgedImpostor impostor;
  impostor.node = "imp_0";
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) impostor.objects.push_back(i);
  impostor.layers = std::move(layers);
  impostor.alpha_rad = 0.01;
  return impostor;
}

/// 64 x 64 pixels at 45 degrees: a pixel is 0.01294 of slope, and slopes within 0.2 are 15.45 pixels on each side: 30 x 30 pixel centres,
/// of which 26 x 26 have their whole disc inside.
inline const Camera kCamera{0.78539816339744831, 64, 64, 0.1};
inline const View kFromOrigin{};

[[nodiscard]] inline GlbQuads read_back(const std::vector<HandMadeQuad>& quads) {
  return read_glb_quads(write_glb(HandMadeGlb{"imp_0", Vec3(0.0), "MASK", quads}));
}

}  // namespace standin::test
