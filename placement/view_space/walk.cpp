// The walk view space: where an eye 1.7 m above the ground stands clear of objects.
//
// Rays straight down on a fine grid find the highest surface under free sky; ground.h tells the ground from the tops of objects (a literal
// reading would put people on roofs). A square of the grid is taken as a whole or not at all: rays at eye height must find it, and 0.3 m
// around it, free. Squares are gathered into columns of the size of the finest cells, each with the eye heights of its own ground and 0.1 m
// of slack, and equal neighbours are merged, so that the boxes hold no position that was not found free.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "placement/view_space/ground.h"
#include "placement/view_space/number_text.h"
#include "placement/view_space/view_space.h"
#include "render/base/error.h"
#include "render/base/parallel.h"

namespace standin {
namespace {

constexpr int kSquaresPerColumn = 4;
constexpr double kMostSquares = 4e6;
constexpr double kClearance_m = 0.3;
constexpr double kEyeSlack_m = 0.1;
constexpr double kMaxSlope = 0.45;  // 24 degrees: steeper than streets, and no way up a car by its bonnet
constexpr double kMaxRise_m = 2.5;  // higher steps are objects, however coarse the grid
// A column whose ground rises by more is kept as single squares: its lowest eye would stand too low at its upper end.
constexpr std::int32_t kMaxColumnRise_cm = 80;

/// Ground heights of a square in whole centimetres, so that flat ground merges whatever the rays' rounding.
struct HeightRange {
  std::int32_t low_cm = std::numeric_limits<std::int32_t>::max();
  std::int32_t high_cm = std::numeric_limits<std::int32_t>::min();
  void extend(std::int32_t cm) {
    low_cm = std::min(low_cm, cm);
    high_cm = std::max(high_cm, cm);
  }
  [[nodiscard]] bool empty() const { return low_cm > high_cm; }
  friend bool operator==(const HeightRange&, const HeightRange&) = default;
};

double square_side(const Scene& scene, double leaf_m) {
  const Vec3 size = scene.bounds.size();
  double side = leaf_m / 16.0;
  while ((size.x / side + 1.0) * (size.z / side + 1.0) > kMostSquares) side *= 2.0;
  return side;
}

HeightField measure_heights(const Scene& scene, const Raytracer& raytracer, double side_m, int threads, const WorkBudget& budget) {
  const Vec3 size = scene.bounds.size();
  HeightField field;
  field.width = std::max(1, static_cast<int>(std::ceil(size.x / side_m)));
  field.depth = std::max(1, static_cast<int>(std::ceil(size.z / side_m)));
  field.spacing_m = side_m;
  field.min_x = scene.bounds.min.x;
  field.min_z = scene.bounds.min.z;
  field.height_m.assign(static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.depth), HeightField::kNone);
  const double sky_m = scene.bounds.max.y + 1.0;
  parallel_for(static_cast<std::size_t>(field.depth), threads, budget, [&](std::size_t row) {
    const int iz = static_cast<int>(row);
    for (int ix = 0; ix < field.width; ++ix) {
      const Vec3 from(field.min_x + (ix + 0.5) * side_m, sky_m, field.min_z + (iz + 0.5) * side_m);
      if (const auto hit = raytracer.nearest(from, {0.0, -1.0, 0.0})) field.height_m[field.at(ix, iz)] = sky_m - hit->distance_m;
    }
  });
  return field;
}

// Whether the square and its surroundings are free at eye height: no ray along the border of the enlarged square meets anything (what
// reaches in from outside crosses it), nor one along its diagonals.
bool stands_clear(const Raytracer& raytracer, const Vec3& eye, double side_m) {
  const double reach_m = 0.5 * side_m + kClearance_m;
  const std::array<Vec3, 4> corners = {eye + Vec3(-reach_m, 0, -reach_m), eye + Vec3(reach_m, 0, -reach_m), eye + Vec3(reach_m, 0, reach_m),
                                       eye + Vec3(-reach_m, 0, reach_m)};
  constexpr std::array<std::array<std::size_t, 2>, 6> kRays = {{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}, {1, 3}}};
  return std::none_of(kRays.begin(), kRays.end(), [&](const auto& ray) {
    const Vec3 along = corners[ray[1]] - corners[ray[0]];
    const double length_m = glm::length(along);
    return !raytracer.all(corners[ray[0]], along / length_m, 0.0, length_m).empty();
  });
}

// One entry per square; empty where nobody can stand.
std::vector<HeightRange> standable_squares(const HeightField& field, const Raytracer& raytracer, double eye_height_m, int threads,
                                           const WorkBudget& budget) {
  const auto ground = find_ground(field, std::min(kMaxSlope * field.spacing_m, kMaxRise_m));
  std::vector<HeightRange> squares(ground.size());
  parallel_for(static_cast<std::size_t>(field.depth), threads, budget, [&](std::size_t row) {
    const int iz = static_cast<int>(row);
    for (int ix = 0; ix < field.width; ++ix) {
      const std::size_t square = field.at(ix, iz);
      if (!ground[square]) continue;
      const double height_m = field.height_m[square];
      const Vec3 eye(field.min_x + (ix + 0.5) * field.spacing_m, height_m + eye_height_m, field.min_z + (iz + 0.5) * field.spacing_m);
      if (stands_clear(raytracer, eye, field.spacing_m)) squares[square].extend(static_cast<std::int32_t>(std::lround(100.0 * height_m)));
    }
  });
  return squares;
}

