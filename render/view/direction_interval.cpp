#include "render/view/direction_interval.h"

#include <cmath>
#include <numbers>
#include <string>

#include "render/base/error.h"

namespace standin {
namespace {

constexpr int kDeepestLevel = 20;
constexpr double kEighthTurn = 0.25 * std::numbers::pi;

// u x v = n on every face; v is the world's up on the four side faces, so that a is the azimuth there.
constexpr std::array<FaceFrame, kFaceCount> make_frames() {
  return {{{"+x", {1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
           {"-x", {-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
           {"+y", {0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
           {"-y", {0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
           {"+z", {0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
           {"-z", {0, 0, -1}, {-1, 0, 0}, {0, 1, 0}}}};
}

// The fraction is exact in binary: nodes of all levels agree on a common border to the last bit.
double border_rad(int index, int level) {
  return kEighthTurn * (std::ldexp(static_cast<double>(index), 1 - level) - 1.0);
}

int index_of(double angle_rad, int level) {
  const int count = 1 << level;
  int index = static_cast<int>(std::floor((angle_rad / kEighthTurn + 1.0) * 0.5 * count));
  index = std::clamp(index, 0, count - 1);
  if (index + 1 < count && angle_rad >= border_rad(index + 1, level)) return index + 1;
  if (index > 0 && angle_rad < border_rad(index, level)) return index - 1;
  return index;
}

Face face_of(const Vec3& direction) {
  const Vec3 size = glm::abs(direction);
  if (size.x >= size.y && size.x >= size.z) return direction.x > 0.0 ? Face::kPosX : Face::kNegX;
  if (size.y >= size.z) return direction.y > 0.0 ? Face::kPosY : Face::kNegY;
  return direction.z > 0.0 ? Face::kPosZ : Face::kNegZ;
}

}  // namespace

const FaceFrame& face_frame(Face face) {
  static constexpr std::array<FaceFrame, kFaceCount> kFrames = make_frames();
  return kFrames.at(static_cast<std::size_t>(face));
}

std::array<double, 4> DirectionInterval::angles_rad() const {
  return {border_rad(i, level), border_rad(i + 1, level), border_rad(j, level), border_rad(j + 1, level)};
}

std::array<Vec3, 4> DirectionInterval::corner_directions() const {
  const auto [a0, a1, b0, b1] = angles_rad();
  return {direction_at(face, a0, b0), direction_at(face, a1, b0), direction_at(face, a1, b1), direction_at(face, a0, b1)};
}

DirectionInterval interval_of(const Vec3& direction, int level) {
  const Face face = face_of(direction);
  const FaceFrame& frame = face_frame(face);
  const double along = glm::dot(direction, frame.n);
  if (!(along > 0.0) || level < 0 || level > kDeepestLevel)
    throw Failure(ErrorWord::kInternal, "interval_of: a direction of length > 0 and a level in 0.." + std::to_string(kDeepestLevel) +
                                            " are needed, not length " + std::to_string(glm::length(direction)) + " and level " +
                                            std::to_string(level));
  return {face, level, index_of(std::atan2(glm::dot(direction, frame.u), along), level),
          index_of(std::atan2(glm::dot(direction, frame.v), along), level)};
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
