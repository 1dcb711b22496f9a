// What the time model says of one frame: the originals and impostors that a view draws, without rendering it.
#pragma once

#include <vector>

#include "estimation/feature_table.h"
#include "estimation/time_model.h"
#include "render/device/renderer.h"

namespace standin {

class FrameEstimator {
 public:
  /// All references must outlive the estimator.
  FrameEstimator(const Scene& scene, const Camera& camera, const TimeModel& model, const ImpostorSet& impostors);
  /// Predicted, not bound. A page of the atlas that the frame uses is one texture switch.
  [[nodiscard]] double predicted_ms(const View& view, const DrawList& list) const;

 private:
  [[nodiscard]] Features features(const View& view, const std::vector<std::uint32_t>& drawn) const;

  FeatureTable table_;
  const TimeModel& model_;
  const ImpostorSet& impostors_;
  std::vector<Box> replaced_bounds_;  // per impostor, of the objects it stands for
};

}  // namespace standin
