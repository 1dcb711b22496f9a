// A covering problem as a city gives rise to it, without the city: no scene is loaded, nothing is drawn.
//
// Objects of four kinds stand on a plane, trees mostly in parks; median splits make the tree of clusters. Every square cell of 23 m sees
// some of them (the nearer, the likelier) in 32 directions; the slowest (cell, direction) pairs are the CPVs, what they take beyond the
// next one is their deficit. Candidates are sectors around a cluster's centre: apex angle, direction, least distance, and the tight one
// around each cell; their bytes follow the closed-form layer count (math of render/impostor/layers.h, one axis). Sectors of one cluster
// overlap freely, and the set of cells they hold is listed in runs of (node, cell) blocks, as placement/candidates/selection_input.h does
// it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <vector>

#include "placement/select/selection_problem.h"
#include "render/base/rng.h"

namespace standin {

struct SelectionCityShape {
  std::uint32_t objects = 5287;
  std::uint32_t cpvs = 9078;
  double width_m = 1500.0;
  double depth_m = 1000.0;
  double direction_step_deg = 11.25;
  std::vector<double> apex_deg = {11.25, 22.5, 45.0};
  std::uint64_t seed = 1;
};

class SelectionCity {
 public:
  explicit SelectionCity(const SelectionCityShape& shape) : shape_(shape), rng_(shape.seed) {
    place_objects();
    split();
    find_cpvs();
    list_worths();
    list_candidates();
  }

  [[nodiscard]] SelectionProblem take() { return std::move(problem_); }

 private:
  struct Object {
    double x = 0.0, y = 0.0, radius = 0.0, ms = 0.0;
  };
  struct Cluster {
    double x = 0.0, y = 0.0, radius = 0.0;
    std::uint32_t size = 0;
  };
  struct View {
    std::uint32_t cell = 0, direction = 0;
    double ms = 0.0;
  };
  struct Sector {
    std::vector<std::uint32_t> cells;  // ascending, positions in the node's list
    double near_m = 0.0, tangent = 0.0;
  };
  struct At {  // a cell as the cluster sees it
    double distance = 0.0, azimuth = 0.0;
  };

  static constexpr double kCell_m = 23.0;
  static constexpr double kReach_m = 0.71 * kCell_m;  // half diagonal
  static constexpr std::uint32_t kDirections = 32;
  static constexpr double kViewHalfAngle = 0.67;  // of a region's enclosing cone, radians
  static constexpr double kSight_m = 82.0;        // a third of the objects at this distance are seen
  static constexpr double kPixel = 0.00162;       // 45 degrees, 512 pixels
  static constexpr double kOthers_ms = 4.0;       // what every view takes
  static constexpr double kMostLayers = 200.0;

  void place_objects() {
    std::vector<std::array<double, 2>> parks(20);
    for (auto& [x, y] : parks) {
      x = rng_.uniform(0.0, shape_.width_m);
      y = rng_.uniform(0.0, shape_.depth_m);
    }
    for (std::uint32_t i = 0; i < shape_.objects; ++i) {
      Object o{rng_.uniform(0.0, shape_.width_m), rng_.uniform(0.0, shape_.depth_m), 0.0, 0.0};
      const double kind = rng_.uniform();
      if (kind < 0.085) {  // a tree
        if (rng_.uniform() < 0.6) {
          const auto& park = parks[rng_.below(parks.size())];
          o.x = park[0] + rng_.uniform(-40.0, 40.0);
          o.y = park[1] + rng_.uniform(-40.0, 40.0);
        }
        o.radius = rng_.uniform(4.0, 9.0);
        o.ms = rng_.uniform(1.5, 4.5);
      } else if (kind < 0.165) {  // a car
        o.radius = rng_.uniform(2.2, 3.0);
        o.ms = rng_.uniform(0.8, 1.5);
      } else if (kind < 0.53) {  // furniture
        o.radius = rng_.uniform(0.5, 3.0);
        o.ms = rng_.uniform(0.1, 0.35);
      } else {  // a building
        o.radius = rng_.uniform(12.0, 20.0);
        o.ms = rng_.uniform(0.25, 0.7);
      }
      objects_.push_back(o);
    }
  }

