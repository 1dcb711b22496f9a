// View direction intervals (VDI, thesis 5.5.2): nodes of a quadtree on each face of the direction cube.
//
// Direction on a face: d ~ n + tan(a) u + tan(b) v with a, b in [-45, 45] degrees; a quadtree node halves the *angles* (equal-angle cells
// differ by 1.41x in solid angle, equal-tangent ones by 5.2x: math.md 4). Intervals are half-open at the upper end, the last one closed; a
// direction's face is that of its largest component, ties x before y before z.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "render/base/geometry.h"

namespace standin {

enum class Face : std::uint8_t { kPosX, kNegX, kPosY, kNegY, kPosZ, kNegZ };
inline constexpr int kFaceCount = 6;

struct FaceFrame {
  std::string_view name;  // "+x" ...
  Vec3 n, u, v;
};
[[nodiscard]] const FaceFrame& face_frame(Face face);

/// Node (i, j) of 2^level x 2^level on a face.
struct DirectionInterval {
  Face face = Face::kPosX;
  int level = 0;  // 0..20
  int i = 0;
  int j = 0;

  /// {a0, a1, b0, b1} in radians.
  [[nodiscard]] std::array<double, 4> angles_rad() const;
  /// Unit directions at the four corners, counter-clockwise in (a, b).
  [[nodiscard]] std::array<Vec3, 4> corner_directions() const;
  [[nodiscard]] DirectionInterval parent() const { return {face, level - 1, i >> 1, j >> 1}; }
  /// Child k in 0..3: bit 0 upper half in a, bit 1 upper half in b.
  [[nodiscard]] DirectionInterval child(int k) const { return {face, level + 1, 2 * i + (k & 1), 2 * j + (k >> 1)}; }
  friend auto operator<=>(const DirectionInterval&, const DirectionInterval&) = default;
};

/// The interval of `level` that holds `direction` (not zero, need not be unit length).
[[nodiscard]] DirectionInterval interval_of(const Vec3& direction, int level);
/// Unit direction at (a, b) radians on a face.
[[nodiscard]] Vec3 direction_at(Face face, double a_rad, double b_rad);
/// Least level whose intervals are no wider than `width_deg` (90, 45, 22.5, 11.25 ...).
[[nodiscard]] int level_for_width(double width_deg);

}  // namespace standin
