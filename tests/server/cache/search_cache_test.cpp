#include "server/cache/search_cache.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/support/ascii_world.h"
#include "tests/support/same_subdivision.h"
#include "tests/support/temp_folder.h"

namespace standin {
namespace {

/// Some cells of a small town, half of which cannot see the last house.
struct Town {
  Scene scene = test::ascii_world({"#..T#.", "..o...", "T.#.T.", "...o.#"});
  ViewSpaceOptions options = small_options();
  ViewSpace space =
      make_box_view_space({{{10, 1.6, 0}, {30, 1.8, 10}}, {{0, 1.6, 10}, {60, 1.8, 20}}, {{30, 1.6, 20}, {40, 1.8, 40}}}, options);
  Camera camera;
  TimeModel model = test::full_time_model();
  std::vector<std::uint32_t> rank = test::identity_rank(scene);
  Visibility visibility = half_blind();

  static ViewSpaceOptions small_options() {
    ViewSpaceOptions options;
    options.leaf_m = 20.0;
    options.refine_levels = 1;
    options.interval_deg = 22.5;
    return options;
  }
  [[nodiscard]] Visibility half_blind() const {
    Visibility result;
    result.cells = leaf_keys(space);
    for (std::size_t i = 0; i < result.cells.size(); ++i) {
      result.sets.push_back(test::identity_rank(scene));
      if (i % 2 == 0) result.sets.back().pop_back();
    }
    return result;
  }
  [[nodiscard]] Subdivision subdivide_for(double budget_ms, SearchMemory* memory) const {
    SubdivisionOptions asked;
    asked.threads = 2;
    asked.predicted_budget_ms = budget_ms;
    return subdivide(scene, rank, space, visibility, model, camera, options, asked, {}, memory);
  }
  [[nodiscard]] SearchScene job() const { return {scene, rank, visibility, model, camera, options}; }
};

class SearchCaches : public test::TempFolder {
 protected:
  /// A job of its own over the folder.
  Subdivision subdivide_for(const Town& town, double budget_ms) {
    StageCache cache(root_, fingerprint_of("build"));
    SearchCache searches(cache, town.job());
    Subdivision found = town.subdivide_for(budget_ms, &searches);
    counts_ = cache.figures().stages["searches"];
    return found;
  }

