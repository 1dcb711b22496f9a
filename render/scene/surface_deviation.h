// How far a simplified mesh's surface lies from the original's, as a proven bound (not in the paper, which takes a scene's levels as given:
// thesis 5.5.1).
//
// A simplifier's own figure is an estimate (a mean over quadrics). Here the one-sided Hausdorff distance is bounded by branch and bound:
// the distance from a point to one triangle is convex, so over a piece of surface it is greatest in the piece's corners; pieces are halved
// where that is not tight yet, the worst first. The bound holds whenever the search stops, so work buys accuracy, never correctness.
//
// Points carry their texture coordinates, scaled to metres (textured_surface.h), as two more dimensions: a surface that keeps its shape but
// lets its picture slip has moved, too.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "render/base/work.h"
#include "render/scene/scene.h"

namespace standin {

/// A point of a textured surface; `texture` in metres along the surface, (0, 0) where there is none.
struct SurfacePoint {
  Vec3 place{0.0};
  Vec2 texture{0.0};
};
using SurfaceTriangle = std::array<SurfacePoint, 3>;

struct Surface {
  std::vector<SurfacePoint> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  [[nodiscard]] SurfaceTriangle corners(std::size_t t) const {
    return {points[triangles[t][0]], points[triangles[t][1]], points[triangles[t][2]]};
  }
};

[[nodiscard]] Surface surface_of(const Mesh& mesh, double metres_per_uv);

/// The triangles nearest to points: a tree of boxes over all five dimensions.
class SurfaceTree {
 public:
  explicit SurfaceTree(const Surface& surface);
  struct Nearest {
    std::uint32_t triangle = 0;
    double distance = 0.0;
  };
  /// Of a surface that is not empty; ties to the triangle met first, the same every time. `guess`: a triangle that may be near.
  [[nodiscard]] Nearest nearest(const SurfacePoint& point, std::uint32_t guess = 0) const;
  [[nodiscard]] const SurfaceTriangle& triangle(std::uint32_t index) const { return triangles_[index]; }
  [[nodiscard]] bool empty() const { return triangles_.empty(); }
  /// Whether every coordinate is a number: from anything else nothing has a distance.
  [[nodiscard]] bool finite() const { return finite_; }

 private:
  struct Node {
    std::array<double, 5> min{}, max{};
    std::uint32_t first = 0;  // a leaf's triangles in order_; else the second child (the first follows its parent)
    std::uint32_t count = 0;  // 0: not a leaf
  };
  std::uint32_t build(std::uint32_t first, std::uint32_t last);
  using Coordinates = std::array<double, 5>;
  [[nodiscard]] static double distance2(const Node& node, const Coordinates& point);

  std::vector<SurfaceTriangle> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
  bool finite_ = true;
};

/// Distance of a point from a triangle.
[[nodiscard]] double distance(const SurfacePoint& point, const SurfaceTriangle& triangle);

/// Where the search may stop: whatever comes first.
struct DeviationLimits {
  double relative = 0.25;                                      // bound over what was found, above 1
  double absolute_m = 0.0;                                     // a bound below this need not be any tighter
  std::uint64_t pieces = 1'000'000;                            // of surface looked at, after the triangles themselves
  double refuted_m = std::numeric_limits<double>::infinity();  // once some point is found to be farther, nothing else is asked
  const WorkBudget* budget = nullptr;                          // asked now and then, where there is one
};

struct Deviation {
  double bound_m = 0.0;  // no point is farther (but for rounding)
  double found_m = 0.0;  // some point is as far
  std::uint64_t pieces = 0;
};

/// From every point of `from` to the nearest point of `to`; infinite where `to` is empty or a coordinate of either is no finite number.
[[nodiscard]] Deviation deviation(const Surface& from, const SurfaceTree& to, const DeviationLimits& limits);

/// A surface that is held against others, with what that takes.
class ComparedSurface {
 public:
  /// A triangle, whatever it is numbered and wherever it begins.
  using Key = std::array<std::array<double, 5>, 3>;
  [[nodiscard]] static Key key_of(const SurfaceTriangle& corners);

  explicit ComparedSurface(Surface surface);
  [[nodiscard]] std::size_t triangle_count() const { return surface_.triangles.size(); }
  [[nodiscard]] bool has(const Key& triangle) const;

  /// The greater of both ways' deviations. Triangles that both have need no look. `limits` are those of each way.
  [[nodiscard]] Deviation deviation_both_ways(const ComparedSurface& other, const DeviationLimits& limits) const;

 private:
  [[nodiscard]] Surface without_those_of(const ComparedSurface& other) const;

  Surface surface_;
  SurfaceTree tree_;
  std::vector<Key> keys_;    // per triangle
  std::vector<Key> sorted_;  // the same
};

}  // namespace standin
