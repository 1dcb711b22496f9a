#include "render/scene/city_layout.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/base/rng.h"

namespace standin {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kBuildingDepth_m = 13.0;

template <typename T>
void shuffle(std::vector<T>& items, Rng& rng) {
  for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[rng.below(i)]);
}

// `total` as evenly as whole numbers allow over `count` places; which places get one more is drawn.
std::vector<std::uint32_t> shared_out(std::uint32_t total, std::size_t count, Rng& rng) {
  std::vector<std::uint32_t> shares(count, 0);
  if (count == 0) return shares;
  for (std::size_t i = 0; i < count; ++i) shares[i] = static_cast<std::uint32_t>(total / count + (i < total % count ? 1 : 0));
  shuffle(shares, rng);
  return shares;
}

struct Rect {
  Vec2 centre{0.0};
  Vec2 half{0.0};
};

// One side of a block's rectangle: runs along `direction` (to the right for somebody in the street who looks at it), `outward` into the
// street.
struct Side {
  Vec2 middle{0.0};
  Vec2 direction{0.0};
  Vec2 outward{0.0};
  double length_m = 0.0;
  [[nodiscard]] double yaw_rad() const { return std::atan2(outward.x, outward.y); }  // turns +z to `outward`
};

// The two long sides first; `trim_m` is cut off both ends of the other two (where the long sides' buildings stand).
std::array<Side, 4> sides_of(const Rect& block, double trim_m) {
  const auto [c, h] = std::pair(block.centre, block.half);
  return {{{c + Vec2(0, h.y), {1, 0}, {0, 1}, 2 * h.x},
           {c - Vec2(0, h.y), {-1, 0}, {0, -1}, 2 * h.x},
           {c + Vec2(h.x, 0), {0, -1}, {1, 0}, 2 * (h.y - trim_m)},
           {c - Vec2(h.x, 0), {0, 1}, {-1, 0}, 2 * (h.y - trim_m)}}};
}

struct Slot {
  Vec2 place{0.0};
  double yaw_rad = 0.0;
};

// Places every `step_m` along the four sides, `offset_m` out from the side, none within `corner_m` of a corner.
void add_slots(std::vector<Slot>& slots, const Rect& rect, double step_m, double corner_m, double offset_m) {
  for (const Side& side : sides_of(rect, 0.0)) {
    const double usable_m = side.length_m - 2.0 * corner_m;
    const int count = std::max(0, static_cast<int>(usable_m / step_m));
    for (int i = 0; i < count; ++i) {
      const double along = (i + 0.5) * usable_m / count - 0.5 * usable_m;
      slots.push_back({side.middle + along * side.direction + offset_m * side.outward, side.yaw_rad()});
    }
  }
}

std::uint32_t nearest_shape(double width_m, Rng& rng) {
  std::array<std::uint32_t, kBuildingShapes.size()> order{};
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::abs(kBuildingShapes[a].width_m - width_m) < std::abs(kBuildingShapes[b].width_m - width_m);
  });
  return order[rng.below(3)];
}

class Planner {
 public:
  Planner(const CityCounts& counts, std::uint64_t seed) : counts_(counts), rng_(seed, 1) { choose_parks(); }

  CityLayout run() {
    place_tiles();
    place_buildings();
    place_trees_and_furniture();
    place_cars();
    return std::move(layout_);
  }

 private:
  [[nodiscard]] Rect block(std::uint32_t index) const {
    const Vec2 cell(index % counts_.columns, index / counts_.columns);
    const Vec2 grid(counts_.columns, counts_.rows);
    return {(cell + 0.5 - 0.5 * grid) * layout_.tile.pitch_m, 0.5 * (layout_.tile.pitch_m - layout_.tile.street_width_m)};
  }

  // The block with its pavement.
  [[nodiscard]] Rect kerb(std::uint32_t index) const {
    Rect rect = block(index);
    rect.half += layout_.tile.pavement_m;
    return rect;
  }

