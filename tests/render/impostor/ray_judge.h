// The promise of an impostor, judged by rays alone (definitions of gap pixel and parallax ratio): brute force over the original
// triangles on one side, the impostor's quads as they would be drawn on the other. Shares no code with the baker.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "render/impostor/impostor.h"
#include "tests/render/impostor/small_scene.h"

namespace standin::test {

struct Surface {
  WorldTriangle corners;
  std::array<Vec2, 3> uvs{Vec2(0.0), Vec2(0.0), Vec2(0.0)};
  const Texture* mask = nullptr;  // opaque where the nearest texel's alpha is at least half
};

[[nodiscard]] inline std::vector<Surface> opaque_surfaces(const std::vector<WorldTriangle>& triangles) {
  std::vector<Surface> surfaces;
  for (const WorldTriangle& triangle : triangles) surfaces.push_back({triangle});
  return surfaces;
}

[[nodiscard]] inline bool passes(const Texture& mask, const Vec2& uv) {
  const Vec2 wrapped = uv - glm::floor(uv);
  const int x = std::min(static_cast<int>(wrapped.x * mask.width), mask.width - 1);
  const int y = std::min(static_cast<int>(wrapped.y * mask.height), mask.height - 1);
  return mask.rgba[4 * static_cast<std::size_t>(y * mask.width + x) + 3] >= 128;
}

/// Distance along the ray to the surface if it is hit (border included), from either side.
[[nodiscard]] inline std::optional<double> hit(const Surface& surface, const Vec3& origin, const Vec3& direction) {
  const WorldTriangle& t = surface.corners;
  const Vec3 e1 = t[1] - t[0], e2 = t[2] - t[0], p = glm::cross(direction, e2);
  const double det = glm::dot(e1, p);
  if (det == 0.0) return std::nullopt;
  const Vec3 s = origin - t[0], q = glm::cross(s, e1);
  const double u = glm::dot(s, p) / det, v = glm::dot(direction, q) / det, distance = glm::dot(e2, q) / det;
  if (u < 0.0 || v < 0.0 || u + v > 1.0 || distance <= 0.0) return std::nullopt;
  if (surface.mask != nullptr &&
      !passes(*surface.mask, surface.uvs[0] + u * (surface.uvs[1] - surface.uvs[0]) + v * (surface.uvs[2] - surface.uvs[0])))
    return std::nullopt;
  return distance;
}

[[nodiscard]] inline std::optional<double> first_hit(const std::vector<Surface>& surfaces, const Vec3& origin, const Vec3& direction) {
  std::optional<double> nearest;
  for (const Surface& surface : surfaces)
    if (const auto distance = hit(surface, origin, direction); distance && (!nearest || *distance < *nearest)) nearest = distance;
  return nearest;
}

/// An impostor's layers as dense images.
class DrawnImpostor {
 public:
  explicit DrawnImpostor(const Impostor& impostor) : impostor_(impostor) {
    const std::size_t texels = std::size_t{impostor.frame.width} * impostor.frame.height;
    images_.resize(impostor.layers.size());
    std::size_t next = 0;
    for (const Quad& quad : impostor.quads) {
      auto& image = images_[quad.layer];
      image.resize(texels);
      for (std::uint32_t y = 0; y < quad.height; ++y)
        for (std::uint32_t x = 0; x < quad.width; ++x, next += 4)
          if (impostor.texels[next + 3] != 0) {
            auto& texel = image[std::size_t{quad.y + y} * impostor.frame.width + quad.x + x];
            duplicates_ += texel[3] != 0;
            std::copy_n(impostor.texels.begin() + static_cast<std::ptrdiff_t>(next), 4, texel.begin());
          }
    }
  }

  struct Hit {
    double distance = 0.0;  // in units of the direction's length
    std::size_t layer = 0;
    Vec3 point{0.0};
    std::array<std::uint8_t, 4> rgba{0, 0, 0, 0};
  };
  [[nodiscard]] std::optional<Hit> trace(const Vec3& origin, const Vec3& direction) const {
    const ImpostorFrame& f = impostor_.frame;
    const double speed = glm::dot(direction, f.forward), start = glm::dot(origin - f.reference_viewpoint, f.forward);
    for (std::size_t layer = 0; layer < images_.size() && speed > 0.0; ++layer) {  // every layer lies beyond the view cell
      const double depth = impostor_.layers[layer].distance_m, distance = (depth - start) / speed;
      const Vec3 point = origin + distance * direction, offset = point - f.reference_viewpoint;
      const double x = std::floor((glm::dot(offset, f.right) / depth - f.slope_min.x) / f.slope_step.x);
      const double y = std::floor((f.slope_min.y - glm::dot(offset, f.up) / depth) / f.slope_step.y);
      if (images_[layer].empty() || x < 0.0 || y < 0.0 || x >= f.width || y >= f.height) continue;
      const auto& texel = images_[layer][static_cast<std::size_t>(y) * f.width + static_cast<std::size_t>(x)];
      if (texel[3] != 0) return Hit{distance, layer, point, texel};
    }
    return std::nullopt;
  }
  [[nodiscard]] std::array<std::uint8_t, 4> texel(std::size_t layer, std::uint32_t x, std::uint32_t y) const {
    return images_[layer].empty() ? std::array<std::uint8_t, 4>{0, 0, 0, 0} : images_[layer][std::size_t{y} * impostor_.frame.width + x];
  }
  /// Opaque texels that more than one quad shows.
  [[nodiscard]] int duplicates() const { return duplicates_; }

