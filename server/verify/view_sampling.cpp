#include "server/verify/view_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "render/base/rng.h"

namespace standin {
namespace {

enum class Kind { kAnywhere, kRegion, kCorner, kBorder, kTight, kPath };

// The mix, repeated: every prefix holds some of each kind.
constexpr std::array kPattern = {Kind::kRegion, Kind::kTight,    Kind::kCorner, Kind::kRegion,  Kind::kPath,   Kind::kBorder,
                                 Kind::kRegion, Kind::kAnywhere, Kind::kTight,  Kind::kRegion,  Kind::kCorner, Kind::kRegion,
                                 Kind::kTight,  Kind::kPath,     Kind::kRegion, Kind::kAnywhere};
constexpr std::uint32_t kViewsPerRun = 8;
constexpr int kRunEnds = 8;  // candidates for a run's end, of which the nearest is taken
constexpr std::uint64_t kRunStream = std::uint64_t{1} << 32;

ViewOrigin origin_of(Kind kind) {
  switch (kind) {
    case Kind::kCorner:
      return ViewOrigin::kCorner;
    case Kind::kBorder:
      return ViewOrigin::kBorder;
    case Kind::kTight:
      return ViewOrigin::kTight;
    case Kind::kPath:
      return ViewOrigin::kPath;
    default:
      return ViewOrigin::kRandom;
  }
}

/// Uniform on the sphere (Archimedes).
Vec3 random_direction(Rng& rng) {
  const double y = rng.uniform(-1.0, 1.0);
  const double azimuth = rng.uniform(0.0, 2.0 * std::numbers::pi);
  const double radius = std::sqrt(std::max(0.0, 1.0 - y * y));
  return {radius * std::cos(azimuth), y, radius * std::sin(azimuth)};
}

Vec3 direction_inside(const DirectionInterval& interval, Rng& rng) {
  const auto [a0, a1, b0, b1] = interval.angles_rad();
  const double a = rng.uniform(a0, a1);
  return direction_at(interval.face, a, rng.uniform(b0, b1));
}

/// On one of the interval's four edges.
Vec3 direction_on_border(const DirectionInterval& interval, Rng& rng) {
  const auto [a0, a1, b0, b1] = interval.angles_rad();
  const std::uint64_t edge = rng.below(4);
  if (edge < 2) return direction_at(interval.face, edge == 0 ? a0 : a1, rng.uniform(b0, b1));
  return direction_at(interval.face, rng.uniform(a0, a1), edge == 2 ? b0 : b1);
}

class ViewSampler {
 public:
  ViewSampler(const Placement& placement, const ViewSpace& view_space, std::uint64_t seed);
  [[nodiscard]] View sample(Kind kind, std::uint32_t ordinal, Rng& rng) const;

 private:
  /// The parts of the view space inside a cell: its box may have holes where nobody can stand.
  [[nodiscard]] std::vector<Box> parts_of(std::uint32_t cell) const;
  [[nodiscard]] Vec3 position_in(const PlacementCpv& cpv, Rng& rng) const;
  [[nodiscard]] Vec3 corner_of(const PlacementCpv& cpv, Rng& rng) const;
  [[nodiscard]] Vec3 nearest_position(const Vec3& point) const;
  [[nodiscard]] View on_path(std::uint32_t ordinal) const;
  [[nodiscard]] View in_region(Kind kind, const PlacementCpv& cpv, Rng& rng) const;
  [[nodiscard]] const DirectionInterval& interval_of_cpv(const PlacementCpv& cpv) const { return placement_.intervals[cpv.interval]; }

