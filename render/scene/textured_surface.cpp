#include "render/scene/textured_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace standin {
namespace {

// Triangles stretched more, in medians of their mesh, are kept as they are.
constexpr double kMostStretch = 8.0;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

auto as_tuple(const SurfacePoint& p) {
  return std::tie(p.place.x, p.place.y, p.place.z, p.texture.x, p.texture.y);
}

bool before(const SurfacePoint& a, const SurfacePoint& b) {
  return as_tuple(a) < as_tuple(b);
}

bool same(const SurfacePoint& a, const SurfacePoint& b) {
  return as_tuple(a) == as_tuple(b);
}

/// An edge at most: nothing to see, and none that a simplifier keeps.
bool is_flat(const SurfaceTriangle& t) {
  return same(t[0], t[1]) || same(t[1], t[2]) || same(t[2], t[0]);
}

/// Points that agree are one.
Surface surface_over(const std::vector<SurfaceTriangle>& triangles) {
  Surface surface;
  for (const SurfaceTriangle& corners : triangles) surface.points.insert(surface.points.end(), corners.begin(), corners.end());
  std::ranges::sort(surface.points, before);
  surface.points.erase(std::unique(surface.points.begin(), surface.points.end(), same), surface.points.end());
  const auto number = [&](const SurfacePoint& point) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(surface.points, point, before) - surface.points.begin());
  };
  for (const auto& [a, b, c] : triangles) surface.triangles.push_back({number(a), number(b), number(c)});
  return surface;
}

bool is_finite(const Mesh& mesh) {
  const auto finite = [](const auto& v) { return 0.0F * v == decltype(0.0F * v)(0.0F); };  // 0 times anything else is no number
  return std::ranges::all_of(mesh.positions, finite) && std::ranges::all_of(mesh.uvs, finite);
}

std::uint64_t pieces_for(std::size_t triangles, double pieces_per_triangle) {
  return static_cast<std::uint64_t>(pieces_per_triangle * static_cast<double>(triangles));
}

}  // namespace

// The greatest singular value of the map from coordinates to places.
double metres_per_uv(const std::array<Vec3, 3>& places, const std::array<Vec2, 3>& uvs) {
  const Vec3 e = places[1] - places[0], f = places[2] - places[0];
  const Vec2 p = uvs[1] - uvs[0], q = uvs[2] - uvs[0];
  const double determinant = p.x * q.y - p.y * q.x;
  if (determinant == 0.0) return kInfinity;
  const Vec3 along_u = (q.y * e - p.y * f) / determinant, along_v = (p.x * f - q.x * e) / determinant;
  const double uu = glm::dot(along_u, along_u), vv = glm::dot(along_v, along_v), uv = glm::dot(along_u, along_v);
  return std::sqrt(0.5 * (uu + vv) + std::hypot(0.5 * (uu - vv), uv));
}

std::vector<bool> worn_with_texture(const Scene& scene) {
  std::vector<bool> textured(scene.meshes.size(), false);
  for (const Part& part : scene.parts)
    if (scene.materials[part.material].texture >= 0) textured[part.mesh] = true;
  return textured;
}

TexturedSurface::TexturedSurface(const Mesh& mesh, bool textured)
    : textured_(textured && !mesh.uvs.empty()), kept_(mesh.triangle_count(), false) {
  if (textured_) measure_stretch(mesh);
  for (std::size_t t = 0; t < kept_.size(); ++t)
    if (kept_[t]) kept_keys_.push_back(ComparedSurface::key_of(corners_of(mesh, t, 1.0)));
  std::ranges::sort(kept_keys_);
  groups_ = groups_of(mesh, kept_);
}

TexturedSurface::Colour TexturedSurface::colour_of(const Mesh& mesh, std::size_t t) const {
  if (!textured_) return std::nullopt;
  const glm::vec2 first = mesh.uvs[mesh.indices[3 * t]];
  for (std::size_t c = 1; c < 3; ++c)
    if (mesh.uvs[mesh.indices[3 * t + c]] != first) return std::nullopt;
  return std::array{first.x, first.y};
}

