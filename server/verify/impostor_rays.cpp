#include "server/verify/impostor_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/visibility/raytracer.h"
#include "server/verify/pixel_rays.h"
#include "server/verify/silhouette.h"
#include "server/verify/triangle_caster.h"

namespace standin {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();
// Of float ray distances; borders of depth ranges are blurred by this share.
constexpr double kDistanceTolerance = 1e-6;
// Vertices are float: triangles are taken for parallel to their layer within this share of the depth.
constexpr double kDepthTolerance = 1e-5;

// Distances along pixel rays to the original, for a window and the discs of its pixels.
class OriginalImage {
 public:
  OriginalImage(const Raytracer& raytracer, const View& view, const PixelRays& rays, const PixelWindow& window)
      : x0_(window.x0 - kDiscRadius_px), y0_(window.y0 - kDiscRadius_px), width_(window.x1 - x0_ + kDiscRadius_px) {
    for (int y = y0_; y < window.y1 + kDiscRadius_px; ++y)
      for (int x = x0_; x < window.x1 + kDiscRadius_px; ++x) {
        const auto hit = raytracer.nearest(view.position, rays.direction(x, y));
        distances_.push_back(hit ? hit->distance_m : kNowhere);
      }
  }
  [[nodiscard]] bool covers(int x, int y) const { return at(x, y) < kNowhere; }
  /// Of the pixels within the disc; infinity where one of them is not covered.
  [[nodiscard]] double farthest_in_disc(int x, int y) const {
    double farthest = 0.0;
    for (int dy = -kDiscRadius_px; dy <= kDiscRadius_px; ++dy)
      for (int dx = -kDiscRadius_px; dx <= kDiscRadius_px; ++dx)
        if (dx * dx + dy * dy <= kDiscRadius_px * kDiscRadius_px) farthest = std::max(farthest, at(x + dx, y + dy));
    return farthest;
  }

 private:
  [[nodiscard]] double at(int x, int y) const { return distances_[static_cast<std::size_t>((y - y0_) * width_ + x - x0_)]; }

  int x0_, y0_, width_;
  std::vector<double> distances_;
};

// Axes at the reference viewpoint. Seen from there a point is a slope (right and up per unit of depth) and a depth; which way is up does
// not matter.
struct ReferenceFrame {
  Vec3 origin{0.0};
  Vec3 forward{0.0};
  Vec3 right{0.0};
  Vec3 up{0.0};

  ReferenceFrame(const Vec3& viewpoint, const Vec3& direction) : origin(viewpoint), forward(direction) {
    const Shaft axes = shaft_frame(viewpoint, -direction);
    right = axes.right;
    up = axes.up;
  }
  [[nodiscard]] double depth(const Vec3& point) const { return glm::dot(point - origin, forward); }
  [[nodiscard]] Vec2 slope(const Vec3& point) const {
    return Vec2(glm::dot(point - origin, right), glm::dot(point - origin, up)) / depth(point);
  }
  [[nodiscard]] Vec3 point(const Vec2& slope, double depth_m) const {
    return origin + depth_m * (forward + slope.x * right + slope.y * up);
  }
};

// What a pixel shows, seen from the reference viewpoint.
struct ShownPoint {
  Vec3 point{0.0};
  double distance_m = 0.0;  // along the pixel's ray
  double depth_m = 0.0;
  Vec2 slope{0.0};
  Vec2 step_right{0.0};  // change of slope to the next texel of the row
  Vec2 step_up{0.0};     // and of the column, upwards
};

void check_depths(const JudgedImpostor& impostor, const GlbImpostor& shown, const ReferenceFrame& frame) {
  for (const auto& triangle : shown.triangles) {
    std::array<double, 3> depths{};
    for (std::size_t k = 0; k < 3; ++k) depths[k] = frame.depth(shown.origin + triangle.offsets[k]);
    const auto [low, high] = std::minmax({depths[0], depths[1], depths[2]});
    const bool flat = high - low <= kDepthTolerance * high;
    if (low > 0.0 && (flat || is_mesh(impostor.technique))) continue;
    throw Failure(ErrorWord::kFileBroken, "impostor GLB, node " + impostor.node + ": a triangle reaches from depth " + std::to_string(low) +
                                              " to " + std::to_string(high) +
                                              " m and is no part of a layer before the reference viewpoint");
  }
}

class Judge {
 public:
  Judge(const Scene& scene, const GlbQuads& quads, const JudgedImpostor& impostor, const Camera& camera,
        std::span<const AlphaSampling> samplings)
      : impostor_(impostor),
        camera_(camera),
        samplings_(samplings),
        original_(scene, impostor.objects, Raytracer::Options{}),
        caster_(quads, quads.impostor(impostor.node), std::ranges::find(samplings, AlphaSampling::kMipmapped) != samplings.end()),
        frame_(impostor.reference_viewpoint, impostor.forward) {
    const GlbImpostor& shown = quads.impostor(impostor.node);
    check_depths(impostor, shown, frame_);
    for (const std::uint32_t object : impostor.objects) bounds_.extend(scene.objects[object].bounds);
    for (const auto& triangle : shown.triangles)
      for (const Vec3& offset : triangle.offsets) bounds_.extend(shown.origin + offset);
    if (impostor.layers.empty() || !(impostor.alpha_rad > 0.0))
      throw Failure(ErrorWord::kInternal, impostor.node + ": layers and an angle above zero are needed to judge it");
  }