  const Placement& placement_;
  const ViewSpace& view_space_;
  std::uint64_t seed_;
  std::vector<std::uint32_t> tightest_;  // solved CPVs, the bound nearest to the budget first
};

ViewSampler::ViewSampler(const Placement& placement, const ViewSpace& view_space, std::uint64_t seed)
    : placement_(placement), view_space_(view_space), seed_(seed) {
  for (std::uint32_t i = 0; i < placement.cpvs.size(); ++i)
    if (placement.cpvs[i].solved) tightest_.push_back(i);
  std::stable_sort(tightest_.begin(), tightest_.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return placement.cpvs[a].bound_after_ms > placement.cpvs[b].bound_after_ms; });
}

std::vector<Box> ViewSampler::parts_of(std::uint32_t cell) const {
  const Box& box = placement_.cells[cell].box;
  std::vector<Box> parts;
  for (const Box& whole : view_space_.boxes) {
    const Box part = intersection(whole, box);
    if (!part.empty()) parts.push_back(part);
  }
  return parts.empty() ? std::vector<Box>{box} : parts;
}

Vec3 ViewSampler::position_in(const PlacementCpv& cpv, Rng& rng) const {
  const std::vector<Box> parts = parts_of(cpv.cell);
  return sample_boxes(parts, volume_sums(parts), rng);
}

Vec3 ViewSampler::corner_of(const PlacementCpv& cpv, Rng& rng) const {
  const Vec3 wanted = placement_.cells[cpv.cell].box.corner(static_cast<int>(rng.below(8)));
  const std::vector<Box> parts = parts_of(cpv.cell);
  const auto nearest =
      std::min_element(parts.begin(), parts.end(), [&](const Box& a, const Box& b) { return distance(wanted, a) < distance(wanted, b); });
  return glm::clamp(wanted, nearest->min, nearest->max);
}

Vec3 ViewSampler::nearest_position(const Vec3& point) const {
  const auto& boxes = view_space_.boxes;
  const auto nearest =
      std::min_element(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) { return distance(point, a) < distance(point, b); });
  return glm::clamp(point, nearest->min, nearest->max);
}

/// Runs between neighbouring positions, looking ahead; what would leave the view space is moved back into it.
View ViewSampler::on_path(std::uint32_t ordinal) const {
  Rng rng(seed_, kRunStream + ordinal / kViewsPerRun);
  const Vec3 start = view_space_.sample_position(rng);
  Vec3 end = view_space_.sample_position(rng);
  for (int i = 1; i < kRunEnds; ++i) {
    const Vec3 other = view_space_.sample_position(rng);
    if (glm::distance(start, other) < glm::distance(start, end)) end = other;
  }
  const double run_m = glm::distance(start, end);
  const double along = static_cast<double>(ordinal % kViewsPerRun) / (kViewsPerRun - 1);
  return {nearest_position(start + along * (end - start)), run_m > 0.0 ? (end - start) / run_m : random_direction(rng)};
}

View ViewSampler::in_region(Kind kind, const PlacementCpv& cpv, Rng& rng) const {
  const DirectionInterval& interval = interval_of_cpv(cpv);
  if (kind == Kind::kCorner) return {corner_of(cpv, rng), interval.corner_directions()[rng.below(4)]};
  const Vec3 position = position_in(cpv, rng);
  return {position, kind == Kind::kBorder ? direction_on_border(interval, rng) : direction_inside(interval, rng)};
}

View ViewSampler::sample(Kind kind, std::uint32_t ordinal, Rng& rng) const {
  if (kind == Kind::kPath) return on_path(ordinal);
  const auto& cpvs = placement_.cpvs;
  if (kind == Kind::kAnywhere || cpvs.empty()) {
    const Vec3 position = view_space_.sample_position(rng);
    return {position, random_direction(rng)};
  }
  const bool tight = kind == Kind::kTight && !tightest_.empty();
  return in_region(kind, tight ? cpvs[tightest_[ordinal % tightest_.size()]] : cpvs[rng.below(cpvs.size())], rng);
}

}  // namespace

std::vector<VerifiedView> sample_views(const Placement& placement, const ViewSpace& view_space, std::uint32_t count, std::uint64_t seed) {
  const ViewSampler sampler(placement, view_space, seed);
  std::array<std::uint32_t, kPattern.size()> drawn{};  // of each kind
  std::vector<VerifiedView> views(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    Kind kind = kPattern[i % kPattern.size()];
    if (placement.cpvs.empty() && kind != Kind::kPath) kind = Kind::kAnywhere;
    Rng rng(seed, i);
    views[i].view = sampler.sample(kind, drawn[static_cast<std::size_t>(kind)]++, rng);
    views[i].origin = origin_of(kind);
  }
  return views;
}

}  // namespace standin
