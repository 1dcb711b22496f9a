#include "server/job/metrics.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/ascii_world.h"

namespace standin {
namespace {

TimeModel draws_and_triangles_on_screen() {
  TimeModel model;
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kDraws)] = 0.1;
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kOnScreenTriangles)] = 0.001;
  return model;
}

// Of the eye between trees, a region sees some and some of their triangles: shares are of what its terms sum up, not of all around.
TEST(Causes, AreSharesOfTheSlowestRegionsOwnTime) {
  const TimeModel model = draws_and_triangles_on_screen();
  World world;
  world.scene = test::ascii_world({"TTTTT", "T...T", "T...T", "T...T", "TTTTT"});
  const ViewSpace space = make_box_view_space({{{23, 1.6, 23}, {27, 1.8, 27}}}, {});
  SubdivisionOptions every_region;
  every_region.predicted_budget_ms = -1.0;
  const Subdivision found = subdivide(world.scene, test::identity_rank(world.scene), space, {}, model, world.camera, {}, every_region, {});
  ASSERT_EQ(found.cells.size(), 1U);
  const auto slowest = std::ranges::max_element(found.cpvs, {}, &Cpv::predicted_ms);
  double total_ms = 0.0;
  for (const RegionTerm& term : found.terms_of(*slowest)) total_ms += term.predicted_ms;
  const double draws_ms = 0.1 * static_cast<double>(found.terms_of(*slowest).size());
  ASSERT_GT(total_ms, draws_ms);
  const auto per_cell = causes_per_cell(world, found, model, {});
  const auto causes = causes_json(world, per_cell);
  EXPECT_NEAR(causes["draws_share"].get<double>(), draws_ms / total_ms, 1e-9);
  EXPECT_NEAR(causes["triangles_share"].get<double>(), 1.0 - draws_ms / total_ms, 1e-9);
  const auto cause = heat_map_json(world, found, per_cell, nullptr, model).at(0).at("cause");  // of the only cell: the same region
  EXPECT_EQ(cause["draws_share"], causes["draws_share"]);
  ASSERT_EQ(cause["objects"].size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(cause["objects"][i], causes["objects"][i]);
}

}  // namespace
}  // namespace standin