/// Squares of the height field from the first that is standable in x and z: the origin of the view space's dyadic grid.
struct SquareGrid {
  int width = 0, depth = 0;
  double side_m = 0.0;
  double min_x = 0.0, min_z = 0.0;
  std::vector<HeightRange> squares;
  HeightRange& at(int ix, int iz) {
    return squares[static_cast<std::size_t>(iz) * static_cast<std::size_t>(width) + static_cast<std::size_t>(ix)];
  }
};

SquareGrid cropped(const HeightField& field, const std::vector<HeightRange>& squares) {
  int x0 = field.width, x1 = -1, z0 = field.depth, z1 = -1;
  for (int iz = 0; iz < field.depth; ++iz)
    for (int ix = 0; ix < field.width; ++ix) {
      if (squares[field.at(ix, iz)].empty()) continue;
      x0 = std::min(x0, ix);
      x1 = std::max(x1, ix);
      z0 = std::min(z0, iz);
      z1 = std::max(z1, iz);
    }
  SquareGrid grid;
  if (x1 < x0) return grid;
  grid = {x1 - x0 + 1, z1 - z0 + 1, field.spacing_m, field.min_x + x0 * field.spacing_m, field.min_z + z0 * field.spacing_m, {}};
  for (int iz = z0; iz <= z1; ++iz)
    for (int ix = x0; ix <= x1; ++ix) grid.squares.push_back(squares[field.at(ix, iz)]);
  return grid;
}

// Gives all squares of a column the column's range of heights, unless that is too wide.
void level_column(SquareGrid& grid, int x0, int z0) {
  const int x1 = std::min(x0 + kSquaresPerColumn, grid.width), z1 = std::min(z0 + kSquaresPerColumn, grid.depth);
  HeightRange range;
  for (int iz = z0; iz < z1; ++iz)
    for (int ix = x0; ix < x1; ++ix)
      if (!grid.at(ix, iz).empty()) range.extend(grid.at(ix, iz).low_cm);
  if (range.empty() || range.high_cm - range.low_cm > kMaxColumnRise_cm) return;
  for (int iz = z0; iz < z1; ++iz)
    for (int ix = x0; ix < x1; ++ix)
      if (!grid.at(ix, iz).empty()) grid.at(ix, iz) = range;
}

// Greedy: the longest run of equal squares along x, then as many equal rows of it along z. Empties the squares it takes.
std::vector<Box> merge_squares(SquareGrid& grid, double eye_height_m) {
  std::vector<Box> boxes;
  for (int iz = 0; iz < grid.depth; ++iz)
    for (int ix = 0; ix < grid.width; ++ix) {
      const HeightRange range = grid.at(ix, iz);
      if (range.empty()) continue;
      int x1 = ix + 1, z1 = iz + 1;
      while (x1 < grid.width && grid.at(x1, iz) == range) ++x1;
      const auto row_equal = [&](int z) {
        for (int x = ix; x < x1; ++x)
          if (grid.at(x, z) != range) return false;
        return true;
      };
      while (z1 < grid.depth && row_equal(z1)) ++z1;
      for (int z = iz; z < z1; ++z)
        for (int x = ix; x < x1; ++x) grid.at(x, z) = {};
      const double low_m = range.low_cm / 100.0 + eye_height_m - kEyeSlack_m;
      const double high_m = range.high_cm / 100.0 + eye_height_m + kEyeSlack_m;
      boxes.push_back({{grid.min_x + ix * grid.side_m, low_m, grid.min_z + iz * grid.side_m},
                       {grid.min_x + x1 * grid.side_m, high_m, grid.min_z + z1 * grid.side_m}});
    }
  return boxes;
}

}  // namespace

ViewSpace make_walk_view_space(const Scene& scene, const Raytracer& raytracer, const ViewSpaceOptions& options, int threads,
                               const WorkBudget& budget) {
  if (!(std::isfinite(options.leaf_m) && options.leaf_m > 0.0 && std::isfinite(options.eye_height_m) && options.eye_height_m > 0.0))
    throw Failure(ErrorWord::kBadUsage, "walk: leaf side " + number_text(options.leaf_m) + " m and eye height " +
                                            number_text(options.eye_height_m) + " m must be finite and positive");
  const HeightField field = measure_heights(scene, raytracer, square_side(scene, options.leaf_m), threads, budget);
  SquareGrid grid = cropped(field, standable_squares(field, raytracer, options.eye_height_m, threads, budget));
  for (int iz = 0; iz < grid.depth; iz += kSquaresPerColumn)
    for (int ix = 0; ix < grid.width; ix += kSquaresPerColumn) level_column(grid, ix, iz);
  std::string why =
      "walk: eyes " + number_text(options.eye_height_m) + " m above the ground, found on a grid of " + number_text(field.spacing_m) + " m";
  return finish_view_space(ViewSpaceKind::kWalk, std::move(why), merge_squares(grid, options.eye_height_m), options);
}

}  // namespace standin