  void choose_parks() {
    const std::uint32_t parks = counts_.tiles() < 6 ? 0 : (counts_.tiles() + 5) / 10;
    std::vector<std::uint32_t> order(counts_.tiles());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    shuffle(order, rng_);
    is_park_.assign(order.size(), false);
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      is_park_[order[i]] = i < parks;
      (i < parks ? parks_ : built_).push_back(order[i]);
    }
    std::sort(parks_.begin(), parks_.end());
    std::sort(built_.begin(), built_.end());
  }

  void place_tiles() {
    for (std::uint32_t i = 0; i < counts_.tiles(); ++i) {
      const Vec2 centre = block(i).centre;
      layout_.tiles.push_back({is_park_[i] ? 1U : 0U, 0, {centre.x, 0.0, centre.y}, 0.0, Vec3(1.0)});
    }
  }

  void place_buildings() {
    const auto shares = shared_out(counts_.buildings, built_.size(), rng_);
    for (std::size_t b = 0; b < built_.size(); ++b) fill_block(block(built_[b]), shares[b]);
  }

  // Whole perimeter closed as soon as there are four buildings: each next one goes to the side with the longest fronts.
  void fill_block(const Rect& rect, std::uint32_t buildings) {
    const auto sides = sides_of(rect, kBuildingDepth_m);
    std::array<std::uint32_t, 4> on_side{};
    for (std::uint32_t i = 0; i < buildings; ++i) {
      std::size_t longest = 0;
      for (std::size_t s = 1; s < sides.size(); ++s) {
        if (sides[s].length_m / (on_side[s] + 1e-9) > sides[longest].length_m / (on_side[longest] + 1e-9)) longest = s;
      }
      ++on_side[longest];
    }
    for (std::size_t s = 0; s < sides.size(); ++s) fill_side(sides[s], on_side[s]);
  }

  void fill_side(const Side& side, std::uint32_t buildings) {
    std::vector<double> widths(buildings);
    double sum = 0.0;
    for (double& width : widths) sum += width = rng_.uniform(0.75, 1.25);
    double left = -0.5 * side.length_m;
    for (const double width : widths) {
      const double width_m = width / sum * side.length_m;
      place_building(side, left + 0.5 * width_m, width_m);
      left += width_m;
    }
  }

  void place_building(const Side& side, double along_m, double width_m) {
    Place place;
    place.model = nearest_shape(width_m, rng_);
    place.colour = static_cast<std::uint32_t>(rng_.below(kFacadeColours));
    const Vec2 centre = side.middle + along_m * side.direction - 0.5 * kBuildingDepth_m * side.outward;
    place.position = {centre.x, kPavementHeight_m, centre.y};
    place.yaw_rad = side.yaw_rad();
    const BuildingShape& shape = kBuildingShapes[place.model];
    place.scale = {width_m / shape.width_m, rng_.uniform(0.9, 1.1), kBuildingDepth_m / shape.depth_m};
    layout_.buildings.push_back(place);
  }

  void place_tree(const Vec2& at, double size) {
    Place place;
    place.model = static_cast<std::uint32_t>(rng_.below(kTreeShapes.size()));
    place.position = {at.x, kPavementHeight_m, at.y};
    place.yaw_rad = rng_.uniform(0.0, 2.0 * kPi);
    place.scale = Vec3(size * rng_.uniform(0.9, 1.07));
    layout_.trees.push_back(place);
  }

  // `count` trees in a rectangle, one per cell of a grid, off its middle.
  void scatter_trees(const Rect& rect, std::uint32_t count, double size) {
    if (count == 0) return;
    const auto columns = static_cast<std::uint32_t>(std::ceil(std::sqrt(count * rect.half.x / rect.half.y)));
    const std::uint32_t rows = (count + columns - 1) / columns;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec2 share((i % columns + rng_.uniform(0.25, 0.75)) / columns, (i / columns + rng_.uniform(0.25, 0.75)) / rows);
      place_tree(rect.centre + (2.0 * share - 1.0) * rect.half, size);
    }
  }

  // Up to 13 trees per park, a fifth of the rest in yards, the others along the kerbs among the furniture.
  void place_trees_and_furniture() {
    const auto in_parks = std::min<std::uint32_t>(counts_.trees * 2 / 3, static_cast<std::uint32_t>(13 * parks_.size()));
    const auto park_shares = shared_out(in_parks, parks_.size(), rng_);
    for (std::size_t p = 0; p < parks_.size(); ++p) scatter_trees(block(parks_[p]), park_shares[p], 1.0);
    const std::uint32_t in_yards = (counts_.trees - in_parks) / 5;
    const auto yard_shares = shared_out(in_yards, built_.size(), rng_);
    for (std::size_t b = 0; b < built_.size(); ++b) {
      Rect yard = block(built_[b]);
      yard.half -= kBuildingDepth_m + 2.0;
      scatter_trees(yard, yard_shares[b], 1.0);
    }
    std::vector<Slot> slots;
    for (std::uint32_t i = 0; i < counts_.tiles(); ++i) add_slots(slots, kerb(i), 4.0, 3.0, -0.7);
    shuffle(slots, rng_);
    auto slot = slots.begin();
    while (layout_.trees.size() < counts_.trees) place_tree((slot++)->place, 0.75);
    while (layout_.furniture.size() < counts_.furniture) place_furniture(*slot++);
  }

  void place_furniture(const Slot& slot) {
    // Of 20: 5 lamps, 4 bollards, 3 benches, 3 bins, 3 signs, 2 advertising columns.
    static constexpr std::array<std::uint32_t, 20> kMix{0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5};
    Place place;
    place.model = kMix[rng_.below(kMix.size())];
    place.position = {slot.place.x, kPavementHeight_m, slot.place.y};
    place.yaw_rad = slot.yaw_rad;
    layout_.furniture.push_back(place);
  }

  void place_cars() {
    std::vector<Slot> slots;
    for (std::uint32_t i = 0; i < counts_.tiles(); ++i) add_slots(slots, kerb(i), 6.5, 8.0, 1.2);
    shuffle(slots, rng_);
    for (std::uint32_t i = 0; i < counts_.cars; ++i) {
      Place place;
      place.model = static_cast<std::uint32_t>(rng_.below(kCarShapes.size()));
      place.colour = static_cast<std::uint32_t>(rng_.below(kPaintColours));
      place.position = {slots[i].place.x, 0.0, slots[i].place.y};
      place.yaw_rad = slots[i].yaw_rad + (rng_.below(8) == 0 ? -0.5 : 0.5) * kPi;
      layout_.cars.push_back(place);
    }
  }

  CityCounts counts_;
  Rng rng_;
  CityLayout layout_;
  std::vector<bool> is_park_;
  std::vector<std::uint32_t> parks_;
  std::vector<std::uint32_t> built_;
};

}  // namespace

CityCounts city_counts(std::uint32_t objects) {
  const auto share = [&](double of_5287) { return std::max(1U, static_cast<std::uint32_t>(std::lround(objects * of_5287 / 5287.0))); };
  const double blocks = objects * 208.0 / 5287.0;
  CityCounts counts;
  counts.columns = std::max(1U, static_cast<std::uint32_t>(std::lround(std::sqrt(blocks * 16.0 / 13.0))));
  counts.rows = std::max(1U, static_cast<std::uint32_t>(std::lround(blocks / counts.columns)));
  counts.buildings = share(2276);
  counts.trees = share(450);
  counts.cars = share(420);
  counts.furniture = objects - counts.tiles() - counts.buildings - counts.trees - counts.cars;
  return counts;
}

CityLayout lay_out_city(const CityCounts& counts, std::uint64_t seed) {
  return Planner(counts, seed).run();
}

}  // namespace standin
