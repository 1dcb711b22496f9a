// Based on: S. Woop, C. Benthin, I. Wald. Watertight Ray/Triangle Intersection. Journal of Computer Graphics Techniques 2(1), 2013.
// We differ: double throughout, so that no fallback is needed; both faces are hit; edges reach out by a tolerance.
#include "server/verify/triangle_caster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace standin {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kLeafTriangles = 4;
// Uneven splits end at a depth from which on halves are taken: 64 levels hold 2^32 triangles below it.
constexpr int kDepthOfHalving = 32;
constexpr std::size_t kStackSize = 72;
// Texel coordinates of corners went through float: within this many texels of a whole number they are meant to be it.
constexpr double kTexelTolerance = 1e-3;

// Coordinates in which the ray runs along +z from the origin.
struct Shear {
  int x = 0, y = 0, z = 0;
  Vec3 s{0.0};

  explicit Shear(const Vec3& direction) {
    const Vec3 size = glm::abs(direction);
    z = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    x = (z + 1) % 3;
    y = (z + 2) % 3;
    s = Vec3(direction[x], direction[y], 1.0) / direction[z];
  }
  [[nodiscard]] Vec3 operator()(const Vec3& v) const { return {v[x] - s.x * v[z], v[y] - s.y * v[z], s.z * v[z]}; }
};

Vec3 safe_inverse(const Vec3& direction) {
  Vec3 inverse(0.0);
  for (int axis = 0; axis < 3; ++axis) inverse[axis] = 1.0 / (direction[axis] != 0.0 ? direction[axis] : 1e-300);
  return inverse;
}

double half_area(const Box& box) {
  const Vec3 size = box.size();
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

// Distance at which the ray enters the box; infinity where it misses it.
double entry(const Box& box, const Vec3& origin, const Vec3& inverse) {
  const Vec3 a = (box.min - origin) * inverse;
  const Vec3 b = (box.max - origin) * inverse;
  const Vec3 low = glm::min(a, b);
  const Vec3 high = glm::max(a, b);
  const double near = std::max({low.x, low.y, low.z, 0.0});
  const double far = std::min({high.x, high.y, high.z});
  return near <= far ? near : kNowhere;
}

}  // namespace

struct TriangleCaster::Query {
  const PixelRay& ray;
  Vec3 origin;  // of the ray, from the impostor's origin
  AlphaSampling sampling;
  Shear shear;
  double best_m = kNowhere;
  const Triangle* best = nullptr;
};

TriangleCaster::TriangleCaster(const GlbQuads& quads, const GlbImpostor& impostor, bool mipmapped) : impostor_(impostor) {
  for (const GlbPage& page : quads.pages) pages_.emplace_back(page, mipmapped);
  for (std::uint32_t i = 0; i < impostor.triangles.size(); ++i)
    if (const auto triangle = prepared(i)) triangles_.push_back(*triangle);
  if (!triangles_.empty()) build(0, static_cast<std::uint32_t>(triangles_.size()), 0);
}

std::optional<TriangleCaster::Triangle> TriangleCaster::prepared(std::uint32_t source) const {
  const GlbTriangle& given = impostor_.triangles[source];
  const Vec3 first = given.offsets[1] - given.offsets[0];
  const Vec3 second = given.offsets[2] - given.offsets[0];
  Triangle result;
  result.normal = glm::cross(first, second);
  const double square = glm::dot(result.normal, result.normal);
  if (!(square > 0.0)) return std::nullopt;
  result.source = source;
  result.corners = given.offsets;
  // Barycentric coordinates of vertices 1 and 2 have these gradients.
  const Vec3 towards_first = glm::cross(second, result.normal) / square;
  const Vec3 towards_second = glm::cross(result.normal, first) / square;
  const Vec2 texel_first = given.texels[1] - given.texels[0];
  const Vec2 texel_second = given.texels[2] - given.texels[0];
  result.texel_x_per_m = texel_first.x * towards_first + texel_second.x * towards_second;
  result.texel_y_per_m = texel_first.y * towards_first + texel_second.y * towards_second;
  const Vec2 low = glm::min(glm::min(given.texels[0], given.texels[1]), given.texels[2]);
  const Vec2 high = glm::max(glm::max(given.texels[0], given.texels[1]), given.texels[2]);
  result.texel_min = glm::floor(low + kTexelTolerance);
  result.texel_max = glm::max(glm::ceil(high - kTexelTolerance), result.texel_min + 1.0);
  return result;
}

