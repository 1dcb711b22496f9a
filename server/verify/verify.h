// Verification by rendering (architecture.md: verify): views of the placed view space, each drawn with and without impostors through
// placement/runtime, estimated and measured.
//
// Random views and adversarial ones (cell corners, interval borders, the views whose bound the optimizer left closest to the budget, a
// camera path through the view space, the slowest views that the survey found). "Before" draws the visible objects at their levels of
// detail, "after" what the placement says; pictures are held against the originals. Times are measured only where the device is the
// target's; elsewhere they are left out.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/time_model.h"
#include "placement/runtime/placement.h"
#include "placement/view_space/view_space.h"
#include "render/base/work.h"
#include "render/device/frame_timer.h"

namespace standin {

enum class ViewOrigin { kRandom, kCorner, kBorder, kTight, kPath, kSurveyed };

struct VerifiedView {
  View view;
  ViewOrigin origin = ViewOrigin::kRandom;
  std::optional<std::uint32_t> cell;
  std::optional<std::uint32_t> cpv;
  double estimated_before_ms = 0.0;
  double estimated_after_ms = 0.0;
  std::optional<double> measured_before_ms;
  std::optional<double> measured_after_ms;
  double mean_error = 0.0;  // image with against image without impostors
  double mean_flip = 0.0;   // likewise, as an eye sees it (image_error.h)
};

/// One view in pictures.
struct ViewPictures {
  std::uint32_t view = 0;  // index into VerifyResult::views
  Texture original;
  Texture with_impostors;
  Texture difference;  // absolute, amplified 4x

  /// The three in a row, from left to right.
  [[nodiscard]] Texture side_by_side() const;
};

/// Name of the picture of the k-th of VerifyResult::pictures in a result folder.
[[nodiscard]] std::string picture_file(std::size_t k);

struct VerifyOptions {
  std::uint32_t views = 32;
  std::uint32_t measured_before = 100;  // views whose slow "before" frame is timed too (worst estimates first)
  std::uint64_t seed = 1;
  std::uint32_t pictures = 4;       // worst views by image error and by time
  std::uint32_t judged_views = 64;  // views inside view cells that are judged by rays
  int threads = 1;
};

struct VerifyResult {
  std::vector<VerifiedView> views;
  std::vector<ViewPictures> pictures;
  std::uint32_t over_budget_estimated = 0;
  std::uint32_t over_budget_measured = 0;
  double worst_over_budget = 0.0;  // max of measured_after / budget
  // Share of the timed frames, before and after, that kept the bound of their estimate: to be held against the target's coverage.
  std::optional<double> measured_coverage;
  std::uint32_t judged_views = 0;  // views judged by rays, and what they found
  std::uint64_t gap_pixels = 0;
  double max_parallax_ratio = 0.0;
  std::uint64_t shown_pixels = 0;                    // pixels of judged views that show an opaque texel
  std::uint64_t baseless_pixels = 0;                 // of these, without an original to compare with (impostor_rays.h): no parallax ratio
  std::optional<double> silhouette_bloat_px;         // mean over the judged silhouettes (silhouette.h)
  std::optional<double> worst_before_over_surveyed;  // worst measured frame without impostors, over the survey's worst estimate
  double mean_error = 0.0;                           // mean over views with an impostor in them
  double mean_flip = 0.0;                            // likewise
  std::optional<double> lods_mean_error;             // of levels of detail alone, without impostors: mean over views that show one
  std::optional<double> lods_mean_flip;              // likewise
  std::vector<std::string> left_out;                 // what was not measured, and why
};

/// What verification looks at: a placement and the bytes of the GLB that ships with it (impostors are read back from it).
struct VerifyInput {
  const Scene& scene;
  const Target& target;
  const Placement& placement;
  const ViewSpace& view_space;
  const Camera& camera;
  const std::string& impostor_glb;
  double budget_ms;
  double alpha_rad;
  double surveyed_worst_ms = 0.0;         // survey.worst_frame_ms; 0: not known
  std::vector<View> surveyed_views = {};  // the slowest that the survey found
};

/// Whoever times holds the machine-wide lock for as long; a test's fake timer needs none.
struct TimingSession {
  std::unique_ptr<TimingLock> lock;
  std::unique_ptr<FrameTimer> timer;
};
/// Called once, when timing begins; empty: nothing is timed.
using StartTiming = std::function<TimingSession(Context&)>;

[[nodiscard]] VerifyResult verify_placement(const VerifyInput& input, Context& context, const StartTiming& start_timing,
                                            const VerifyOptions& options, const WorkBudget& budget);

/// `measure` false: nothing is timed (another machine's target, say); pictures are drawn all the same.
[[nodiscard]] VerifyResult verify_placement(const VerifyInput& input, DeviceKind device, bool measure, const VerifyOptions& options,
                                            const WorkBudget& budget);

}  // namespace standin
