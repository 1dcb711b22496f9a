#include "server/verify/frame_estimate.h"

#include <set>

#include "render/scene/object_bounds.h"

namespace standin {

FrameEstimator::FrameEstimator(const Scene& scene, const Camera& camera, const TimeModel& model, const ImpostorSet& impostors)
    : table_(scene, camera), model_(model), impostors_(impostors) {
  for (const auto& impostor : impostors.impostors) replaced_bounds_.push_back(bounds_of(scene, impostor.objects));
}

Features FrameEstimator::features(const View& view, const std::vector<std::uint32_t>& drawn) const {
  Features sum;
  std::set<std::uint32_t> pages;
  for (const auto id : drawn) {
    const Features one = impostor_features(impostors_.impostors[id], replaced_bounds_[id], view, table_.camera());
    sum += one;
    if (one[Term::kDraws] > 0.0)
      for (const auto& slot : impostors_.slots[id]) pages.insert(slot.page);
  }
  sum[Term::kTextureSwitches] += static_cast<double>(pages.size());
  return sum;
}

double FrameEstimator::predicted_ms(const View& view, const DrawList& list) const {
  Features frame = table_.frame(list.objects, view, list.levels);
  frame += features(view, list.impostors);
  return model_.predicted_ms(frame);
}

}  // namespace standin
