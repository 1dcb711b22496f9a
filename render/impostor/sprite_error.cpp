#include "render/impostor/sprite_error.h"

#include "render/view/view_cell.h"

namespace standin {
namespace {

constexpr int kBins = 96;  // a side
constexpr double kRounding = 1e-9;

}  // namespace

std::optional<double> ray_meets(const std::array<Vec3, 3>& t, const Vec3& point) {
  const Vec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double along = glm::dot(n, point);
  if (along == 0.0) return std::nullopt;
  const Vec3 weights(glm::dot(point, glm::cross(t[1], t[2])), glm::dot(point, glm::cross(t[2], t[0])),
                     glm::dot(point, glm::cross(t[0], t[1])));
  const double sum = weights.x + weights.y + weights.z;
  const double least = std::min({weights.x / sum, weights.y / sum, weights.z / sum});
  return least >= -kRounding ? std::optional(glm::dot(n, t[0]) / along) : std::nullopt;
}

double apparent_angle(const Vec3& viewpoint, const Vec3& a, const Vec3& b) {
  return std::atan2(glm::length(glm::cross(a - viewpoint, b - a)), glm::dot(a - viewpoint, b - viewpoint));  // a x b = a x (b - a)
}

double apparent_angle(std::span<const Vec3> viewpoints, const Vec3& a, const Vec3& b) {
  double worst = 0.0;
  for (const Vec3& viewpoint : viewpoints) worst = std::max(worst, apparent_angle(viewpoint, a, b));
  return worst;
}

bool appears_within(std::span<const Vec3> viewpoints, const Vec3& a, const Vec3& b, double limit_rad) {
  const double tangent = std::tan(std::min(limit_rad, 1.5));
  return std::all_of(viewpoints.begin(), viewpoints.end(), [&](const Vec3& viewpoint) {
    const double along = glm::dot(a - viewpoint, b - viewpoint);
    const Vec3 across = glm::cross(a - viewpoint, b - a);
    return along > 0.0 && glm::dot(across, across) < tangent * tangent * along * along;
  });
}

SpriteError::SpriteError(std::vector<std::array<Vec3, 3>> coarse, const Vec3& forward, std::span<const Vec3> viewpoints)
    : coarse_(std::move(coarse)), tree_(coarse_), forward_(forward), viewpoints_(viewpoints), bins_(std::size_t{kBins} * kBins) {
  const Shaft axes = shaft_frame(Vec3(0.0), -forward);
  right_ = axes.right;
  up_ = axes.up;
  for (const auto& t : coarse_)
    for (const Vec3& corner : t) {
      low_ = glm::min(low_, slope(corner));
      high_ = glm::max(high_, slope(corner));
    }
  for (std::uint32_t i = 0; i < coarse_.size(); ++i) {
    const std::array<Vec2, 3> s{slope(coarse_[i][0]), slope(coarse_[i][1]), slope(coarse_[i][2])};
    const auto low = bin_of(glm::min(s[0], glm::min(s[1], s[2]))), high = bin_of(glm::max(s[0], glm::max(s[1], s[2])));
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) bins_[static_cast<std::size_t>(y * kBins + x)].push_back(i);
  }
}

std::array<int, 2> SpriteError::bin_of(const Vec2& slope) const {
  const Vec2 size = glm::max(high_ - low_, Vec2(1e-300));
  const Vec2 place = glm::clamp(glm::floor((slope - low_) / size * double{kBins}), Vec2(0.0), Vec2(kBins - 1.0));
  return {static_cast<int>(place.x), static_cast<int>(place.y)};
}

bool SpriteError::within(std::span<const Vec3> points, double limit_rad) const {
  if (coarse_.empty()) return points.empty();
  return std::all_of(points.begin(), points.end(), [&](const Vec3& point) { return is_within(point, limit_rad); });
}

bool SpriteError::is_within(const Vec3& point, double limit_rad) const {
  double nearest_viewer_m = std::numeric_limits<double>::infinity();
  for (const Vec3& viewpoint : viewpoints_) nearest_viewer_m = std::min(nearest_viewer_m, glm::length(point - viewpoint));
  const auto nearest = tree_.nearest(point, 2.0 * limit_rad * nearest_viewer_m);  // farther, it may be right along the ray alone
  if (nearest && appears_within(viewpoints_, point, nearest->point, limit_rad)) return true;
  return is_within_along_ray(point, limit_rad);
}

bool SpriteError::is_within_along_ray(const Vec3& point, double limit_rad) const {
  const auto bin = bin_of(slope(point));
  const auto& candidates = bins_[static_cast<std::size_t>(bin[1] * kBins + bin[0])];
  return std::any_of(candidates.begin(), candidates.end(), [&](std::uint32_t i) {
    const auto share = ray_meets(coarse_[i], point);
    return share && appears_within(viewpoints_, point, *share * point, limit_rad);
  });
}

}  // namespace standin