  CacheCounts counts_;
};

TEST_F(SearchCaches, JobsOfAnyBudgetFindTheSameWithAndWithout) {
  const Town town;
  const double worst = town.subdivide_for(1e9, nullptr).worst_predicted_ms;
  std::set<std::size_t> cpvs;
  for (const double share : {0.8, 0.5, 0.9, 0.65, 0.5, 0.3, 1.1}) {
    const Subdivision fresh = town.subdivide_for(share * worst, nullptr);
    cpvs.insert(fresh.cpvs.size());
    test::expect_same(subdivide_for(town, share * worst), fresh);
  }
  EXPECT_GE(cpvs.size(), 5U);
}

TEST_F(SearchCaches, ATighterJobsEntriesServeLooserOnes) {
  const Town town;
  const double worst = town.subdivide_for(1e9, nullptr).worst_predicted_ms;
  static_cast<void>(subdivide_for(town, 0.5 * worst));
  const std::uint64_t searched = counts_.misses;
  EXPECT_GT(searched, town.visibility.cells.size());
  EXPECT_EQ(counts_.hits, 0U);
  static_cast<void>(subdivide_for(town, 0.5 * worst));
  EXPECT_EQ(counts_.hits, searched);
  EXPECT_EQ(counts_.misses, 0U);
  static_cast<void>(subdivide_for(town, 0.7 * worst));
  EXPECT_GT(counts_.hits, 0U);
  EXPECT_EQ(counts_.misses, 0U);
  static_cast<void>(subdivide_for(town, 0.4 * worst));
  EXPECT_GT(counts_.misses, 0U) << "tighter: searched again";
}

// What half of the leaves cannot see concerns the other half alone; all numbers after it shift.
TEST_F(SearchCaches, AnObjectThatACellCannotSeeDoesNotConcernIt) {
  const Town before;
  const double budget_ms = 0.5 * before.subdivide_for(1e9, nullptr).worst_predicted_ms;
  static_cast<void>(subdivide_for(before, budget_ms));
  const std::uint64_t searched = counts_.misses;
  Town after;
  const auto last = static_cast<std::uint32_t>(after.scene.objects.size() - 1);
  std::rotate(after.scene.objects.begin(), after.scene.objects.end() - 1, after.scene.objects.end());  // now the first
  after.scene.objects.front().world_from_object[3].y += 1.0;
  update_derived(after.scene);
  for (std::uint32_t id = 0; id <= last; ++id) after.rank[id] = (id + last) % (last + 1);  // in the hierarchy, where it was
  for (auto& set : after.visibility.sets) {
    const bool sees_it = set.size() > last;
    set.clear();
    for (std::uint32_t id = sees_it ? 0 : 1; id <= last; ++id) set.push_back(id);
  }
  test::expect_same(subdivide_for(after, budget_ms), after.subdivide_for(budget_ms, nullptr));
  EXPECT_GT(counts_.hits, 0U);
  EXPECT_GT(counts_.misses, 0U);
  EXPECT_LT(counts_.misses, searched);
}

Fingerprint inputs_of(const Town& town, const SearchRequest& request, StageCache& cache) {
  return SearchCache(cache, town.job()).inputs_of(request);
}

TEST_F(SearchCaches, EveryInputMattersAndTheBudgetAndColoursDoNot) {
  StageCache cache(root_, fingerprint_of("build"));
  const std::vector<Box> chain = {{Vec3(0.0), Vec3(1.0)}, {Vec3(0.0), Vec3(2.0)}};
  const SearchRequest request{{3, {1, 2, 3}}, 5.0, chain, 1};
  const Fingerprint plain = inputs_of({}, request, cache);
  const auto after = [&](const std::function<void(Town&)>& change) {
    Town town;
    change(town);
    return inputs_of(town, request, cache);
  };
  EXPECT_EQ(inputs_of({}, {{2, {0, 0, 0}}, 9.0, chain, 1}, cache), plain) << "neither the cell's number nor the budget";
  EXPECT_EQ(after([](Town& t) { t.scene.materials[0].base_colour.r = 0.25F; }), plain);
  EXPECT_EQ(after([](Town& t) { t.model.bound_steps.clear(); }), plain) << "only turns the budget into a predicted one";

  const std::vector<Box> longer = {chain[0], chain[1], {Vec3(0.0), Vec3(4.0)}};
  std::vector<Fingerprint> all = {plain, inputs_of({}, {{}, 5.0, longer, 1}, cache),
                                  inputs_of({}, {{}, 5.0, std::span(longer).subspan(1), 1}, cache),
                                  inputs_of({}, {{}, 5.0, chain, 0}, cache)};
  for (const auto& change : std::vector<std::function<void(Town&)>>{
           [](Town& t) { t.camera.width = 256; },
           [](Town& t) { t.camera.height = 256; },
           [](Town& t) { t.camera.fov_y_rad = 0.5; },
           [](Town& t) { t.camera.near_m = 0.2; },
           [](Town& t) { t.options.interval_deg = 11.25; },
           [](Town& t) { t.options.bounds = RegionBounds::kByObject; },
           [](Town& t) { t.model.milliseconds_per_unit[0] *= 2.0; },
           [](Town& t) { t.model.combination = Combination::kMax; },
           [](Town& t) { std::swap(t.rank[2], t.rank[3]); },
           [](Town& t) { t.visibility.sets[1].erase(t.visibility.sets[1].begin()); },
           [](Town& t) { t.scene.objects[2].bounds.max.y += 1.0; },
           [](Town& t) { t.scene.objects[2].world_from_object[3].x += 0.5; },
           [](Town& t) { t.scene.materials[0].double_sided = !t.scene.materials[0].double_sided; },
       })
    all.push_back(after(change));
  EXPECT_EQ(std::set<Fingerprint>(all.begin(), all.end()).size(), all.size());
  // A texture elsewhere in the scene: what all pixels of a frame may cost.
  EXPECT_NE(after([](Town& t) {
              Mesh pane = test::make_rectangle(0.0, 0.0, 1.0, 1.0, 0.0);
              t.scene.textures.push_back(test::make_texture(2, 2, [](int, int) { return std::array<std::uint8_t, 4>{1, 2, 3, 255}; }));
              Material painted;
              painted.texture = static_cast<std::int32_t>(t.scene.textures.size() - 1);
              test::add_object(t.scene, test::add_mesh(t.scene, pane), test::add_material(t.scene, painted));
              t.rank = test::identity_rank(t.scene);
            }),
            plain);
}

}  // namespace
}  // namespace standin
