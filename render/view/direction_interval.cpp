#include "render/view/direction_interval.h"

#include <cmath>
#include <string>

#include "render/base/error.h"
#include "render/base/placement_lookup.h"

namespace standin {
namespace {

constexpr int kDeepestLevel = kDeepestIntervalLevel;

// u x v = n on every face; v is the world's up on the four side faces, so that a is the azimuth there.
constexpr std::array<FaceFrame, kFaceCount> make_frames() {
  return {{{"+x", {1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
           {"-x", {-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
           {"+y", {0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
           {"-y", {0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
           {"+z", {0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
           {"-z", {0, 0, -1}, {-1, 0, 0}, {0, 1, 0}}}};
}

}  // namespace

const FaceFrame& face_frame(Face face) {
  static constexpr std::array<FaceFrame, kFaceCount> kFrames = make_frames();
  return kFrames.at(static_cast<std::size_t>(face));
}

std::array<double, 4> DirectionInterval::angles_rad() const {
  return {angle_border_rad(i, level), angle_border_rad(i + 1, level), angle_border_rad(j, level), angle_border_rad(j + 1, level)};
}

std::array<Vec3, 4> DirectionInterval::corner_directions() const {
  const auto [a0, a1, b0, b1] = angles_rad();
  return {direction_at(face, a0, b0), direction_at(face, a1, b0), direction_at(face, a1, b1), direction_at(face, a0, b1)};
}

DirectionInterval interval_of(const Vec3& direction, int level) {
  const auto on_face = face_angles({direction.x, direction.y, direction.z});
  if (!on_face || level < 0 || level > kDeepestLevel)
    throw Failure(ErrorWord::kInternal, "interval_of: a direction of length > 0 and a level in 0.." + std::to_string(kDeepestLevel) +
                                            " are needed, not length " + std::to_string(glm::length(direction)) + " and level " +
                                            std::to_string(level));
  return {static_cast<Face>(on_face->face), level, angle_slot(on_face->a_rad, level), angle_slot(on_face->b_rad, level)};
}

Vec3 direction_at(Face face, double a_rad, double b_rad) {
  const FaceFrame& frame = face_frame(face);
  return glm::normalize(frame.n + std::tan(a_rad) * frame.u + std::tan(b_rad) * frame.v);
}

int level_for_width(double width_deg) {
  for (int level = 0; level <= kDeepestLevel; ++level)
    if (std::ldexp(90.0, -level) <= width_deg) return level;
  throw Failure(ErrorWord::kBadUsage, "width of direction intervals: " + std::to_string(width_deg) + " degrees is below the least, " +
                                          std::to_string(std::ldexp(90.0, -kDeepestLevel)));
}

}  // namespace standin
