#include "render/impostor/chart_texels.h"

#include <algorithm>
#include <cmath>

#include "render/impostor/cluster_surface.h"

namespace standin {
namespace {

/// A texel is filled where its centre is this near to a triangle: its square may meet the triangle (0.71), and one texel more.
constexpr double kReachTexels = 1.75;

double cross(const Vec2& a, const Vec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// Barycentric coordinates of the triangle's point nearest to `point`.
Vec3 nearest_barycentric(const std::array<Vec2, 3>& t, const Vec2& point) {
  const double area = cross(t[1] - t[0], t[2] - t[0]);
  const Vec3 b = Vec3(cross(t[1] - point, t[2] - point), cross(t[2] - point, t[0] - point), cross(t[0] - point, t[1] - point)) / area;
  if (area != 0.0 && b.x >= 0.0 && b.y >= 0.0 && b.z >= 0.0) return b;
  Vec3 best(1.0, 0.0, 0.0);
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const Vec2 &from = t[static_cast<std::size_t>(i)], &to = t[static_cast<std::size_t>((i + 1) % 3)];
    const double length2 = glm::dot(to - from, to - from);
    const double share = length2 > 0.0 ? std::clamp(glm::dot(point - from, to - from) / length2, 0.0, 1.0) : 0.0;
    const Vec2 gap = from + share * (to - from) - point;
    if (const double distance2 = glm::dot(gap, gap); distance2 < least) {
      least = distance2;
      best = Vec3(0.0);
      best[i] = 1.0 - share;
      best[(i + 1) % 3] = share;
    }
  }
  return best;
}

/// The triangle's point that a texel shows.
struct TexelPlace {
  double distance2 = std::numeric_limits<double>::infinity();  // of the texel's centre, in texels
  SurfaceSample sample;
};

void place_texels(const ChartDraft& chart, const TriangleCorners& corners, std::span<const Vec3> offsets, std::vector<TexelPlace>& places) {
  const std::array<Vec2, 3> t{chart.texels[corners[0]], chart.texels[corners[1]], chart.texels[corners[2]]};
  const std::array<Vec3, 3> p{offsets[corners[0]], offsets[corners[1]], offsets[corners[2]]};
  const Vec3 normal = unit_normal(p);
  const Vec2 low = glm::max(glm::floor(glm::min(t[0], glm::min(t[1], t[2])) - kReachTexels), Vec2(0.0));
  const Vec2 high = glm::min(glm::ceil(glm::max(t[0], glm::max(t[1], t[2])) + kReachTexels), Vec2(chart.width, chart.height));
  for (auto y = static_cast<std::uint32_t>(low.y); y < high.y; ++y)
    for (auto x = static_cast<std::uint32_t>(low.x); x < high.x; ++x) {
      const Vec2 centre(x + 0.5, y + 0.5);
      const Vec3 b = nearest_barycentric(t, centre);
      const Vec2 gap = b.x * t[0] + b.y * t[1] + b.z * t[2] - centre;
      TexelPlace& place = places[std::size_t{y} * chart.width + x];
      if (const double distance2 = glm::dot(gap, gap); distance2 < place.distance2)
        place = {distance2, {b.x * p[0] + b.y * p[1] + b.z * p[2], normal}};
    }
}

}  // namespace

void append_chart(const ChartDraft& draft, std::span<const Vec3> offset_of_vertex, const SampleColour& colour, TexturedMesh& mesh,
                  std::vector<std::uint8_t>& texels) {
  std::vector<Vec3> offsets;
  for (const std::uint32_t v : draft.vertices) offsets.push_back(offset_of_vertex[v]);
  mesh.charts.push_back({draft.width, draft.height, static_cast<std::uint32_t>(mesh.vertices.size()),
                         static_cast<std::uint32_t>(draft.vertices.size()), static_cast<std::uint32_t>(mesh.indices.size()),
                         static_cast<std::uint32_t>(3 * draft.triangles.size())});
  std::vector<TexelPlace> places(std::size_t{draft.width} * draft.height);
  for (const TriangleCorners& corners : draft.triangles) {
    place_texels(draft, corners, offsets, places);
    mesh.indices.insert(mesh.indices.end(), corners.begin(), corners.end());
  }
  for (std::size_t i = 0; i < offsets.size(); ++i) mesh.vertices.push_back({offsets[i], draft.texels[i]});
  for (const TexelPlace& place : places) {
    const bool filled = place.distance2 <= kReachTexels * kReachTexels;
    const auto rgba = filled ? colour(place.sample) : std::array<std::uint8_t, 4>{0, 0, 0, 0};
    texels.insert(texels.end(), rgba.begin(), rgba.end());
  }
}

}  // namespace standin