std::pair<Vec3, Vec3> TriangleCaster::texel_steps(std::uint32_t triangle) const {
  const GlbTriangle& given = impostor_.triangles[triangle];
  const Vec3 first = given.offsets[1] - given.offsets[0];
  const Vec3 second = given.offsets[2] - given.offsets[0];
  const Vec2 a = given.texels[1] - given.texels[0];
  const Vec2 b = given.texels[2] - given.texels[0];
  const double area = a.x * b.y - a.y * b.x;
  if (std::abs(area) <= kTexelTolerance * kTexelTolerance) return {Vec3(0.0), Vec3(0.0)};
  return {(b.y * first - a.y * second) / area, (a.x * second - b.x * first) / area};
}

// Of the triangle and of what lies beyond its edges by tolerance, which is more than rounding.
Box TriangleCaster::box_of(const Triangle& triangle) {
  Box box;
  for (const Vec3& corner : triangle.corners) box.extend(corner);
  const Vec3 margin(4.0 * kEdgeTolerance * box.diagonal());
  return {box.min - margin, box.max + margin};
}

// By centre along an axis; ties by index, so that the tree is the same everywhere.
void TriangleCaster::sort_along(int axis, std::uint32_t first, std::uint32_t last) {
  const auto key = [axis](const Triangle& t) { return std::pair(t.corners[0][axis] + t.corners[1][axis] + t.corners[2][axis], t.source); };
  std::sort(triangles_.begin() + first, triangles_.begin() + last, [&](const Triangle& a, const Triangle& b) { return key(a) < key(b); });
}

// Surface area heuristic over the triangles as they are sorted: where to split, and the sum of area times triangles of both sides.
std::pair<std::uint32_t, double> TriangleCaster::best_split(std::uint32_t first, std::uint32_t last) const {
  std::vector<double> area_after(last - first);
  Box after;
  for (std::uint32_t i = last; i-- > first;) {
    after.extend(box_of(triangles_[i]));
    area_after[i - first] = half_area(after);
  }
  std::pair best(first + (last - first) / 2, kNowhere);
  Box before;
  for (std::uint32_t i = first + 1; i < last; ++i) {
    before.extend(box_of(triangles_[i - 1]));
    const double cost = half_area(before) * (i - first) + area_after[i - first] * (last - i);
    if (cost < best.second) best = {i, cost};
  }
  return best;
}

void TriangleCaster::build(std::uint32_t first, std::uint32_t last, int depth) {
  const std::size_t index = nodes_.size();
  nodes_.emplace_back();
  for (std::uint32_t i = first; i < last; ++i) nodes_[index].box.extend(box_of(triangles_[i]));
  if (last - first <= kLeafTriangles) {
    nodes_[index].first = first;
    nodes_[index].count = last - first;
    return;
  }
  int best_axis = 0;
  std::pair best(first, kNowhere);
  for (int axis = 0; axis < 3; ++axis) {
    sort_along(axis, first, last);
    const auto split = best_split(first, last);
    if (axis > 0 && !(split.second < best.second)) continue;
    best = split;
    best_axis = axis;
  }
  if (depth >= kDepthOfHalving) best.first = first + (last - first) / 2;
  sort_along(best_axis, first, last);
  build(first, best.first, depth + 1);
  nodes_[index].first = static_cast<std::uint32_t>(nodes_.size());
  build(best.first, last, depth + 1);
}

