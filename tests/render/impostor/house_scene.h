// A house of boxes: body, gabled roof, chimney, porch on columns, a shed far behind it and a ground that runs under all.
#pragma once

#include "tests/render/impostor/small_scene.h"

namespace standin::test {

inline void add_box(std::vector<WorldTriangle>& triangles, const Vec3& low, const Vec3& high) {
  const Vec3 s = high - low;
  const auto add = [&](const Vec3& corner, const Vec3& a, const Vec3& b) {
    for (const WorldTriangle& t : rectangle(corner, a, b)) triangles.push_back(t);
  };
  for (const double share : {0.0, 1.0}) {
    add(low + Vec3(share * s.x, 0, 0), {0, s.y, 0}, {0, 0, s.z});
    add(low + Vec3(0, share * s.y, 0), {s.x, 0, 0}, {0, 0, s.z});
    add(low + Vec3(0, 0, share * s.z), {s.x, 0, 0}, {0, s.y, 0});
  }
}

/// About 30 m wide, 15 m high, 25 m deep, its front at z = 0 looking towards +z.
[[nodiscard]] inline std::vector<WorldTriangle> house_triangles() {
  std::vector<WorldTriangle> t;
  add_box(t, {-10, 0, -12}, {10, 8, 0});
  for (const WorldTriangle& roof : rectangle({-11, 7.5, 1}, {22, 0, 0}, {0, 6, -7})) t.push_back(roof);
  for (const WorldTriangle& roof : rectangle({-11, 7.5, -13}, {22, 0, 0}, {0, 6, 7})) t.push_back(roof);
  add_box(t, {5, 9, -8}, {7, 15, -6});
  add_box(t, {-4, 5, 0}, {4, 5.5, 4});
  add_box(t, {-4, 0, 3.4}, {-3.4, 5, 4});
  add_box(t, {3.4, 0, 3.4}, {4, 5, 4});
  add_box(t, {-15, 0, -22}, {-2, 11, -18});
  for (const WorldTriangle& ground : rectangle({-15, 0, 5}, {30, 0, 0}, {0, 0, -28})) t.push_back(ground);
  return t;
}

}  // namespace standin::test
