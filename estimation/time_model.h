// The rendering-time model of one target machine (thesis 5.2.1, 5.8.1): milliseconds as a non-negative linear function of Features, with an
// upper bound of stated coverage.
//
// The pixels of a frame's originals saturate, since near ones hide far ones (screen_coverage.h): a region's bound is the sum of all its
// objects' terms, or of all terms but pixels and as many of the costliest pixels as can pass. It must choose one of these linear forms
// beforehand, so Cost keeps the two parts apart. Where the machine overlaps its stages, a frame takes shared + max(geometry, fill) instead;
// regions are then bounded by the stages' sum, which is never less (a second constraint a region would be tighter). The bound is a factor
// times the prediction, conformal (split by scene) and made monotone; inverted once, it leaves placement a single predicted-time budget.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "estimation/features.h"
#include "estimation/stages.h"

namespace standin {

/// Predicted milliseconds of something drawn, its two parts kept apart; adds up.
struct Cost {
  double fixed_ms = 0.0;  // draws, switches, triangles, impostors' pixels
  double pixel_ms = 0.0;  // of originals' pixels: of a frame, at most most_pixel_ms()
  Cost& operator+=(const Cost& other) {
    fixed_ms += other.fixed_ms;
    pixel_ms += other.pixel_ms;
    return *this;
  }
};

/// Predictions below `until_ms` (ascending; the last one infinity) and not below the step before are multiplied by `factor` >= 0. Where a
/// later factor is less, the bound stays level until the product has caught up: bound = max over steps begun of factor * min(p, until_ms).
struct BoundStep {
  double until_ms = 0.0;
  double factor = 1.0;
};

struct TimeModel {
  std::array<double, kTermCount> milliseconds_per_unit{};  // >= 0
  Combination combination = Combination::kSum;             // of the stages' times
  std::vector<BoundStep> bound_steps;
  double coverage = 0.99;  // stated, for frames exchangeable with the calibration set

  [[nodiscard]] Cost cost(const Features& features) const;
  [[nodiscard]] double predicted_ms(const Features& frame) const;
  /// The stages added up: an upper bound where they overlap.
  [[nodiscard]] double predicted_ms(const Cost& frame) const;
  /// The most that the pixels of a frame's originals may cost, where at most `passed_pixels` of these terms pass.
  [[nodiscard]] double most_pixel_ms(std::span<const Term> terms, double passed_pixels) const;
  /// Non-decreasing; 0 at 0.
  [[nodiscard]] double bound_ms(double predicted_ms) const;
  /// Largest predicted time whose bound is within the budget; < 0 if none.
  [[nodiscard]] double predicted_budget_ms(double budget_ms) const;
};

/// Where frames were timed.
struct Machine {
  std::string device;    // "osmesa" | "egl"
  std::string renderer;  // GL_RENDERER
  std::string gl_version;
  std::string processor;             // model name; another one is a warning only
  double reference_ms = 0.0;         // reference frame at calibration
  std::string clock = "thread_cpu";  // or "wall", of a device that does not work in the calling thread
};

/// How well a calibration would have done with its first seconds (learning_curve.h).
struct LearningPoint {
  double seconds = 0.0;
  std::uint32_t frames = 0;
  double median_error = 0.0;  // held out, relative, as are the others
  double p90_error = 0.0;
  double coverage = 0.0;
  double bound_over_measured_median = 0.0;
};

/// A target file (JSON): the model, the machine it was measured on, and how well it did.
struct Target {
  std::string id;      // "osmesa-llvmpipe-..."; readable
  std::string sha256;  // of the file's bytes; filled when read
  TimeModel model;
  Machine machine;
  // Held-out quality, for the report.
  std::uint32_t samples = 0;
  double median_error = 0.0;  // relative
  double p90_error = 0.0;
  double measured_coverage = 0.0;
  std::vector<std::string> left_out;  // terms the data could not support, with the reason
  std::vector<LearningPoint> learning_curve;
};

/// Throws Failure(kFileMissing, kFileBroken, kTargetUnreadable).
[[nodiscard]] Target read_target(const std::filesystem::path& file);
/// Whole or not at all.
void write_target(const Target& target, const std::filesystem::path& file);

}  // namespace standin