  /// Judgements of one view, one for each sampling.
  [[nodiscard]] std::vector<ImpostorJudgement> judge(const View& view) const {
    const PixelRays rays(view, camera_);
    const PixelWindow window = rays.window_of(bounds_);
    const OriginalImage original(original_, view, rays, window);
    std::vector<ImpostorJudgement> judgements;
    for (const AlphaSampling sampling : samplings_) judgements.push_back(judge(rays, window, original, sampling));
    return judgements;
  }

 private:
  [[nodiscard]] ImpostorJudgement judge(const PixelRays& rays, const PixelWindow& window, const OriginalImage& original,
                                        AlphaSampling sampling) const {
    CoverageImage before(window.x1 - window.x0, window.y1 - window.y0);
    CoverageImage after = before;
    ImpostorJudgement result;
    result.views = 1;
    for (int y = window.y0; y < window.y1; ++y)
      for (int x = window.x0; x < window.x1; ++x) {
        const PixelRay ray = rays.ray(x, y);
        const auto hit = caster_.first_opaque(ray, sampling);
        const auto shown = hit ? std::optional(seen_from_reference(*hit)) : std::nullopt;
        before.set(x - window.x0, y - window.y0, original.covers(x, y));
        after.set(x - window.x0, y - window.y0, shown.has_value());
        judge_gap(original.farthest_in_disc(x, y), ray, shown, result);
        if (shown) judge_parallax(ray.origin, *shown, result);
      }
    result.excess_pixels = excess_pixels(before, after);
    result.silhouette_px = silhouette_length_px(before);
    return result;
  }

  [[nodiscard]] ShownPoint seen_from_reference(const TriangleCaster::Shown& hit) const {
    ShownPoint shown{hit.point, hit.distance_m, frame_.depth(hit.point), frame_.slope(hit.point), Vec2(0.0), Vec2(0.0)};
    if (!is_mesh(impostor_.technique)) {
      const auto [along_row, down_column] = caster_.texel_steps(hit.triangle);
      shown.step_right = Vec2(glm::dot(along_row, frame_.right), glm::dot(along_row, frame_.up)) / shown.depth_m;
      shown.step_up = -Vec2(glm::dot(down_column, frame_.right), glm::dot(down_column, frame_.up)) / shown.depth_m;
    } else {
      shown.step_right = Vec2(impostor_.slope_step.x, 0.0);
      shown.step_up = Vec2(0.0, impostor_.slope_step.y);
    }
    return shown;
  }

  void judge_gap(double farthest_original_m, const PixelRay& ray, const std::optional<ShownPoint>& shown, ImpostorJudgement& result) const {
    if (farthest_original_m == kNowhere) return;
    ++result.pixels;
    if (!shown) {
      ++result.gap_pixels;
      return;
    }
    const Layer range = depth_range(shown->depth_m);
    const double along_ray = 1.0 / glm::dot(ray.direction, frame_.forward);  // the slab lies across forward, the ray may not
    const double allowed = (range.far_m - range.near_m) * along_ray + kDistanceTolerance * shown->distance_m;
    if (shown->distance_m - farthest_original_m > allowed) ++result.gap_pixels;
  }

  void judge_parallax(const Vec3& viewpoint, const ShownPoint& shown, ImpostorJudgement& result) const {
    ++result.shown_pixels;
    const auto depth = depth_shown(shown);
    if (!depth) {
      ++result.baseless_pixels;
      return;
    }
    const Vec3 to_shown = shown.point - viewpoint;
    const Vec3 to_original = frame_.point(shown.slope, *depth) - viewpoint;
    const double angle = std::atan2(glm::length(glm::cross(to_shown, to_original)), glm::dot(to_shown, to_original));
    result.max_parallax_ratio = std::max(result.max_parallax_ratio, angle / impostor_.alpha_rad);
  }

