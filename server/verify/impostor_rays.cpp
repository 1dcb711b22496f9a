#include "server/verify/impostor_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "render/base/parallel.h"
#include "render/base/rng.h"
#include "render/visibility/raytracer.h"
#include "server/verify/quad_stack.h"

namespace standin {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();
constexpr int kDiscRadius = 2;
// Of float ray distances; borders of depth ranges are blurred by this share.
constexpr double kDistanceTolerance = 1e-6;

// Pixels [x0, x1) x [y0, y1).
struct Window {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

class PixelRays {
 public:
  PixelRays(const View& view, const Camera& camera)
      : view_(view), camera_(camera), world_from_eye_(world_from_eye_rotation(view.direction)) {}

  [[nodiscard]] Vec3 direction(int x, int y) const {
    const double right = camera_.tan_half_x() * (2.0 * (x + 0.5) / camera_.width - 1.0);
    const double up = camera_.tan_half_y() * (1.0 - 2.0 * (y + 0.5) / camera_.height);
    return glm::normalize(world_from_eye_ * Vec3(right, up, -1.0));
  }
  /// Pixels of the image that may show the box.
  [[nodiscard]] Window window_of(const Box& box) const {
    Vec2 low(kNowhere);
    Vec2 high(-kNowhere);
    for (int i = 0; i < 8; ++i) {
      const Vec3 eye = (box.corner(i) - view_.position) * world_from_eye_;
      if (!(eye.z < 0.0)) return {0, 0, camera_.width, camera_.height};
      const Vec2 ndc(eye.x / (-eye.z * camera_.tan_half_x()), -eye.y / (-eye.z * camera_.tan_half_y()));
      low = glm::min(low, ndc);
      high = glm::max(high, ndc);
    }
    const auto pixel = [](double ndc, int size, int margin) {
      return static_cast<int>(std::clamp(std::floor(0.5 * (ndc + 1.0) * size) + margin, 0.0, static_cast<double>(size)));
    };
    return {pixel(low.x, camera_.width, -kDiscRadius), pixel(low.y, camera_.height, -kDiscRadius),
            pixel(high.x, camera_.width, kDiscRadius + 1), pixel(high.y, camera_.height, kDiscRadius + 1)};
  }

 private:
  const View& view_;
  const Camera& camera_;
  Mat3 world_from_eye_;
};

// Distances along pixel rays to the original, for a window and the discs of its pixels.
class OriginalImage {
 public:
  OriginalImage(const Raytracer& raytracer, const View& view, const PixelRays& rays, const Window& window)
      : x0_(window.x0 - kDiscRadius), y0_(window.y0 - kDiscRadius), width_(window.x1 - x0_ + kDiscRadius) {
    for (int y = y0_; y < window.y1 + kDiscRadius; ++y)
      for (int x = x0_; x < window.x1 + kDiscRadius; ++x) {
        const auto hit = raytracer.nearest(view.position, rays.direction(x, y));
        distances_.push_back(hit ? hit->distance_m : kNowhere);
      }
  }
  /// Of the pixels within the disc; infinity where one of them is not covered.
  [[nodiscard]] double farthest_in_disc(int x, int y) const {
    double farthest = 0.0;
    for (int dy = -kDiscRadius; dy <= kDiscRadius; ++dy)
      for (int dx = -kDiscRadius; dx <= kDiscRadius; ++dx)
        if (dx * dx + dy * dy <= kDiscRadius * kDiscRadius) farthest = std::max(farthest, at(x + dx, y + dy));
    return farthest;
  }

 private:
  [[nodiscard]] double at(int x, int y) const { return distances_[static_cast<std::size_t>((y - y0_) * width_ + x - x0_)]; }

  int x0_, y0_, width_;
  std::vector<double> distances_;
};

struct ViewJudgement {
  std::uint64_t pixels = 0;
  std::uint64_t gap_pixels = 0;
  std::uint64_t shown_pixels = 0;
  std::uint64_t baseless_pixels = 0;
  double max_parallax_ratio = 0.0;
};

class Judge {
 public:
  Judge(const Scene& scene, const GlbQuads& quads, const JudgedImpostor& impostor, const Camera& camera)
      : impostor_(impostor),
        camera_(camera),
        original_(scene, impostor.objects, Raytracer::Options{}),
        stack_(quads, quads.impostor(impostor.node), stack_frame(impostor.reference_viewpoint, impostor.forward)) {
    for (const std::uint32_t object : impostor.objects) bounds_.extend(scene.objects[object].bounds);
    const GlbImpostor& shown = quads.impostor(impostor.node);
    for (const auto& triangle : shown.triangles)
      for (const Vec3& offset : triangle.offsets) bounds_.extend(shown.origin + offset);
    if (impostor.layers.empty() || !(impostor.alpha_rad > 0.0))
      throw Failure(ErrorWord::kInternal, impostor.node + ": layers and an angle above zero are needed to judge it");
  }

