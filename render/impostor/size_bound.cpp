#include "render/impostor/size_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "render/impostor/atlas.h"
#include "render/impostor/mesh_shape.h"

namespace standin {
namespace {

// Positions are rounded in other ways here than in the bake: far less than this, of a texel and of an area.
constexpr double kRoundingTexels = 1e-3;
constexpr double kRoundingShare = 1e-6;
constexpr std::size_t kMostFaces = 48;  // that are tried for overlap

struct Interval {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void extend(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

/// Projected face, in texels. Its corners turn one way.
struct Polygon {
  std::array<Vec2, 4> corners{Vec2(0.0), Vec2(0.0), Vec2(0.0), Vec2(0.0)};
  std::size_t count = 0;
  double area = 0.0;
  Interval x, y;
};

double cross(const Vec2& a, const Vec2& b) {
  return a.x * b.y - a.y * b.x;
}

double twice_area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return cross(b - a, c - a);
}

/// The frame's slopes in texels: the texture's own coordinates but for the place of its grid.
class Projection {
 public:
  Projection(const ImpostorFrame& frame, const Mat4& world_from_mesh)
      : mesh_to_frame_(glm::transpose(Mat3(frame.right, frame.up, frame.forward)) * Mat3(world_from_mesh)),
        origin_(glm::transpose(Mat3(frame.right, frame.up, frame.forward)) * (Vec3(world_from_mesh[3]) - frame.reference_viewpoint)),
        texels_per_slope_(1.0 / frame.slope_step.x) {}

  [[nodiscard]] Vec2 operator()(const Vec3& point) const {
    const Vec3 p = mesh_to_frame_ * point + origin_;
    return Vec2(p.x, p.y) * (texels_per_slope_ / p.z);
  }