  // Depth of the original behind the texel: through the point itself, else on rings of up to one texel around it.
  [[nodiscard]] std::optional<double> depth_shown(const ShownPoint& shown) const {
    const Layer range = depth_range(shown.depth_m);
    if (const auto depth = depth_in_range(shown.slope, shown.depth_m, range)) return depth;
    for (const double ring : {0.25, 0.5, 0.75, 1.0})
      for (int i = 0; i < 8; ++i) {
        static constexpr std::array<int, 8> kX = {1, 0, -1, 0, 1, -1, -1, 1};
        static constexpr std::array<int, 8> kY = {0, 1, 0, -1, 1, 1, -1, -1};
        const Vec2 offset = static_cast<double>(kX.at(static_cast<std::size_t>(i))) * shown.step_right +
                            static_cast<double>(kY.at(static_cast<std::size_t>(i))) * shown.step_up;
        if (const auto depth = depth_in_range(shown.slope + ring * offset, shown.depth_m, range)) return depth;
      }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<double> depth_in_range(const Vec2& slope, double depth_m, const Layer& range) const {
    const Vec3 way = frame_.point(slope, 1.0) - impostor_.reference_viewpoint;
    const double length = glm::length(way);
    const double from_m = range.near_m * length * (1.0 - kDistanceTolerance);
    const double to_m = range.far_m * length * (1.0 + kDistanceTolerance);
    const auto distance = !is_mesh(impostor_.technique) ? first_distance(way / length, from_m, to_m)
                                                        : nearest_distance(way / length, from_m, to_m, depth_m * length);
    if (!distance) return std::nullopt;
    return std::clamp(*distance / length, range.near_m, range.far_m);
  }

  [[nodiscard]] std::optional<double> first_distance(const Vec3& direction, double from_m, double to_m) const {
    const auto hit = original_.nearest(impostor_.reference_viewpoint, direction, from_m);
    return hit && hit->distance_m <= to_m ? std::optional(hit->distance_m) : std::nullopt;
  }

  [[nodiscard]] std::optional<double> nearest_distance(const Vec3& direction, double from_m, double to_m, double wanted_m) const {
    std::optional<double> nearest;
    for (const Hit& hit : original_.all(impostor_.reference_viewpoint, direction, from_m, to_m))
      if (!nearest || std::abs(hit.distance_m - wanted_m) < std::abs(*nearest - wanted_m)) nearest = hit.distance_m;
    return nearest;
  }

  // The GLB does not say which layer a quad belongs to: the one nearest to it.
  [[nodiscard]] Layer depth_range(double depth_m) const {
    const auto& layers = impostor_.layers;
    if (!is_mesh(impostor_.technique)) {
      const auto after = std::ranges::lower_bound(layers, depth_m, {}, &Layer::distance_m);
      if (after == layers.begin()) return *after;
      const auto before = after - 1;
      return after == layers.end() || depth_m - before->distance_m <= after->distance_m - depth_m ? *before : *after;
    }
    const auto found = std::ranges::lower_bound(layers, depth_m, {}, &Layer::far_m);
    const auto own = found == layers.end() ? found - 1 : found;
    return {own->distance_m, (own == layers.begin() ? own : own - 1)->near_m, (own + 1 == layers.end() ? own : own + 1)->far_m};
  }

  const JudgedImpostor& impostor_;
  const Camera& camera_;
  std::span<const AlphaSampling> samplings_;
  Raytracer original_;
  TriangleCaster caster_;
  ReferenceFrame frame_;
  Box bounds_;  // of the original and of what stands for it
};

void add(const ImpostorJudgement& view, std::uint32_t index, ImpostorJudgement& worst, ImpostorJudgement& sum) {
  if (std::pair(view.gap_pixels, view.max_parallax_ratio) > std::pair(worst.gap_pixels, worst.max_parallax_ratio)) {
    sum.worst_view = index;
    worst = view;
  }
  sum.add(view);
}

}  // namespace

void ImpostorJudgement::add(const ImpostorJudgement& other) {
  views += other.views;
  pixels += other.pixels;
  gap_pixels += other.gap_pixels;
  shown_pixels += other.shown_pixels;
  baseless_pixels += other.baseless_pixels;
  max_parallax_ratio = std::max(max_parallax_ratio, other.max_parallax_ratio);
  excess_pixels += other.excess_pixels;
  silhouette_px += other.silhouette_px;
}

std::vector<ImpostorJudgement> judge_samplings(const Scene& scene, const GlbQuads& quads, const JudgedImpostor& impostor,
                                               const Camera& camera, std::span<const View> views, std::span<const AlphaSampling> samplings,
                                               int threads, const WorkBudget& budget) {
  const Judge judge(scene, quads, impostor, camera, samplings);
  std::vector<std::vector<ImpostorJudgement>> judgements(views.size());
  parallel_for(views.size(), threads, budget, [&](std::size_t i) { judgements[i] = judge.judge(views[i]); });
  std::vector<ImpostorJudgement> sums(samplings.size());
  std::vector<ImpostorJudgement> worst(samplings.size());
  for (std::uint32_t i = 0; i < views.size(); ++i)
    for (std::size_t s = 0; s < samplings.size(); ++s) add(judgements[i][s], i, worst[s], sums[s]);
  return sums;
}

ImpostorJudgement judge_impostor(const Scene& scene, const GlbQuads& quads, const JudgedImpostor& impostor, const Camera& camera,
                                 std::span<const View> views, int threads, const WorkBudget& budget) {
  static constexpr std::array kNearest = {AlphaSampling::kNearest};
  return judge_samplings(scene, quads, impostor, camera, views, kNearest, threads, budget).front();
}

}  // namespace standin
