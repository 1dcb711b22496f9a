#include "estimation/screen_coverage.h"

#include <algorithm>
#include <cmath>

namespace standin {

ScreenCoverage::ScreenCoverage(const Camera& camera)
    : cell_width_px_(static_cast<double>(camera.width) / kCells), cell_height_px_(static_cast<double>(camera.height) / kCells) {}

ScreenCoverage::CellRange ScreenCoverage::cells_of(double centre_px, double half_px, double cell_px) {
  const auto cell = [&](double at_px) { return static_cast<int>(std::clamp(std::floor(at_px / cell_px), 0.0, kCells - 1.0)); };
  return {cell(centre_px - half_px), cell(centre_px + half_px)};
}

void ScreenCoverage::add(PixelKind kind, double x_px, double y_px, double pixels) {
  const double half_px = 0.5 * std::sqrt(pixels);
  const CellRange columns = cells_of(x_px, half_px, cell_width_px_);
  const CellRange rows = cells_of(y_px, half_px, cell_height_px_);
  const double each = pixels / ((columns.last - columns.first + 1) * (rows.last - rows.first + 1));
  for (int row = rows.first; row <= rows.last; ++row)
    for (int column = columns.first; column <= columns.last; ++column)
      generated_[static_cast<std::size_t>(row * kCells + column)][static_cast<std::size_t>(kind)] += each;
}

std::array<double, kPixelKindCount> ScreenCoverage::passed() const {
  constexpr auto kPlain = static_cast<std::size_t>(PixelKind::kPlain);
  constexpr auto kTextured = static_cast<std::size_t>(PixelKind::kTextured);
  constexpr auto kMasked = static_cast<std::size_t>(PixelKind::kMasked);
  const double full = kOverdraw * cell_width_px_ * cell_height_px_;
  std::array<double, kPixelKindCount> sum{};
  for (const auto& generated : generated_) {
    const double opaque = generated[kPlain] + generated[kTextured];
    const double share = opaque > full ? full / opaque : 1.0;
    sum[kPlain] += share * generated[kPlain];
    sum[kTextured] += share * generated[kTextured];
    sum[kMasked] += std::min(generated[kMasked], std::max(0.0, full - opaque));
  }
  return sum;
}

}  // namespace standin
