#include "placement/candidates/planar_parts.h"

#include <cmath>
#include <limits>
#include <vector>

namespace standin {
namespace {

Vec3 mean(const std::vector<Vec3>& points) {
  Vec3 sum(0.0);
  for (const Vec3& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

/// Angles to the right of and above the mean direction.
std::vector<Vec2> angles_of(const std::vector<Vec3>& ways) {
  const Shaft frame = shaft_frame(Vec3(0.0), glm::normalize(mean(ways)));
  std::vector<Vec2> angles;
  for (const Vec3& way : ways) {
    const double along = glm::dot(way, frame.axis);
    angles.emplace_back(std::atan2(glm::dot(way, frame.right), along), std::atan2(glm::dot(way, frame.up), along));
  }
  return angles;
}

}  // namespace

std::pair<CellSet, CellSet> halved_across(const DraftContext& context, std::uint32_t node, const CellSet& cells) {
  const Vec3 apex = context.hierarchy.nodes[node].bounds.centre();
  std::vector<Vec3> ways;
  for (const std::uint32_t cell : cells) ways.push_back(context.subdivision.cells[cell].box.centre() - apex);
  if (!(glm::length(mean(ways)) > 0.0)) return {cells, {}};
  const std::vector<Vec2> angles = angles_of(ways);
  Vec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const Vec2& angle : angles) {
    low = glm::min(low, angle);
    high = glm::max(high, angle);
  }
  const int axis = high.x - low.x >= high.y - low.y ? 0 : 1;
  const double middle = 0.5 * (low[axis] + high[axis]);
  std::pair<CellSet, CellSet> halves;
  for (std::size_t i = 0; i < cells.size(); ++i) (angles[i][axis] <= middle ? halves.first : halves.second).push_back(cells[i]);
  return halves;
}

}  // namespace standin
