// Which part of a city's surface is the ground people walk on: a height field, and the samples of it that are not the tops of objects.
//
// "The highest surface under free sky" is a roof where there is a house. Ground is what one can walk to: the largest region whose
// neighbouring heights differ by no more than a slope allows, and everything that can be reached from it by such steps or by going down.
// Pockets that objects cut off (courtyards) count as well when they lie no higher than the ground around those objects.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace standin {

/// Heights at the centres of squares of `spacing_m`; row by row, x fastest.
struct HeightField {
  static constexpr double kNone = -std::numeric_limits<double>::infinity();  // no surface there

  int width = 0;
  int depth = 0;
  double spacing_m = 0.0;
  double min_x = 0.0;
  double min_z = 0.0;
  std::vector<double> height_m;

  [[nodiscard]] std::size_t at(int ix, int iz) const {
    return static_cast<std::size_t>(iz) * static_cast<std::size_t>(width) + static_cast<std::size_t>(ix);
  }
};

/// 1 where a sample is ground. A step between neighbours is walkable up to `max_rise_m`.
[[nodiscard]] std::vector<std::uint8_t> find_ground(const HeightField& field, double max_rise_m);

}  // namespace standin