Vec2 TriangleCaster::texel_at(const Triangle& triangle, const Vec3& point) const {
  const Vec3 way = point - triangle.corners[0];
  return impostor_.triangles[triangle.source].texels[0] +
         Vec2(glm::dot(triangle.texel_x_per_m, way), glm::dot(triangle.texel_y_per_m, way));
}

// Where the neighbouring pixels' rays meet the triangle's plane; infinite where one does not.
double TriangleCaster::footprint_texels(const Triangle& triangle, const Query& query, const Vec2& texel) const {
  const double height = glm::dot(triangle.normal, triangle.corners[0] - query.origin);
  double longest = 0.0;
  for (const Vec3& direction : {query.ray.direction_right, query.ray.direction_down}) {
    const double distance_m = height / glm::dot(triangle.normal, direction);
    if (!(distance_m > 0.0) || !std::isfinite(distance_m)) return kNowhere;
    longest = std::max(longest, glm::length(texel_at(triangle, query.origin + distance_m * direction) - texel));
  }
  return longest;
}

bool TriangleCaster::is_opaque(const Triangle& triangle, const Query& query, const Vec3& point) const {
  const AlphaPage& page = pages_[impostor_.triangles[triangle.source].page];
  const Vec2 texel = texel_at(triangle, point);
  if (query.sampling == AlphaSampling::kNearest)
    return page.is_opaque(glm::clamp(glm::floor(texel), triangle.texel_min, triangle.texel_max - 1.0), 0.0, query.sampling);
  const double footprint = query.sampling == AlphaSampling::kMipmapped ? footprint_texels(triangle, query, texel) : 0.0;
  return page.is_opaque(texel, footprint, query.sampling);
}

void TriangleCaster::try_triangle(const Triangle& triangle, Query& query) const {
  const Vec3 a = query.shear(triangle.corners[0] - query.origin);
  const Vec3 b = query.shear(triangle.corners[1] - query.origin);
  const Vec3 c = query.shear(triangle.corners[2] - query.origin);
  const double u = c.x * b.y - c.y * b.x;
  const double v = a.x * c.y - a.y * c.x;
  const double w = b.x * a.y - b.y * a.x;
  const double area = u + v + w;
  if (area == 0.0) return;  // seen edge on: its neighbours have the edge too
  if (!(std::min({u / area, v / area, w / area}) >= -kEdgeTolerance)) return;
  const double distance_m = (u * a.z + v * b.z + w * c.z) / area;
  if (!(distance_m > 0.0) || distance_m > query.best_m) return;
  if (distance_m == query.best_m && query.best->source < triangle.source) return;
  if (!is_opaque(triangle, query, query.origin + distance_m * query.ray.direction)) return;
  query.best_m = distance_m;
  query.best = &triangle;
}

std::optional<TriangleCaster::Shown> TriangleCaster::first_opaque(const PixelRay& ray, AlphaSampling sampling) const {
  Query query{ray, ray.origin - impostor_.origin, sampling, Shear(ray.direction)};
  const Vec3 inverse = safe_inverse(ray.direction);
  std::array<std::pair<double, std::uint32_t>, kStackSize> stack;
  std::size_t depth = 0;
  const auto push = [&](std::uint32_t node) {
    const double near = entry(nodes_[node].box, query.origin, inverse);
    if (near <= query.best_m && near < kNowhere) stack[depth++] = {near, node};
  };
  if (!nodes_.empty()) push(0);
  while (depth > 0) {
    const auto [near, index] = stack[--depth];
    if (near > query.best_m) continue;
    const Node& node = nodes_[index];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) try_triangle(triangles_[i], query);
    if (node.count > 0) continue;
    push(index + 1);
    push(node.first);
    // The nearer child is taken first.
    if (depth >= 2 && stack[depth - 1].second == node.first && stack[depth - 2].second == index + 1 &&
        stack[depth - 2].first < stack[depth - 1].first)
      std::swap(stack[depth - 1], stack[depth - 2]);
  }
  if (query.best == nullptr) return std::nullopt;
  return Shown{query.best->source, query.best_m, ray.origin + query.best_m * ray.direction};
}

}  // namespace standin
