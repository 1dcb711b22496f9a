// In which order a frame's draws go out: near before far, so that hidden pixels fail the depth test, but only by octaves of distance;
// within an octave by program, texture and culling, since an unsorted frame has a switch a draw (25 to 35 us each, where a draw costs 2).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

namespace standin {

/// Sorts by key, then distance, then piece: deterministic.
struct OrderedDraw {
  std::uint64_t key = 0;
  double distance_m = 0.0;
  std::uint32_t piece = 0;
  friend bool operator<(const OrderedDraw& a, const OrderedDraw& b) {
    return std::tie(a.key, a.distance_m, a.piece) < std::tie(b.key, b.distance_m, b.piece);
  }
};

/// Masked draws come after all others: alpha tests switch llvmpipe's early depth rejection off.
[[nodiscard]] inline std::uint64_t draw_key(bool masked, double distance_m, std::uint32_t state_rank) {
  constexpr double kNearestOctave_m = 0x1.0p-10;
  constexpr std::int64_t kBias = 10;
  const auto octave = static_cast<std::uint64_t>(kBias + std::ilogb(std::max(distance_m, kNearestOctave_m)));
  return (masked ? std::uint64_t{1} << 63 : 0) | octave << 32 | state_rank;
}

}  // namespace standin
