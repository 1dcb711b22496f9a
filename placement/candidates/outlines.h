// A few points of each object that span its extents from anywhere: what a candidate's sketch projects instead of boxes.
//
// An impostor's texture fits the vertices themselves (plan_impostor). World-aligned boxes of turned or slanted objects are far larger: they
// alone made estimates of small impostors 1.3x to 2x too high. The extreme vertices along the 26 directions to a cube's faces, edges and
// corners span what thousands of vertices do, within a few percent, at the price of a box.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/scene/scene.h"

namespace standin {

class ObjectOutlines {
 public:
  /// Looks at each mesh's vertices once, however often it is drawn.
  explicit ObjectOutlines(const Scene& scene);

  /// World positions, at most 26; corners of the bounds where the object has no vertices.
  [[nodiscard]] std::span<const Vec3> of(std::uint32_t object) const {
    return std::span(points_).subspan(first_[object], first_[object + 1] - first_[object]);
  }
  [[nodiscard]] std::vector<Vec3> of(std::span<const std::uint32_t> objects) const;

 private:
  std::vector<Vec3> points_;
  std::vector<std::size_t> first_{0};  // per object, and the end
};

}  // namespace standin
