#include "render/impostor/visible_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/impostor/slab_piece.h"

namespace standin {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFarCorners = 4.0;       // of a shaft: times its least distance
constexpr double kDepthTexels = 2.0;      // a surface does not hide itself
constexpr double kFiner = 2.0;            // texels, than the impostor's
constexpr double kLargestImage = 4096.0;  // texels a side

/// visit(x, y, barycentric) for texels of an image of width x height until it returns false; whether it never did. Barycentric coordinates
/// are those on the image.
template <class Visit>
bool for_each_texel(const std::array<Vec2, 3>& t, std::uint32_t width, std::uint32_t height, const Visit& visit) {
  const auto cross = [](const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; };
  const double area = cross(t[1] - t[0], t[2] - t[0]);
  if (area == 0.0) return true;
  const Vec2 low = glm::max(glm::floor(glm::min(t[0], glm::min(t[1], t[2]))), Vec2(0.0));
  const Vec2 high = glm::min(glm::ceil(glm::max(t[0], glm::max(t[1], t[2]))), Vec2(width, height));
  for (double y = low.y; y < high.y; y += 1.0)
    for (double x = low.x; x < high.x; x += 1.0) {
      const Vec2 at(x + 0.5, y + 0.5);
      const Vec3 b = Vec3(cross(t[1] - at, t[2] - at), cross(t[2] - at, t[0] - at), cross(t[0] - at, t[1] - at)) / area;
      if (std::min({b.x, b.y, b.z}) < 0.0) continue;
      if (!visit(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), b)) return false;
    }
  return true;
}

std::vector<Vec3> sampled_viewpoints(const ViewCell& cell, const Vec3& reference_viewpoint) {
  std::vector<Vec3> viewpoints = corner_viewpoints(cell, reference_viewpoint);
  if (const auto* shaft = std::get_if<Shaft>(&cell)) {
    Shaft far_part = *shaft;
    far_part.min_distance_m *= kFarCorners;
    for (const Vec3& corner : corner_viewpoints(far_part, reference_viewpoint)) viewpoints.push_back(corner);
  }
  viewpoints.emplace_back(0.0);
  return viewpoints;
}

/// A triangle as one viewpoint sees it.
struct SeenTriangle {
  std::array<Vec2, 3> texels;
  std::array<double, 3> depths_m{};
  bool faces = false;  // or is double-sided
};

class DepthImage {
 public:
  DepthImage(const Scene& scene, const std::vector<SurfaceTriangle>& surface, const ImpostorFrame& frame, const Vec3& viewpoint)
      : frame_(frame) {
    fit_to(surface, viewpoint);
    for (const SurfaceTriangle& triangle : surface) {
      triangles_.push_back(seen(triangle, viewpoint));
      triangles_.back().faces =
          scene.materials[triangle.material].double_sided || glm::dot(unit_normal(triangle.corners), viewpoint - triangle.corners[0]) > 0.0;
    }
    depth_m_.assign(std::size_t{frame_.width} * frame_.height, kInfinity);
    for (const SeenTriangle& triangle : triangles_)
      if (triangle.faces) draw(triangle);
  }

  [[nodiscard]] bool shows(std::size_t index) const {
    const SeenTriangle& t = triangles_[index];
    if (!t.faces) return false;
    if (is_in_front((t.texels[0] + t.texels[1] + t.texels[2]) / 3.0, depth_at(t, Vec3(1.0 / 3.0)))) return true;
    return !for_each_texel(t.texels, frame_.width, frame_.height,
                           [&](std::uint32_t x, std::uint32_t y, const Vec3& b) { return !is_in_front(Vec2(x, y) + 0.5, depth_at(t, b)); });
  }

 private:
  [[nodiscard]] Vec2 slope_of(const Vec3& way) const {
    return Vec2(glm::dot(way, frame_.right), glm::dot(way, frame_.up)) / glm::dot(way, frame_.forward);
  }

  void fit_to(const std::vector<SurfaceTriangle>& surface, const Vec3& viewpoint) {
    Vec2 low(kInfinity), high(-kInfinity);
    for (const SurfaceTriangle& triangle : surface)
      for (const Vec3& corner : triangle.corners) {
        const Vec2 slope = slope_of(corner - viewpoint);
        low = glm::min(low, slope);
        high = glm::max(high, slope);
      }
    frame_.slope_step = glm::max(frame_.slope_step / kFiner, (high - low) / kLargestImage);
    frame_.slope_min = {low.x, high.y};
    const Vec2 texels = glm::max(glm::ceil((high - low) / frame_.slope_step), Vec2(1.0));
    frame_.width = static_cast<std::uint32_t>(texels.x);
    frame_.height = static_cast<std::uint32_t>(texels.y);
  }

  [[nodiscard]] SeenTriangle seen(const SurfaceTriangle& triangle, const Vec3& viewpoint) const {
    SeenTriangle result;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 way = triangle.corners[k] - viewpoint;
      result.texels[k] = texel_from_slope(frame_, slope_of(way));
      result.depths_m[k] = glm::dot(way, frame_.forward);
    }
    return result;
  }

  [[nodiscard]] static double depth_at(const SeenTriangle& t, const Vec3& b) {
    return 1.0 / (b.x / t.depths_m[0] + b.y / t.depths_m[1] + b.z / t.depths_m[2]);
  }

  void draw(const SeenTriangle& t) {
    for_each_texel(t.texels, frame_.width, frame_.height, [&](std::uint32_t x, std::uint32_t y, const Vec3& b) {
      double& depth = depth_m_[std::size_t{y} * frame_.width + x];
      depth = std::min(depth, depth_at(t, b));
      return true;
    });
  }

  [[nodiscard]] std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * frame_.width + static_cast<std::size_t>(x); }

  [[nodiscard]] bool is_in_front(const Vec2& texel, double depth_m) const {
    const Vec2 place = glm::clamp(glm::floor(texel), Vec2(0.0), Vec2(frame_.width - 1.0, frame_.height - 1.0));
    return depth_m <= depth_m_[at(static_cast<int>(place.x), static_cast<int>(place.y))] * (1.0 + kDepthTexels * frame_.slope_step.x);
  }

  ImpostorFrame frame_;
  std::vector<SeenTriangle> triangles_;
  std::vector<double> depth_m_;
};

}  // namespace

std::vector<SurfaceTriangle> visible_surface(const Scene& scene, const std::vector<SurfaceTriangle>& surface, const ViewCell& cell,
                                             const ImpostorFrame& frame, const WorkBudget& budget) {
  std::vector<bool> seen(surface.size(), false);
  if (surface.empty()) return surface;
  for (const Vec3& viewpoint : sampled_viewpoints(cell, frame.reference_viewpoint)) {
    budget.check();
    const DepthImage image(scene, surface, frame, viewpoint);
    for (std::size_t i = 0; i < surface.size(); ++i)
      if (!seen[i]) seen[i] = image.shows(i);
  }
  std::vector<SurfaceTriangle> visible;
  for (std::size_t i = 0; i < surface.size(); ++i)
    if (seen[i]) visible.push_back(surface[i]);
  return visible.empty() ? surface : visible;
}

}  // namespace standin