  /// Median splits of the longer side down to single objects, in depth-first order.
  void split() {
    struct Task {
      std::vector<std::uint32_t> ids;
      std::int32_t parent = -1;
    };
    std::vector<Task> open(1);
    open[0].ids.resize(objects_.size());
    std::iota(open[0].ids.begin(), open[0].ids.end(), 0U);
    leaf_.resize(objects_.size());
    while (!open.empty()) {
      Task task = std::move(open.back());
      open.pop_back();
      const auto node = static_cast<std::int32_t>(problem_.parent.size());
      problem_.parent.push_back(task.parent);
      clusters_.push_back(enclosing(task.ids));
      if (task.ids.size() == 1) {
        leaf_[task.ids[0]] = static_cast<std::uint32_t>(node);
        continue;
      }
      const bool by_x = spread(task.ids, &Object::x) > spread(task.ids, &Object::y);
      const auto at = [&](std::uint32_t id) { return by_x ? objects_[id].x : objects_[id].y; };
      const auto half = task.ids.begin() + static_cast<std::ptrdiff_t>(task.ids.size() / 2);
      std::nth_element(task.ids.begin(), half, task.ids.end(), [&](auto a, auto b) { return at(a) != at(b) ? at(a) < at(b) : a < b; });
      open.push_back({{half, task.ids.end()}, node});
      open.push_back({{task.ids.begin(), half}, node});
    }
  }

  [[nodiscard]] double spread(const std::vector<std::uint32_t>& ids, double Object::*axis) const {
    double low = 1e9, high = -1e9;
    for (const auto id : ids) {
      low = std::min(low, objects_[id].*axis);
      high = std::max(high, objects_[id].*axis);
    }
    return high - low;
  }

  [[nodiscard]] Cluster enclosing(const std::vector<std::uint32_t>& ids) const {
    Cluster c;
    for (const auto id : ids) {
      c.x += objects_[id].x / static_cast<double>(ids.size());
      c.y += objects_[id].y / static_cast<double>(ids.size());
    }
    for (const auto id : ids) c.radius = std::max(c.radius, std::hypot(objects_[id].x - c.x, objects_[id].y - c.y) + objects_[id].radius);
    c.size = static_cast<std::uint32_t>(ids.size());
    return c;
  }

  [[nodiscard]] std::uint32_t columns() const { return static_cast<std::uint32_t>(shape_.width_m / kCell_m); }
  [[nodiscard]] std::uint32_t cell_count() const { return columns() * static_cast<std::uint32_t>(shape_.depth_m / kCell_m); }
  [[nodiscard]] std::array<double, 2> centre(std::uint32_t cell) const {
    return {(cell % columns() + 0.5) * kCell_m, (cell / columns() + 0.5) * kCell_m};
  }

  static double turned(double angle) { return std::abs(std::remainder(angle, 2.0 * std::numbers::pi)); }

  /// Calls visit(object, direction) for what the cell sees in each direction.
  template <class Visit>
  void for_each_seen(std::uint32_t cell, Visit&& visit) const {
    const auto [x, y] = centre(cell);
    for (std::uint32_t id = 0; id < objects_.size(); ++id) {
      const Object& o = objects_[id];
      const double distance = std::hypot(o.x - x, o.y - y);
      Rng chance(shape_.seed + 1, static_cast<std::uint64_t>(cell) * objects_.size() + id);
      if (chance.uniform() > std::exp(-distance / kSight_m)) continue;
      const double azimuth = std::atan2(o.y - y, o.x - x);
      const double extent = distance > o.radius + kReach_m ? std::asin((o.radius + kReach_m) / distance) : std::numbers::pi;
      for (std::uint32_t d = 0; d < kDirections; ++d)
        if (turned(azimuth - d * 2.0 * std::numbers::pi / kDirections) < kViewHalfAngle + extent) visit(id, d);
    }
  }