 private:
  Mat3 mesh_to_frame_;
  Vec3 origin_;
  double texels_per_slope_;
};

/// Where perspective bends a face that is not quite flat, its larger triangle.
Polygon project(const SizeBound::Face& face, const Projection& projection) {
  Polygon polygon;
  polygon.count = face.count;
  for (std::size_t i = 0; i < face.count; ++i) polygon.corners[i] = projection(face.corners[i]);
  auto& p = polygon.corners;
  double doubled = twice_area(p[0], p[1], p[2]);
  if (face.count == 4) {
    const double turns[] = {doubled, twice_area(p[1], p[2], p[3]), twice_area(p[2], p[3], p[0]), twice_area(p[3], p[0], p[1])};
    const bool convex = std::all_of(std::begin(turns), std::end(turns), [&](double turn) { return turn * turns[0] > 0.0; });
    if (convex) {
      doubled += turns[2];
    } else {
      if (std::abs(turns[2]) > std::abs(turns[0])) p[1] = p[3], doubled = turns[2];
      polygon.count = 3;
    }
  }
  polygon.area = 0.5 * std::abs(doubled);
  for (std::size_t i = 0; i < polygon.count; ++i) {
    polygon.x.extend(p[i].x);
    polygon.y.extend(p[i].y);
  }
  return polygon;
}

/// Whether a side of `a` has all of `b` beyond it.
bool side_separates(const Polygon& a, const Polygon& b) {
  const double inward = twice_area(a.corners[0], a.corners[1], a.corners[2]) > 0.0 ? 1.0 : -1.0;
  for (std::size_t i = 0; i < a.count; ++i) {
    const Vec2 &from = a.corners[i], &to = a.corners[(i + 1) % a.count];
    if (std::all_of(b.corners.begin(), b.corners.begin() + static_cast<std::ptrdiff_t>(b.count),
                    [&](const Vec2& corner) { return inward * twice_area(from, to, corner) <= 0.0; }))
      return true;
  }
  return false;
}

bool are_apart(const Polygon& a, const Polygon& b) {
  const bool rectangles = a.x.high <= b.x.low || b.x.high <= a.x.low || a.y.high <= b.y.low || b.y.high <= a.y.low;
  return rectangles || side_separates(a, b) || side_separates(b, a);
}

/// Of faces that do not overlap, chosen from the largest on.
double covered_area(const std::vector<Polygon>& polygons) {
  std::vector<std::uint32_t> order(polygons.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto tried = order.begin() + static_cast<std::ptrdiff_t>(std::min(polygons.size(), kMostFaces));
  std::partial_sort(order.begin(), tried, order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return polygons[a].area != polygons[b].area ? polygons[a].area > polygons[b].area : a < b;
  });
  auto chosen = order.begin();
  double area = 0.0;
  for (auto face = order.begin(); face != tried; ++face) {
    const auto is_apart = [&](std::uint32_t other) { return are_apart(polygons[*face], polygons[other]); };
    if (!std::all_of(order.begin(), chosen, is_apart)) continue;
    area += polygons[*face].area;
    *chosen++ = *face;
  }
  return area;
}

double covered_length(std::vector<Interval>& intervals) {
  std::sort(intervals.begin(), intervals.end(), [](const Interval& a, const Interval& b) { return a.low < b.low; });
  double length = 0.0, end = -std::numeric_limits<double>::infinity();
  for (const Interval& interval : intervals) {
    length += std::max(0.0, interval.high - std::max(end, interval.low));
    end = std::max(end, interval.high);
  }
  return length;
}

double whole_texels(double at_least) {
  return std::max(1.0, std::ceil(at_least * (1.0 - kRoundingShare) - kRoundingTexels));
}

/// What a cluster's drawn surfaces are in projection.
struct Shadow {
  std::vector<Polygon> polygons;
  std::vector<Interval> x, y;  // of connected pieces
};

double bytes_of(Shadow& shadow) {
  if (shadow.x.empty()) return 0.0;
  constexpr double kGutter = AtlasOptions{}.gutter;
  const double columns = whole_texels(covered_length(shadow.x)), rows = whole_texels(covered_length(shadow.y));
  const double texels = std::max({whole_texels(covered_area(shadow.polygons)), columns, rows});
  return 4.0 * (texels + 2.0 * kGutter * (columns + rows) + 4.0 * kGutter * kGutter);
}

}  // namespace

SizeBound::SizeBound(const Scene& scene) : scene_(scene) {
  for (const Mesh& mesh : scene.meshes) shapes_.push_back(shape_of(mesh));
}

double SizeBound::texture_bytes(std::span<const std::uint32_t> objects, const ViewCell& cell, const Camera& camera,
                                const BakeQuality& quality) const {
  if (!quality.supercover) return 0.0;
  Box bounds;
  std::vector<Vec3> vertices;
  for (const std::uint32_t id : objects) {
    const Object& object = scene_.objects[id];
    bounds.extend(object.bounds);
    for (std::uint32_t i = 0; i < object.part_count; ++i)
      for (const auto& piece : shapes_[scene_.parts[object.first_part + i].mesh].pieces)
        for (const Vec3& point : piece) vertices.emplace_back(object.world_from_object * Vec4(point, 1.0));
  }
  const ImpostorSketch sketch = sketch_impostor(bounds, vertices, cell, camera, quality);
  if (vertices.empty() || sketch.frame.width == 0) return 0.0;

  Shadow shadow;
  for (const std::uint32_t id : objects) {
    const Object& object = scene_.objects[id];
    const Projection projection(sketch.frame, object.world_from_object);
    for (std::uint32_t i = 0; i < object.part_count; ++i) {
      const Part& part = scene_.parts[object.first_part + i];
      if (scene_.materials[part.material].alpha_mode == AlphaMode::kMask) continue;
      for (const Face& face : shapes_[part.mesh].faces) shadow.polygons.push_back(project(face, projection));
      for (const auto& piece : shapes_[part.mesh].pieces) {
        shadow.x.emplace_back();
        shadow.y.emplace_back();
        for (const Vec3& point : piece) {
          const Vec2 texel = projection(point);
          shadow.x.back().extend(texel.x);
          shadow.y.back().extend(texel.y);
        }
      }
    }
  }
  return bytes_of(shadow);
}

}  // namespace standin
