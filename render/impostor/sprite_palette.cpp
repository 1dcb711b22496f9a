#include "render/impostor/sprite_palette.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "render/impostor/cluster_surface.h"

namespace standin {
namespace {

constexpr int kSameLevels = 4;         // of 255, in each channel
constexpr double kMostSamples = 64.0;  // along an edge

using Rgba = std::array<std::uint8_t, 4>;

double longest_edge_texels(const SimplifiedDepthMesh& on_lattice, const TriangleCorners& t) {
  double longest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const LatticeVertex &from = on_lattice.vertices[t[i]], &to = on_lattice.vertices[t[(i + 1) % 3]];
    longest = std::max(longest, 0.5 * glm::length(Vec3(to.x - from.x, to.y - from.y, to.depth - from.depth)));
  }
  return longest;
}

bool alike(const Rgba& a, const Rgba& b) {
  for (std::size_t i = 0; i < 4; ++i)
    if (std::abs(int{a[i]} - int{b[i]}) > kSameLevels) return false;
  return true;
}

PlainColour plain_colour(const std::array<Vec3, 3>& corners, int steps, const SampleColour& colour) {
  const Vec3 normal = unit_normal(corners);
  const auto at = [&](const Vec3& b) { return colour({b.x * corners[0] + b.y * corners[1] + b.z * corners[2], normal}); };
  const Rgba middle = at(Vec3(1.0 / 3.0));
  for (int i = 0; i < steps; ++i)
    for (int j = 0; i + j < steps; ++j) {  // middles of the upright ones of steps^2 equal triangles
      const double x = (i + 1.0 / 3.0) / steps, y = (j + 1.0 / 3.0) / steps;
      if (steps > 1 && !alike(at({x, y, 1.0 - x - y}), middle)) return std::nullopt;
    }
  return middle;
}

/// Each colour's place, in the order of its first triangle.
std::map<Rgba, std::uint32_t> places_of(std::span<const PlainColour> plain) {
  std::map<Rgba, std::uint32_t> places;
  for (const PlainColour& colour : plain)
    if (colour) places.emplace(*colour, static_cast<std::uint32_t>(places.size()));
  return places;
}

}  // namespace

std::vector<PlainColour> plain_colours(const SpriteMesh& mesh, const SimplifiedDepthMesh& on_lattice, const SampleColour& colour,
                                       const WorkBudget& budget) {
  std::vector<PlainColour> plain;
  for (const TriangleCorners& t : mesh.triangles) {
    budget.check();
    const double steps = std::clamp(std::ceil(longest_edge_texels(on_lattice, t)), 1.0, kMostSamples);
    plain.push_back(plain_colour({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]}, static_cast<int>(steps), colour));
  }
  return plain;
}

void append_palette(const SpriteMesh& mesh, std::span<const PlainColour> plain, TexturedMesh& chart, std::vector<std::uint8_t>& texels) {
  const std::map<Rgba, std::uint32_t> places = places_of(plain);
  if (places.empty()) return;
  const auto width = static_cast<std::uint32_t>(std::ceil(std::sqrt(places.size())));
  const auto height = static_cast<std::uint32_t>((places.size() + width - 1) / width);
  Chart added{width, height, static_cast<std::uint32_t>(chart.vertices.size()), 0, static_cast<std::uint32_t>(chart.indices.size()), 0};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> corner_at;  // by vertex and place
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!plain[t]) continue;
    const std::uint32_t place = places.at(*plain[t]);
    for (const std::uint32_t v : mesh.triangles[t]) {
      const auto [at, fresh] = corner_at.try_emplace({v, place}, added.vertex_count);
      if (fresh) chart.vertices.push_back({mesh.vertices[v], Vec2(place % width, place / width) + 0.5});
      added.vertex_count += fresh ? 1 : 0;
      chart.indices.push_back(at->second);
      ++added.index_count;
    }
  }
  chart.charts.push_back(added);
  const std::size_t first = texels.size();
  texels.resize(first + std::size_t{4} * width * height, 0);
  for (const auto& [rgba, place] : places)
    std::copy(rgba.begin(), rgba.end(), texels.begin() + static_cast<std::ptrdiff_t>(first + 4 * place));
}

}  // namespace standin