  void find_cpvs() {
    std::vector<View> views;
    for (std::uint32_t cell = 0; cell < cell_count(); ++cell) {
      std::array<double, kDirections> ms{};
      for_each_seen(cell, [&](std::uint32_t id, std::uint32_t d) { ms[d] += objects_[id].ms; });
      for (std::uint32_t d = 0; d < kDirections; ++d) views.push_back({cell, d, kOthers_ms + ms[d]});
    }
    std::ranges::sort(views, [](const View& a, const View& b) { return a.ms > b.ms; });
    const double budget_ms = views.at(shape_.cpvs).ms;
    views.resize(shape_.cpvs);
    std::ranges::sort(views, [](const View& a, const View& b) { return a.cell != b.cell ? a.cell < b.cell : a.direction < b.direction; });
    for (const View& view : views) {
      cpv_at_[view.cell].push_back({view.direction, problem_.form.size()});
      problem_.form.push_back(static_cast<std::uint8_t>(rng_.uniform() < 0.3 ? 1 : 0));
      problem_.deficit.push_back(view.ms - budget_ms);
    }
    problem_.forms = 2;
  }

  /// Worth of every cluster in every CPV, one block for each (node, cell).
  void list_worths() {
    struct Entry {
      std::uint32_t node, cell, cpv;
      double worth;
    };
    std::vector<Entry> entries;
    for (const auto& [cell, cpvs] : cpv_at_) {
      std::map<std::pair<std::uint32_t, std::uint32_t>, double> worth;  // (node, CPV)
      for_each_seen(cell, [&](std::uint32_t id, std::uint32_t d) {
        for (const auto& [direction, cpv] : cpvs)
          if (direction == d)
            for (auto n = static_cast<std::int32_t>(leaf_[id]); n >= 0; n = problem_.parent[static_cast<std::size_t>(n)])
              worth[{static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(cpv)}] += objects_[id].ms;
      });
      for (const auto& [at, ms] : worth)
        if (in_reach(at.first, cell)) entries.push_back({at.first, cell, at.second, ms});
    }
    std::ranges::sort(entries, [](const Entry& a, const Entry& b) {
      return a.node != b.node ? a.node < b.node : a.cell != b.cell ? a.cell < b.cell : a.cpv < b.cpv;
    });
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (i > 0 && (entries[i].node != entries[i - 1].node || entries[i].cell != entries[i - 1].cell)) end_block();
      if (i == 0 || entries[i].node != entries[i - 1].node) first_block_.push_back({entries[i].node, problem_.block_count()});
      if (problem_.cpv.size() == problem_.block_offset.back()) block_cell_.push_back(entries[i].cell);
      problem_.cpv.push_back(entries[i].cpv);
      problem_.worth.push_back(entries[i].worth);
    }
    if (!entries.empty()) end_block();
    first_block_.push_back({0, problem_.block_count()});
  }

  void end_block() { problem_.block_offset.push_back(static_cast<std::uint32_t>(problem_.cpv.size())); }

  [[nodiscard]] bool in_reach(std::uint32_t node, std::uint32_t cell) const {
    const auto [x, y] = centre(cell);
    return std::hypot(clusters_[node].x - x, clusters_[node].y - y) > 1.2 * clusters_[node].radius + kReach_m;
  }

  void list_candidates() {
    for (std::size_t i = 0; i + 1 < first_block_.size(); ++i) {
      const std::uint32_t begin = first_block_[i].second;
      std::vector<At> cells;
      for (std::uint32_t b = begin; b < first_block_[i + 1].second; ++b) {
        const auto [x, y] = centre(block_cell_[b]);
        const Cluster& cluster = clusters_[first_block_[i].first];
        cells.push_back({std::hypot(x - cluster.x, y - cluster.y), std::atan2(y - cluster.y, x - cluster.x)});
      }
      for (const Sector& sector : sectors(cells, clusters_[first_block_[i].first])) add_candidate(first_block_[i].first, begin, sector);
    }
  }

