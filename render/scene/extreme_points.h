// The vertices that lie farthest along the 26 directions to a cube's faces, edges and corners: they span nearly what all vertices do.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "render/base/geometry.h"

namespace standin {

/// One of each opposite pair.
inline constexpr std::array<std::array<double, 3>, 13> kExtremeDirections = {{{1, 0, 0},
                                                                              {0, 1, 0},
                                                                              {0, 0, 1},
                                                                              {1, 1, 0},
                                                                              {1, -1, 0},
                                                                              {1, 0, 1},
                                                                              {1, 0, -1},
                                                                              {0, 1, 1},
                                                                              {0, 1, -1},
                                                                              {1, 1, 1},
                                                                              {1, 1, -1},
                                                                              {1, -1, 1},
                                                                              {1, -1, -1}}};

/// At most 26 of the points (of Vec3 or glm::vec3), each once, in their order.
template <class Points>
[[nodiscard]] std::vector<Vec3> extreme_points(const Points& points) {
  std::array<std::size_t, 2 * kExtremeDirections.size()> chosen{};
  for (std::size_t d = 0; d < kExtremeDirections.size(); ++d) {
    const Vec3 direction(kExtremeDirections[d][0], kExtremeDirections[d][1], kExtremeDirections[d][2]);
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double along = glm::dot(direction, Vec3(points[i]));
      if (along < least) {
        least = along;
        chosen[2 * d] = i;
      }
      if (along > most) {
        most = along;
        chosen[2 * d + 1] = i;
      }
    }
  }
  std::sort(chosen.begin(), chosen.end());
  std::vector<Vec3> extremes;
  for (std::size_t k = 0; k < chosen.size() && !points.empty(); ++k)
    if (k == 0 || chosen[k] != chosen[k - 1]) extremes.emplace_back(points[chosen[k]]);
  return extremes;
}

}  // namespace standin
