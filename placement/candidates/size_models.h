// One size model for each technique that candidates may be made with: what an impostor weighs depends on how it is made.
//
// A further technique is a further entry: where candidates are drafted, fitted, weighed and corrected, the entries are gone through in the
// order of the enumeration. What has no entry is not offered.
#pragma once

#include <array>
#include <optional>

#include "render/impostor/impostor.h"

namespace standin {

/// exp(b0 + b1 log S + b2 log n + b3 log N + b4 (1 - 1/n) log((C + 2) / S)), with the variables of SizeInput (size_model.h); of bytes S'
/// in the place of S.
using SizeLaw = std::array<double, 5>;

/// Memory and drawing cost from a sketch (layers, texture size, what is in it), fitted on real bakes: the paper's heuristic (5.8.1), ours
/// in log space.
struct SizeModel {
  SizeLaw log_bytes{};
  SizeLaw log_texels{};  // drawn, without gutters
  SizeLaw log_quads{};
  // What bakes exceed their estimates by at most, in 9 of 10 cases, >= 1. Bytes are what is minimised and stay unbiased; the drawing cost
  // is a promise to every region an impostor serves, and a little caution there costs next to nothing.
  double texels_margin = 1.0;
  double quads_margin = 1.0;
  double median_error = 0.0;  // held out, relative, of bytes
  std::uint32_t bakes = 0;
};

class SizeModels {
 public:
  SizeModels() = default;
  // NOLINTNEXTLINE: the layered technique alone is the plain case
  SizeModels(const SizeModel& of_layered) { offer(Technique::kLayered, of_layered); }

  /// Offers the technique, or gives it another model.
  void offer(Technique technique, const SizeModel& model) { models_.at(static_cast<std::size_t>(technique)) = model; }
  [[nodiscard]] bool offers(Technique technique) const { return models_.at(static_cast<std::size_t>(technique)).has_value(); }
  /// Of a technique that is offered.
  [[nodiscard]] const SizeModel& of(Technique technique) const { return models_.at(static_cast<std::size_t>(technique)).value(); }

 private:
  std::array<std::optional<SizeModel>, kTechniqueCount> models_;
};

}  // namespace standin