void TexturedSurface::measure_stretch(const Mesh& mesh) {
  std::vector<double> stretch(kept_.size(), 0.0), finite;
  for (std::size_t t = 0; t < stretch.size(); ++t) {
    const SurfaceTriangle corners = corners_of(mesh, t, 1.0);
    if (colour_of(mesh, t) || is_flat(corners)) continue;
    const auto& [a, b, c] = corners;
    stretch[t] = metres_per_uv({a.place, b.place, c.place}, {a.texture, b.texture, c.texture});
    if (std::isfinite(stretch[t])) finite.push_back(stretch[t]);
  }
  double most = 0.0;
  if (!finite.empty()) {
    const auto median = finite.begin() + static_cast<std::ptrdiff_t>(finite.size() / 2);
    std::ranges::nth_element(finite, median);
    most = kMostStretch * *median;
  }
  for (std::size_t t = 0; t < stretch.size(); ++t) {
    kept_[t] = !(stretch[t] <= most);
    if (!kept_[t]) metres_per_uv_ = std::max(metres_per_uv_, stretch[t]);
  }
}

SurfaceTriangle TexturedSurface::corners_of(const Mesh& mesh, std::size_t t, double metres_per_uv) const {
  SurfaceTriangle corners;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::uint32_t v = mesh.indices[3 * t + c];
    corners[c] = {mesh.positions[v], textured_ ? metres_per_uv * Vec2(mesh.uvs[v]) : Vec2(0.0)};
  }
  return corners;
}

TexturedSurface::Groups TexturedSurface::groups_of(const Mesh& mesh, const std::vector<bool>& left_out) const {
  std::map<Colour, std::vector<SurfaceTriangle>> triangles;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (left_out[t] || is_flat(corners_of(mesh, t, 1.0))) continue;
    const Colour colour = colour_of(mesh, t);
    triangles[colour].push_back(corners_of(mesh, t, colour ? 0.0 : metres_per_uv_));
  }
  Groups groups;
  for (const auto& [colour, of_colour] : triangles) groups.emplace(colour, ComparedSurface(surface_over(of_colour)));
  return groups;
}

/// Whether all that must be is there; sets `held` for each triangle of `simple` that is one of these.
bool TexturedSurface::holds_kept(const Mesh& simple, std::vector<bool>& held) const {
  std::vector<bool> found(kept_keys_.size(), false);
  for (std::size_t t = 0; t < held.size() && !kept_keys_.empty(); ++t) {
    const auto [begin, end] = std::equal_range(kept_keys_.begin(), kept_keys_.end(), ComparedSurface::key_of(corners_of(simple, t, 1.0)));
    held[t] = begin != end;
    for (auto key = begin; key != end; ++key) found[static_cast<std::size_t>(key - kept_keys_.begin())] = true;
  }
  return std::ranges::find(found, false) == found.end();
}

Deviation TexturedSurface::deviation_of(const Mesh& simple, DeviationLimits limits, double pieces_per_triangle) const {
  const Deviation infinite{kInfinity, kInfinity, 0};
  std::vector<bool> held(simple.triangle_count(), false);
  if ((textured_ && simple.uvs.empty()) || !is_finite(simple) || !holds_kept(simple, held)) return infinite;
  const Groups others = groups_of(simple, held);
  if (others.size() != groups_.size()) return infinite;
  Deviation all;
  for (const auto& [colour, own] : groups_) {
    const auto other = others.find(colour);
    if (other == others.end()) return infinite;
    limits.pieces = pieces_for(own.triangle_count() + other->second.triangle_count(), pieces_per_triangle);
    const Deviation one = own.deviation_both_ways(other->second, limits);
    all = {std::max(all.bound_m, one.bound_m), std::max(all.found_m, one.found_m), all.pieces + one.pieces};
    if (all.bound_m > limits.refuted_m) break;
  }
  return all;
}

}  // namespace standin