  [[nodiscard]] ViewJudgement judge(const View& view) const {
    const PixelRays rays(view, camera_);
    const Window window = rays.window_of(bounds_);
    const OriginalImage original(original_, view, rays, window);
    ViewJudgement result;
    for (int y = window.y0; y < window.y1; ++y)
      for (int x = window.x0; x < window.x1; ++x) {
        const auto shown = stack_.first_opaque(view.position, rays.direction(x, y));
        judge_gap(original.farthest_in_disc(x, y), shown, result);
        if (shown) judge_parallax(view, *shown, result);
      }
    return result;
  }

 private:
  void judge_gap(double farthest_original_m, const std::optional<QuadStack::Texel>& shown, ViewJudgement& result) const {
    if (farthest_original_m == kNowhere) return;
    ++result.pixels;
    if (!shown) {
      ++result.gap_pixels;
      return;
    }
    const Layer& layer = layer_at(shown->depth_m);
    const double allowed = (layer.far_m - layer.near_m) + kDistanceTolerance * shown->distance_m;
    if (shown->distance_m - farthest_original_m > allowed) ++result.gap_pixels;
  }

  void judge_parallax(const View& view, const QuadStack::Texel& shown, ViewJudgement& result) const {
    ++result.shown_pixels;
    const auto depth = depth_shown(shown);
    if (!depth) {
      ++result.baseless_pixels;
      return;
    }
    const Vec3 to_shown = point(shown.slope, shown.depth_m) - view.position;
    const Vec3 to_original = point(shown.slope, *depth) - view.position;
    const double angle = std::atan2(glm::length(glm::cross(to_shown, to_original)), glm::dot(to_shown, to_original));
    result.max_parallax_ratio = std::max(result.max_parallax_ratio, angle / impostor_.alpha_rad);
  }

  // Depth of the original behind the texel: through the point itself, else on rings of up to one texel around it.
  [[nodiscard]] std::optional<double> depth_shown(const QuadStack::Texel& shown) const {
    const Layer& layer = layer_at(shown.depth_m);
    if (const auto depth = depth_in_range(shown.slope, layer)) return depth;
    for (const double ring : {0.25, 0.5, 0.75, 1.0})
      for (int i = 0; i < 8; ++i) {
        static constexpr std::array<int, 8> kX = {1, 0, -1, 0, 1, -1, -1, 1};
        static constexpr std::array<int, 8> kY = {0, 1, 0, -1, 1, 1, -1, -1};
        const Vec2 offset(kX.at(static_cast<std::size_t>(i)), kY.at(static_cast<std::size_t>(i)));
        if (const auto depth = depth_in_range(shown.slope + ring * offset * shown.slope_step, layer)) return depth;
      }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<double> depth_in_range(const Vec2& slope, const Layer& layer) const {
    const Vec3 way = point(slope, 1.0) - impostor_.reference_viewpoint;
    const double length = glm::length(way);
    const auto hit = original_.nearest(impostor_.reference_viewpoint, way / length, layer.near_m * length * (1.0 - kDistanceTolerance));
    if (!hit) return std::nullopt;
    const double depth = hit->distance_m / length;
    if (depth > layer.far_m * (1.0 + kDistanceTolerance)) return std::nullopt;
    return std::clamp(depth, layer.near_m, layer.far_m);
  }

  [[nodiscard]] Vec3 point(const Vec2& slope, double depth_m) const {
    const StackFrame& frame = stack_.frame();
    return frame.origin + depth_m * (frame.forward + slope.x * frame.right + slope.y * frame.up);
  }

  // The GLB does not say which layer a quad belongs to: the one nearest to it.
  [[nodiscard]] const Layer& layer_at(double depth_m) const {
    return *std::min_element(impostor_.layers.begin(), impostor_.layers.end(), [&](const Layer& a, const Layer& b) {
      return std::abs(a.distance_m - depth_m) < std::abs(b.distance_m - depth_m);
    });
  }

  const JudgedImpostor& impostor_;
  const Camera& camera_;
  Raytracer original_;
  QuadStack stack_;
  Box bounds_;  // of the original and of what stands for it
};

ImpostorJudgement sum_of(const std::vector<ViewJudgement>& views) {
  ImpostorJudgement sum;
  sum.views = static_cast<std::uint32_t>(views.size());
  for (std::uint32_t i = 0; i < views.size(); ++i) {
    const ViewJudgement& worst = views[sum.worst_view];
    if (std::pair(views[i].gap_pixels, views[i].max_parallax_ratio) > std::pair(worst.gap_pixels, worst.max_parallax_ratio))
      sum.worst_view = i;
    sum.pixels += views[i].pixels;
    sum.gap_pixels += views[i].gap_pixels;
    sum.shown_pixels += views[i].shown_pixels;
    sum.baseless_pixels += views[i].baseless_pixels;
    sum.max_parallax_ratio = std::max(sum.max_parallax_ratio, views[i].max_parallax_ratio);
  }
  return sum;
}

}  // namespace

ImpostorJudgement judge_impostor(const Scene& scene, const GlbQuads& quads, const JudgedImpostor& impostor, const Camera& camera,
                                 std::span<const View> views, int threads, const WorkBudget& budget) {
  const Judge judge(scene, quads, impostor, camera);
  std::vector<ViewJudgement> judgements(views.size());
  parallel_for(views.size(), threads, budget, [&](std::size_t i) { judgements[i] = judge.judge(views[i]); });
  return sum_of(judgements);
}

}  // namespace standin