 private:
  const Impostor& impostor_;
  std::vector<std::vector<std::array<std::uint8_t, 4>>> images_;
  int duplicates_ = 0;
};

struct Verdict {
  int judged = 0;  // pixels whose whole disc the original covers
  int gaps = 0;
  int parallax_judged = 0;
  double worst_parallax = 0.0;  // over alpha
};

/// One pixel: the ray from `viewpoint` along `direction`.
inline void judge_pixel(const std::vector<Surface>& original, const Impostor& impostor, const DrawnImpostor& drawn, const Vec3& viewpoint,
                        const Vec3& direction, double pixel_rad, Verdict& verdict) {
  const Vec3 d = glm::normalize(direction);
  const Vec3 side = glm::normalize(glm::cross(d, std::abs(d.y) < 0.9 ? Vec3(0, 1, 0) : Vec3(1, 0, 0))), other = glm::cross(side, d);
  double farthest = 0.0;
  for (const double radius : {0.0, 0.5, 1.0, 1.5, 2.0})
    for (int i = 0; i < (radius == 0.0 ? 1 : 16); ++i) {
      const double angle = i * 0.39269908169872414, r = radius * pixel_rad;
      const auto distance = first_hit(original, viewpoint, d + r * (std::cos(angle) * side + std::sin(angle) * other));
      if (!distance) return;
      farthest = std::max(farthest, *distance);
    }
  ++verdict.judged;
  const auto shown = drawn.trace(viewpoint, d);
  const ImpostorFrame& f = impostor.frame;
  const auto thickness = [&](std::size_t layer) {
    return (impostor.layers[layer].far_m - impostor.layers[layer].near_m) / glm::dot(d, f.forward);
  };
  if (!shown || shown->distance > farthest + thickness(shown->layer) + 1e-9) {
    ++verdict.gaps;
    return;
  }
  const Layer& layer = impostor.layers[shown->layer];
  const Vec3 from_reference = (shown->point - f.reference_viewpoint) / layer.distance_m;  // per unit of depth
  for (const Surface& surface : original) {
    const auto depth = hit(surface, f.reference_viewpoint, from_reference);
    if (!depth || *depth < layer.near_m - 1e-9 || *depth > layer.far_m + 1e-9) continue;
    const Vec3 x = f.reference_viewpoint + *depth * from_reference - viewpoint, q = shown->point - viewpoint;
    const double angle = std::atan2(glm::length(glm::cross(x, q)), glm::dot(x, q));
    ++verdict.parallax_judged;
    verdict.worst_parallax = std::max(verdict.worst_parallax, angle / pixel_rad);
  }
}

/// A viewpoint of the cell; shafts are sampled to four times their minimum distance, corners and borders as often as the inside.
[[nodiscard]] inline Vec3 random_viewpoint(Rng& rng, const ViewCell& cell) {
  const auto share = [&] {
    const double x = rng.uniform(-0.5, 1.5);
    return std::clamp(x, 0.0, 1.0);
  };
  if (const auto* box = std::get_if<Box>(&cell)) {
    const double x = share(), y = share();
    return box->min + Vec3(x, y, share()) * box->size();
  }
  const Shaft& shaft = std::get<Shaft>(cell);
  const double distance = shaft.min_distance_m * (1.0 + 3.0 * share());
  const double x = (2.0 * share() - 1.0) * shaft.tan_half.x, y = (2.0 * share() - 1.0) * shaft.tan_half.y;
  return shaft.apex + distance * (shaft.axis + x * shaft.right + y * shaft.up);
}

/// visit(viewpoint, direction) for rays from random viewpoints of the cell to random points of the original.
template <class Visit>
void for_each_random_ray(const std::vector<Surface>& original, const ViewCell& cell, int rays, Rng rng, const Visit& visit) {
  for (int i = 0; i < rays; ++i) {
    const WorldTriangle& t = original[rng.below(original.size())].corners;
    double u = rng.uniform(), v = rng.uniform();
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    const Vec3 viewpoint = random_viewpoint(rng, cell), target = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
    visit(viewpoint, target - viewpoint);
  }
}

/// Rays from random viewpoints of the cell to random points of the original.
[[nodiscard]] inline Verdict judge(const std::vector<Surface>& original, const Impostor& impostor, double pixel_rad, int rays,
                                   std::uint64_t seed) {
  const DrawnImpostor drawn(impostor);
  Verdict verdict;
  for_each_random_ray(original, impostor.view_cell, rays, Rng(seed, 77), [&](const Vec3& viewpoint, const Vec3& direction) {
    judge_pixel(original, impostor, drawn, viewpoint, direction, pixel_rad, verdict);
  });
  return verdict;
}

}  // namespace standin::test