  /// Different sets of cells, each with the nearest distance and the narrowest aperture that hold it.
  [[nodiscard]] std::vector<Sector> sectors(const std::vector<At>& cells, const Cluster& cluster) const {
    std::map<std::vector<std::uint32_t>, Sector> found;
    const auto keep = [&](std::vector<std::uint32_t> held, double axis) {
      if (held.empty()) return;
      Sector sector{held, 1e9, 0.0};
      double half_angle = 0.0;
      for (const auto c : held) {
        sector.near_m = std::min(sector.near_m, cells[c].distance - kReach_m);
        half_angle = std::max(half_angle, turned(cells[c].azimuth - axis) + std::asin(kReach_m / cells[c].distance));
      }
      sector.tangent = std::tan(std::min(half_angle, 1.4));
      auto [at, is_new] = found.emplace(std::move(held), sector);
      if (!is_new && sector.tangent < at->second.tangent) at->second = sector;
    };
    for (std::uint32_t c = 0; c < cells.size(); ++c) keep({c}, cells[c].azimuth);
    for (const double apex : shape_.apex_deg)
      for (double axis = 0.0; axis < 360.0; axis += shape_.direction_step_deg)
        for (double least = 1.2 * cluster.radius; least < 800.0; least *= 2.0)
          keep(held(cells, axis * std::numbers::pi / 180.0, 0.5 * apex * std::numbers::pi / 180.0, least), axis * std::numbers::pi / 180.0);
    std::vector<Sector> result;
    for (auto& [held, sector] : found) result.push_back(std::move(sector));
    return result;
  }

  [[nodiscard]] static std::vector<std::uint32_t> held(const std::vector<At>& cells, double axis, double half_apex, double least) {
    std::vector<std::uint32_t> result;
    for (std::uint32_t c = 0; c < cells.size(); ++c)
      if (cells[c].distance - kReach_m >= least && turned(cells[c].azimuth - axis) + std::asin(kReach_m / cells[c].distance) <= half_apex)
        result.push_back(c);
    return result;
  }

  void add_candidate(std::uint32_t node, std::uint32_t first_block, const Sector& sector) {
    const Cluster& cluster = clusters_[node];
    const double slope = cluster.radius / sector.near_m;
    const double layers = std::ceil(std::log((sector.near_m + cluster.radius) / (sector.near_m - 0.8 * cluster.radius)) /
                                    -std::log1p(-kPixel / (slope + sector.tangent)));
    if (layers > kMostLayers) return;
    const double side = 2.0 * slope / kPixel;
    const double texels = 0.35 * side * side;
    const double fixed_ms = 0.03 + 0.0007 * layers * (1.0 + 0.04 * layers);
    if (!gains_somewhere(first_block, sector, fixed_ms)) return;
    problem_.node.push_back(node);
    problem_.bytes.push_back(4.0 * 1.25 * (1.3 * texels + 1.5 * layers * std::sqrt(texels)) + 80.0 * layers);
    problem_.cost.push_back(fixed_ms + 3.6e-6 * 2.0 * texels);
    problem_.cost.push_back(fixed_ms);
    for (const auto c : sector.cells) {
      const std::uint32_t block = first_block + c;
      if (problem_.runs.size() > problem_.run_offset.back() && problem_.runs.back().end == block)
        ++problem_.runs.back().end;
      else
        problem_.runs.push_back({block, block + 1});
    }
    problem_.run_offset.push_back(problem_.runs.size());
  }

  [[nodiscard]] bool gains_somewhere(std::uint32_t first_block, const Sector& sector, double cost_ms) const {
    for (const auto c : sector.cells)
      for (std::uint32_t e = problem_.block_offset[first_block + c]; e < problem_.block_offset[first_block + c + 1]; ++e)
        if (problem_.worth[e] > cost_ms) return true;
    return false;
  }

  const SelectionCityShape shape_;
  Rng rng_;
  std::vector<Object> objects_;
  std::vector<Cluster> clusters_;                                                       // per node
  std::vector<std::uint32_t> leaf_;                                                     // node of each object
  std::map<std::uint32_t, std::vector<std::pair<std::uint32_t, std::size_t>>> cpv_at_;  // per cell: (direction, CPV)
  std::vector<std::uint32_t> block_cell_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> first_block_;  // (node, block), and an end
  SelectionProblem problem_;
};

}  // namespace standin
