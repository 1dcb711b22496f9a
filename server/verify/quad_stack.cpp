#include "server/verify/quad_stack.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "render/base/error.h"
#include "render/view/view_cell.h"

namespace standin {
namespace {

constexpr int kBins = 48;
// Vertices are float: planes are told apart, and triangles are taken for parallel to theirs, within this share of the depth.
constexpr double kDepthTolerance = 1e-5;
// In barycentric coordinates: neighbouring quads, whose corners are rounded to float, leave no slit.
constexpr double kEdgeTolerance = 1e-5;

struct Projected {
  double depth_m = 0.0;
  std::array<Vec2, 3> slopes{};
  const GlbTriangle* source = nullptr;
};

Projected project(const GlbTriangle& triangle, const GlbImpostor& impostor, const StackFrame& frame) {
  Projected result{0.0, {}, &triangle};
  std::array<double, 3> depths{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 offset = impostor.origin - frame.origin + triangle.offsets[k];
    depths[k] = glm::dot(offset, frame.forward);
    result.slopes[k] = Vec2(glm::dot(offset, frame.right), glm::dot(offset, frame.up)) / depths[k];
  }
  const auto [low, high] = std::minmax({depths[0], depths[1], depths[2]});
  if (!(low > 0.0 && high - low <= kDepthTolerance * high))
    throw Failure(ErrorWord::kFileBroken, "impostor GLB, node " + impostor.node + ": a triangle reaches from depth " + std::to_string(low) +
                                              " to " + std::to_string(high) +
                                              " m and is no part of a layer before the reference viewpoint");
  result.depth_m = (depths[0] + depths[1] + depths[2]) / 3.0;
  return result;
}

int bin_of(double slope, double low, double bins_per_slope) {
  return static_cast<int>(std::clamp(std::floor((slope - low) * bins_per_slope), 0.0, kBins - 1.0));
}

}  // namespace

StackFrame stack_frame(const Vec3& reference_viewpoint, const Vec3& forward) {
  const Shaft axes = shaft_frame(reference_viewpoint, -forward);
  return {reference_viewpoint, forward, axes.right, axes.up};
}

QuadStack::QuadStack(const GlbQuads& quads, const GlbImpostor& impostor, const StackFrame& frame) : pages_(quads.pages), frame_(frame) {
  std::vector<Projected> triangles;
  for (const auto& triangle : impostor.triangles) triangles.push_back(project(triangle, impostor, frame));
  std::stable_sort(triangles.begin(), triangles.end(), [](const Projected& a, const Projected& b) { return a.depth_m < b.depth_m; });
  for (const auto& triangle : triangles) {
    if (planes_.empty() || triangle.depth_m - planes_.back().depth_m > kDepthTolerance * triangle.depth_m)
      planes_.push_back(Plane{triangle.depth_m, {}, {}, {}, {}, {}});
    planes_.back().triangles.push_back(make_triangle(*triangle.source, triangle.slopes));
  }
  for (Plane& plane : planes_) build_grid(plane);
}

QuadStack::Triangle QuadStack::make_triangle(const GlbTriangle& source, const std::array<Vec2, 3>& slopes) {
  const Vec2 a = slopes[1] - slopes[0];
  const Vec2 b = slopes[2] - slopes[0];
  const double area = a.x * b.y - a.y * b.x;
  if (area == 0.0) throw Failure(ErrorWord::kFileBroken, "impostor GLB: a triangle has no area");
  Triangle result;
  result.page = source.page;
  result.corner = slopes[0];
  result.to_first = Vec2(b.y, -b.x) / area;
  result.to_second = Vec2(-a.y, a.x) / area;
  result.texel = source.texels[0];
  result.texel_first = source.texels[1] - source.texels[0];
  result.texel_second = source.texels[2] - source.texels[0];
  result.texel_min = glm::round(glm::min(glm::min(source.texels[0], source.texels[1]), source.texels[2]));
  result.texel_max = glm::round(glm::max(glm::max(source.texels[0], source.texels[1]), source.texels[2]));
  result.slope_min = glm::min(glm::min(slopes[0], slopes[1]), slopes[2]);
  result.slope_max = glm::max(glm::max(slopes[0], slopes[1]), slopes[2]);
  result.slope_step = (result.slope_max - result.slope_min) / glm::max(result.texel_max - result.texel_min, Vec2(1.0));
  return result;
}

// Counting sort of the triangles into the bins that their bounds touch.
void QuadStack::build_grid(Plane& plane) {
  plane.low = Vec2(std::numeric_limits<double>::infinity());
  Vec2 high(-std::numeric_limits<double>::infinity());
  for (const auto& triangle : plane.triangles) {
    plane.low = glm::min(plane.low, triangle.slope_min);
    high = glm::max(high, triangle.slope_max);
  }
  plane.bins_per_slope = static_cast<double>(kBins) / (high - plane.low);
  const auto for_each_bin = [&](const Triangle& triangle, const auto& visit) {
    const Vec2 margin = kEdgeTolerance * (triangle.slope_max - triangle.slope_min);
    const Vec2 low = triangle.slope_min - margin;
    const Vec2 top = triangle.slope_max + margin;
    for (int y = bin_of(low.y, plane.low.y, plane.bins_per_slope.y); y <= bin_of(top.y, plane.low.y, plane.bins_per_slope.y); ++y)
      for (int x = bin_of(low.x, plane.low.x, plane.bins_per_slope.x); x <= bin_of(top.x, plane.low.x, plane.bins_per_slope.x); ++x)
        visit(static_cast<std::size_t>(y * kBins + x));
  };
  plane.bin_first.assign(kBins * kBins + 1, 0);
  for (const auto& triangle : plane.triangles) for_each_bin(triangle, [&](std::size_t bin) { ++plane.bin_first[bin + 1]; });
  for (std::size_t bin = 0; bin < kBins * kBins; ++bin) plane.bin_first[bin + 1] += plane.bin_first[bin];
  plane.bin_items.resize(plane.bin_first.back());
  std::vector<std::uint32_t> next(plane.bin_first.begin(), plane.bin_first.end() - 1);
  for (std::uint32_t i = 0; i < plane.triangles.size(); ++i)
    for_each_bin(plane.triangles[i], [&](std::size_t bin) { plane.bin_items[next[bin]++] = i; });
}

// Nearest texel, as the GLB's sampler says.
bool QuadStack::is_opaque(const Triangle& triangle, double first, double second) const {
  const Vec2 point = triangle.texel + first * triangle.texel_first + second * triangle.texel_second;
  const Vec2 texel = glm::clamp(glm::floor(point), triangle.texel_min, glm::max(triangle.texel_min, triangle.texel_max - 1.0));
  const GlbPage& page = pages_[triangle.page];
  if (texel.x < 0.0 || texel.y < 0.0 || texel.x >= page.width || texel.y >= page.height) return false;
  return page.opaque[static_cast<std::size_t>(texel.y) * static_cast<std::size_t>(page.width) + static_cast<std::size_t>(texel.x)];
}

const QuadStack::Triangle* QuadStack::opaque_at(const Plane& plane, const Vec2& slope) const {
  const Vec2 bin = glm::floor((slope - plane.low) * plane.bins_per_slope);
  if (!(bin.x >= -1.0 && bin.y >= -1.0 && bin.x <= kBins && bin.y <= kBins)) return nullptr;
  const auto index = static_cast<std::size_t>(bin_of(slope.y, plane.low.y, plane.bins_per_slope.y) * kBins +
                                              bin_of(slope.x, plane.low.x, plane.bins_per_slope.x));
  for (std::uint32_t i = plane.bin_first[index]; i < plane.bin_first[index + 1]; ++i) {
    const Triangle& triangle = plane.triangles[plane.bin_items[i]];
    const double first = glm::dot(triangle.to_first, slope - triangle.corner);
    const double second = glm::dot(triangle.to_second, slope - triangle.corner);
    const bool inside = first >= -kEdgeTolerance && second >= -kEdgeTolerance && first + second <= 1.0 + kEdgeTolerance;
    if (inside && is_opaque(triangle, first, second)) return &triangle;
  }
  return nullptr;
}

std::optional<QuadStack::Texel> QuadStack::first_opaque(const Vec3& origin, const Vec3& direction) const {
  const Vec3 start = origin - frame_.origin;
  const double start_depth = glm::dot(start, frame_.forward);
  const double rate = glm::dot(direction, frame_.forward);
  if (!(rate > 0.0)) return std::nullopt;
  const Vec2 start_across(glm::dot(start, frame_.right), glm::dot(start, frame_.up));
  const Vec2 rate_across(glm::dot(direction, frame_.right), glm::dot(direction, frame_.up));
  for (const Plane& plane : planes_) {
    const double distance = (plane.depth_m - start_depth) / rate;
    if (distance <= 0.0) continue;
    const Vec2 slope = (start_across + distance * rate_across) / plane.depth_m;
    if (const Triangle* triangle = opaque_at(plane, slope)) return Texel{plane.depth_m, distance, slope, triangle->slope_step};
  }
  return std::nullopt;
}

}  // namespace standin
