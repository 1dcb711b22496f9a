// Nanoseconds per lookup, as a renderer asks once a frame (lookup.md holds results).
//
//     lookup PLACEMENT_FOLDER...
//
// Three kinds of views: inside random problem views (found, with impostors), random views of the view space, and corners of cells, where
// the border rule tries several neighbours. Each time is the least of several passes over the same queries, in random order.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <limits>
#include <vector>

#include "placement/runtime/placement.h"
#include "render/base/error.h"
#include "render/base/rng.h"
#include "server/files/placement_json.h"

namespace standin {
namespace {

constexpr std::size_t kQueries = 200'000;
constexpr int kPasses = 9;
constexpr std::uint64_t kSeed = 5;

struct Query {
  Vec3 position, direction;
};

Vec3 inside(const Box& box, Rng& rng) {
  return {rng.uniform(box.min.x, box.max.x), rng.uniform(box.min.y, box.max.y), rng.uniform(box.min.z, box.max.z)};
}

Vec3 any_direction(Rng& rng) {
  for (;;) {
    const Vec3 direction(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    const double length = glm::length(direction);
    if (length > 0.0 && length <= 1.0) return direction;
  }
}

Query in_problem_view(const PlacementFile& file, Rng& rng) {
  const Placement& placement = file.placement;
  const PlacementCpv& cpv = placement.cpvs[rng.below(placement.cpvs.size())];
  const DirectionInterval& interval = placement.intervals[cpv.interval];
  const auto [a0, a1, b0, b1] = interval.angles_rad();
  return {inside(placement.cells[cpv.cell].box, rng), direction_at(interval.face, rng.uniform(a0, a1), rng.uniform(b0, b1))};
}

Query anywhere(const PlacementFile& file, Rng& rng) {
  return {file.view_space.sample_position(rng), any_direction(rng)};
}

Query on_a_corner(const PlacementFile& file, Rng& rng) {
  const auto& cells = file.placement.cells;
  return {cells[rng.below(cells.size())].box.corner(static_cast<int>(rng.below(8))), any_direction(rng)};
}

void measure(const PlacementFile& file, const PlacementIndex& index, const char* kind, Query (*make)(const PlacementFile&, Rng&)) {
  Rng rng(kSeed);
  std::vector<Query> queries;
  for (std::size_t i = 0; i < kQueries; ++i) queries.push_back(make(file, rng));
  std::size_t cells = 0, cpvs = 0;
  double least_s = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < kPasses; ++pass) {
    cells = cpvs = 0;
    const auto start = std::chrono::steady_clock::now();
    for (const Query& query : queries) {
      const Lookup found = index.find(query.position, query.direction);
      cells += found.cell ? 1 : 0;
      cpvs += found.cpv ? 1 : 0;
    }
    least_s = std::min(least_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  const auto share = [](std::size_t part) { return static_cast<double>(part) / kQueries; };
  std::printf("  %-24s %7.1f ns   in a cell %.3f   in a problem view %.3f\n", kind, 1e9 * least_s / kQueries, share(cells), share(cpvs));
}

void measure_folder(const std::string& folder) {
  const PlacementFile file = placement_from_json(nlohmann::json::parse(std::ifstream(folder + "/placement.json")), folder);
  const Placement& placement = file.placement;
  std::printf("%s: %zu cells of levels %d to %d, %zu intervals, %zu problem views\n", file.scene_name.c_str(), placement.cells.size(),
              placement.cells.front().key.level, placement.cells.back().key.level, placement.intervals.size(), placement.cpvs.size());
  const PlacementIndex index(placement);
  measure(file, index, "inside problem views", in_problem_view);
  measure(file, index, "anywhere", anywhere);
  measure(file, index, "on corners of cells", on_a_corner);
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "lookup PLACEMENT_FOLDER...\n"), 2;
  try {
    for (int i = 1; i < argc; ++i) standin::measure_folder(argv[i]);
  } catch (const standin::Failure& failure) {
    return std::fprintf(stderr, "%s\n", failure.what()), 2;
  }
  return 0;
}
