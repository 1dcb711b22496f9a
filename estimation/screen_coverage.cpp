#include "estimation/screen_coverage.h"

#include <algorithm>
#include <cmath>

namespace standin {
namespace {

std::size_t octave_of(double depth_m, std::size_t octaves) {
  constexpr int kFirst = -3;
  return static_cast<std::size_t>(std::clamp(std::ilogb(depth_m) - kFirst, 0, static_cast<int>(octaves) - 1));
}

}  // namespace

ScreenCoverage::ScreenCoverage(const Camera& camera)
    : cell_width_px_(static_cast<double>(camera.width) / kCells),
      cell_height_px_(static_cast<double>(camera.height) / kCells),
      cells_(static_cast<std::size_t>(kCells) * kCells) {}

ScreenCoverage::CellRange ScreenCoverage::cells_of(double centre_px, double half_px, double cell_px) {
  const auto cell = [&](double at_px) { return static_cast<int>(std::clamp(std::floor(at_px / cell_px), 0.0, kCells - 1.0)); };
  return {cell(centre_px - half_px), cell(centre_px + half_px)};
}

void ScreenCoverage::add(PixelKind kind, double x_px, double y_px, double depth_m, double pixels) {
  const double half_px = 0.5 * std::sqrt(pixels);
  const CellRange columns = cells_of(x_px, half_px, cell_width_px_);
  const CellRange rows = cells_of(y_px, half_px, cell_height_px_);
  const double each = pixels / ((columns.last - columns.first + 1) * (rows.last - rows.first + 1));
  const std::size_t octave = octave_of(depth_m, kOctaves);
  for (int row = rows.first; row <= rows.last; ++row)
    for (int column = columns.first; column <= columns.last; ++column) {
      Cell& cell = cells_[static_cast<std::size_t>(row * kCells + column)];
      (kind == PixelKind::kMasked ? cell.masked : cell.opaque)[octave] += each;
      if (kind == PixelKind::kPlain) cell.plain += each;
      if (kind == PixelKind::kTextured) cell.textured += each;
    }
}

double ScreenCoverage::masked_passed(const Cell& cell) const {
  const double cell_px = cell_width_px_ * cell_height_px_;
  double sum = 0.0, nearer = 0.0;
  for (std::size_t octave = 0; octave < kOctaves; ++octave) {
    // Of the same octave, half of what is opaque lies in front.
    sum += cell.masked[octave] * std::max(0.0, 1.0 - (nearer + 0.5 * cell.opaque[octave]) / cell_px);
    nearer += cell.opaque[octave];
  }
  return std::min(sum, kOverdraw * cell_px);
}

std::array<double, kPixelKindCount> ScreenCoverage::passed() const {
  const double full = kOverdraw * cell_width_px_ * cell_height_px_;
  std::array<double, kPixelKindCount> sum{};
  for (const Cell& cell : cells_) {
    const double opaque = cell.plain + cell.textured;
    const double masked = masked_passed(cell);
    const double share = opaque > full - masked ? (full - masked) / opaque : 1.0;
    sum[static_cast<std::size_t>(PixelKind::kPlain)] += share * cell.plain;
    sum[static_cast<std::size_t>(PixelKind::kTextured)] += share * cell.textured;
    sum[static_cast<std::size_t>(PixelKind::kMasked)] += masked;
  }
  return sum;
}

}  // namespace standin
