// A street in numbers: box objects at one end, cells at the other, regions and costs written out by hand. No meshes: candidates only look
// at bounds.
#pragma once

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "placement/candidates/selection_input.h"
#include "render/base/rng.h"
#include "render/scene/hierarchy.h"

namespace standin::test {

struct ToyWorld {
  Scene scene;
  Hierarchy hierarchy;
  Subdivision subdivision;
  TimeModel model;
  Camera camera;
  BakeQuality quality;
  SizeModels sizes = default_size_model();
  CandidateOptions options;

  [[nodiscard]] CandidateSet generate() const {
    return generate_candidates(scene, hierarchy, subdivision, model, sizes, camera, quality, options, {});
  }
  [[nodiscard]] Reach reach() const { return reachable_times(scene, hierarchy, subdivision, model, sizes, camera, quality, options, {}); }
  [[nodiscard]] SelectionProblem problem(const CandidateSet& set, double budget_ms, double reserve_ms = 0.0) const {
    return make_selection_problem(hierarchy, subdivision, set, model, camera, {budget_ms, reserve_ms}, options.threads, {});
  }

  void add_object(const Box& bounds) {
    Object object;
    object.bounds = bounds;
    scene.objects.push_back(object);
  }
  void finish_objects() {
    for (const auto& object : scene.objects) scene.bounds.extend(object.bounds);
    hierarchy = build_hierarchy(scene);
  }
  std::uint32_t add_cell(const CellKey& key, const Box& box) {
    Cell cell;
    cell.key = key;
    cell.box = box;
    subdivision.cells.push_back(cell);
    return static_cast<std::uint32_t>(subdivision.cells.size() - 1);
  }
  /// Terms in any order; cells must come in ascending order.
  void add_cpv(std::uint32_t cell, std::vector<RegionTerm> terms, double constant_ms = 1.0, bool pixels_capped = false) {
    std::sort(terms.begin(), terms.end(),
              [&](const auto& a, const auto& b) { return hierarchy.rank[a.object] < hierarchy.rank[b.object]; });
    Cpv cpv;
    cpv.cell = cell;
    cpv.interval = static_cast<std::uint32_t>(subdivision.cpvs.size());
    cpv.pixels_capped = pixels_capped;
    cpv.constant_ms = constant_ms;
    cpv.predicted_ms = constant_ms;
    cpv.first_term = subdivision.terms.size();
    cpv.term_count = static_cast<std::uint32_t>(terms.size());
    for (const auto& term : terms) cpv.predicted_ms += term.predicted_ms;
    subdivision.terms.insert(subdivision.terms.end(), terms.begin(), terms.end());
    subdivision.cpvs.push_back(cpv);
  }
};

/// 0.01 ms a draw, 1 us a triangle, 1 ns an impostor pixel, no cap.
inline ToyWorld empty_toy_world() {
  ToyWorld world;
  world.model.milliseconds_per_unit[static_cast<std::size_t>(Term::kDraws)] = 0.01;
  world.model.milliseconds_per_unit[static_cast<std::size_t>(Term::kTriangles)] = 1e-3;
  world.model.milliseconds_per_unit[static_cast<std::size_t>(Term::kImpostorQuads)] = 2e-3;
  world.model.milliseconds_per_unit[static_cast<std::size_t>(Term::kImpostorPixels)] = 1e-6;
  world.model.bound_steps = {{std::numeric_limits<double>::infinity(), 1.0}};
  return world;
}

/// A plan seen from above, x to the right and z down, `tile_m` a character: letters are objects of 3/4 of a tile (2 m high, each 4 ms),
/// digits are cells of one tile, eyes at 1.7 m. Every cell has one CPV, which sees every object.
inline ToyWorld ascii_world(const std::vector<std::string_view>& plan, double tile_m) {
  ToyWorld world = empty_toy_world();
  const auto tile = [&](std::size_t x, std::size_t z) { return Vec3(static_cast<double>(x), 0.0, static_cast<double>(z)) * tile_m; };
  for (std::size_t z = 0; z < plan.size(); ++z)
    for (std::size_t x = 0; x < plan[z].size(); ++x)
      if (std::isalpha(plan[z][x]) != 0)
        world.add_object({tile(x, z) + Vec3(0.125 * tile_m, 0.0, 0.125 * tile_m), tile(x, z) + Vec3(0.875 * tile_m, 2.0, 0.875 * tile_m)});
  world.finish_objects();
  std::vector<RegionTerm> terms;
  for (std::uint32_t object = 0; object < world.scene.objects.size(); ++object) terms.push_back({object, 4.0});
  for (std::size_t x = 0; x < plan.front().size(); ++x) {
    for (std::size_t z = 0; z < plan.size(); ++z) {
      if (std::isdigit(plan[z][x]) == 0) continue;
      const auto cell = world.add_cell({5, {static_cast<int>(x), 0, static_cast<int>(z)}},
                                       {tile(x, z) + Vec3(0.0, 1.7, 0.0), tile(x, z) + Vec3(tile_m, 1.7, tile_m)});
      world.add_cpv(cell, terms);
    }
  }
  return world;
}

/// Objects scattered about the origin, cells around them, each with a few CPVs that see some of the objects.
inline ToyWorld random_world(std::uint64_t seed, std::uint32_t objects, std::uint32_t cells) {
  Rng rng(seed);
  ToyWorld world = empty_toy_world();
  const auto point = [&](double reach) { return Vec3(rng.uniform(-reach, reach), rng.uniform(0.0, 5.0), rng.uniform(-reach, reach)); };
  for (std::uint32_t i = 0; i < objects; ++i) {
    const Vec3 low = point(20.0);
    world.add_object({low, low + Vec3(rng.uniform(0.5, 4.0), rng.uniform(0.5, 4.0), rng.uniform(0.5, 4.0))});
  }
  world.finish_objects();
  for (std::uint32_t c = 0; c < cells; ++c) {
    const Vec3 low = point(150.0);
    const auto cell = world.add_cell({6, {static_cast<int>(c), 0, 0}}, {low, low + Vec3(10.0, 0.3, 10.0)});
    for (std::uint64_t i = rng.below(3); i < 3; ++i) {
      std::vector<RegionTerm> terms;
      for (std::uint32_t object = 0; object < objects; ++object)
        if (rng.uniform() < 0.6) terms.push_back({object, rng.uniform(0.0, 0.5)});
      world.add_cpv(cell, terms, 0.5, rng.uniform() < 0.5);
    }
  }
  return world;
}

}  // namespace standin::test
