// Every promise of a placement, broken one at a time: check names that one and no other.
//
// A tree (1.2 ms) on the ground (0.002 ms) stands 95 m to the east of a view space of two cells; any region that may see the tree is over
// the budget of 1 ms, and an impostor of three quads (0.006 ms) stands for it.
#include "placement/check/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "placement/view_space/subdivision.h"
#include "tests/support/ascii_world.h"

namespace standin {
namespace {

constexpr double kTree_ms = 1.2, kGround_ms = 0.002, kImpostor_ms = 0.006, kPageSwitch_ms = 0.01;
constexpr std::uint32_t kTree = 1;

TimeModel time_model() {
  TimeModel model = test::triangle_time_model();
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kTextureSwitches)] = kPageSwitch_ms;
  return model;
}

PlacementImpostor tree_impostor(const ViewSpace& space) {
  PlacementImpostor impostor;
  impostor.objects = {kTree};
  impostor.view_cell = space.bounds();
  impostor.frame.reference_viewpoint = {1.0, 1.7, 5.0};
  impostor.frame.forward = {1.0, 0.0, 0.0};
  impostor.frame.right = {0.0, 0.0, 1.0};
  impostor.frame.slope_step = {0.001, 0.001};
  impostor.layers = {{90.0, 88.0, 97.0}};
  impostor.quads = 3;
  impostor.texels = 100;
  impostor.texture_bytes = 480;
  impostor.geometry_bytes = 300;
  return impostor;
}

struct Checked {
  Scene scene = test::ascii_world({".........T"});
  std::vector<std::uint32_t> rank = test::identity_rank(scene);
  TimeModel model = time_model();
  Camera camera;
  ViewSpaceOptions options{.leaf_m = 4.0, .refine_levels = 0, .interval_deg = 22.5};
  ViewSpace space = make_box_view_space({{{1, 1.6, 3}, {9, 1.8, 7}}}, options);
  double budget_ms = 1.0;
  Placement placement;

  Checked() {
    SubdivisionOptions over_budget;
    over_budget.predicted_budget_ms = budget_ms;
    const Subdivision subdivision = subdivide(scene, rank, space, {}, model, camera, options, over_budget, {});
    for (const auto& cell : subdivision.cells) placement.cells.push_back({cell.key, cell.box, cell.visible_set});
    placement.intervals = subdivision.intervals;
    placement.impostors = {tree_impostor(space)};
    for (const auto& cpv : subdivision.cpvs) {
      const double ground_ms = cpv.term_count == 2 ? kGround_ms : 0.0;
      placement.cpvs.push_back({cpv.cell, cpv.interval, kTree_ms + ground_ms, ground_ms + kImpostor_ms + kPageSwitch_ms, true, {0}});
    }
  }

  [[nodiscard]] CheckReport check(int threads = 1) const {
    const CheckInput input{scene, rank, model, camera, space, options, budget_ms, 1, {.error_m_per_m = 0.5}};
    return check_placement(input, placement, threads, {});
  }
};

std::vector<std::string> sentences(const CheckReport& report) {
  std::vector<std::string> list;
  for (const auto& finding : report.findings) list.push_back(std::string(violation_name(finding.violation)) + ": " + finding.sentence);
  return list;
}

TEST(Check, APlacementThatKeepsItsPromisesHasNoFindings) {
  const Checked world;
  ASSERT_EQ(world.placement.cells.size(), 2U);
  ASSERT_GT(world.placement.cpvs.size(), 10U);
  const CheckReport report = world.check();
  EXPECT_THAT(sentences(report), testing::IsEmpty());
  EXPECT_EQ(report.cpvs, world.placement.cpvs.size());
  EXPECT_EQ(report.solved, report.cpvs);
  EXPECT_GT(report.regions, report.cpvs);
  EXPECT_EQ(report.texture_bytes, 480U);
  EXPECT_EQ(report.geometry_bytes, 300U);
  EXPECT_DOUBLE_EQ(report.worst_bound_after_ms, kGround_ms + kImpostor_ms + kPageSwitch_ms);
}

constexpr std::uint32_t kCpv = 3;

struct Tampering {
  Violation violation;
  std::uint32_t index;
  std::string name;
  std::function<void(Checked&)> apply;
};

void PrintTo(const Tampering& tampering, std::ostream* stream) {
  *stream << tampering.name;
}

PlacementCpv& cpv(Checked& world) {
  return world.placement.cpvs[kCpv];
}

// The same impostor again; its quads are paid for, so that bounds stay right.
void draw_twice(Checked& world) {
  world.placement.impostors.push_back(world.placement.impostors[0]);
  cpv(world).impostors = {0, 1};
  cpv(world).bound_after_ms += kImpostor_ms;
}

void draw_none(Checked& world) {
  cpv(world).impostors.clear();
  cpv(world).bound_after_ms = cpv(world).bound_before_ms;
}

// Its own impostor, good for the other cell only.
void stand_for_the_other_cell(Checked& world) {
  world.placement.impostors.push_back(world.placement.impostors[0]);
  world.placement.impostors[1].view_cell = world.placement.cells[1 - cpv(world).cell].box;
  cpv(world).impostors = {1};
}

const std::vector<Tampering> kTamperings = {
    {Violation::kCellBox, 1, "cell_box", [](Checked& w) { w.placement.cells[1].box.max.y -= 0.05; }},
    {Violation::kBoundBefore, kCpv, "bound_before", [](Checked& w) { cpv(w).bound_before_ms *= 1.0 - 1e-6; }},
    {Violation::kBoundAfter, kCpv, "bound_after", [](Checked& w) { cpv(w).bound_after_ms *= 1.0 - 1e-6; }},
    {Violation::kOverBudget, kCpv, "over_budget", draw_none},
    {Violation::kNotSolved, kCpv, "not_solved", [](Checked& w) { cpv(w).solved = false; }},
    {Violation::kNotDisjoint, kCpv, "not_disjoint", draw_twice},
    {Violation::kNotEnclosed, kCpv, "not_enclosed", stand_for_the_other_cell},
    {Violation::kLevels, kTree, "levels",
     [](Checked& w) {
       w.placement.levels = {{kTree, {Vec3(0.0), Vec3(1.0)}, {30.0}}};
     }},
    {Violation::kMissingRegion, 0, "missing_region", [](Checked& w) { w.placement.cpvs.erase(w.placement.cpvs.begin()); }},
};

class CheckTampering : public testing::TestWithParam<Tampering> {};

TEST_P(CheckTampering, IsFoundAndNothingElse) {
  Checked world;
  GetParam().apply(world);
  const CheckReport report = world.check();
  ASSERT_EQ(report.findings.size(), 1U) << testing::PrintToString(sentences(report));
  EXPECT_EQ(report.findings[0].violation, GetParam().violation) << sentences(report)[0];
  EXPECT_EQ(report.findings[0].index, GetParam().index) << sentences(report)[0];
  EXPECT_EQ(violation_name(report.findings[0].violation), GetParam().name);
}

INSTANTIATE_TEST_SUITE_P(All, CheckTampering, testing::ValuesIn(kTamperings), [](const auto& entry) { return entry.param.name; });

TEST(Check, AnUnsolvedRegionIsNoViolationWhenItSaysSo) {
  Checked world;
  draw_none(world);
  cpv(world).solved = false;
  const CheckReport report = world.check();
  EXPECT_THAT(sentences(report), testing::IsEmpty());
  EXPECT_EQ(report.solved + 1, report.cpvs);
}

TEST(Check, LastBitsOfAnotherBuildAreNoViolation) {
  Checked world;
  cpv(world).bound_before_ms *= 1.0 + 1e-12;
  cpv(world).bound_after_ms *= 1.0 - 1e-12;
  EXPECT_THAT(sentences(world.check()), testing::IsEmpty());
}

TEST(Check, ALowerBudgetIsMissedByEveryRegionThatSeesAnything) {
  Checked world;
  world.budget_ms = 0.001;
  const CheckReport report = world.check();
  const auto of = [&](Violation violation) {
    return std::ranges::count_if(report.findings, [&](const auto& finding) { return finding.violation == violation; });
  };
  EXPECT_EQ(of(Violation::kOverBudget), report.cpvs);
  EXPECT_GT(of(Violation::kMissingRegion), 0);  // those that see the ground alone
  EXPECT_EQ(of(Violation::kOverBudget) + of(Violation::kMissingRegion), static_cast<std::ptrdiff_t>(report.findings.size()));
}

TEST(Check, AViewCellThatReachesItsLayersIsNamed) {
  Checked world;
  world.placement.impostors[0].view_cell = Box{{0, 0, 0}, {95, 10, 10}};
  const CheckReport report = world.check();
  ASSERT_EQ(report.findings.size(), 1U) << testing::PrintToString(sentences(report));
  EXPECT_EQ(report.findings[0].violation, Violation::kLayerInViewCell);
  EXPECT_THAT(report.findings[0].sentence, testing::StartsWith("impostor 0: "));
}

// With triangles off screen cheaper than those on it, what lies behind a view tells the two apart.
TEST(Check, BoundsAreThoseThatThePlacementWasMadeWith) {
  Checked world;
  world.model = test::full_time_model();
  const CheckReport by_sample = world.check();
  world.options.bounds = RegionBounds::kByObject;
  const CheckReport by_object = world.check();
  EXPECT_NE(sentences(by_sample), sentences(by_object));
}

// The tree at half its triangles from 20 m on: its regions' bounds fall, and what is shown must be as stated, and no farther off.
TEST(Check, LevelsOfDetailCountAndAreHeldAgainstTheScenes) {
  Checked world;
  Object& tree = world.scene.objects[kTree];
  Mesh simple = world.scene.meshes[world.scene.parts[tree.first_part].mesh];
  simple.indices.resize(simple.indices.size() / 6 * 3);
  simple.simplified_from = static_cast<std::int32_t>(world.scene.parts[tree.first_part].mesh);
  tree.levels.push_back({static_cast<std::uint32_t>(world.scene.parts.size()), 1, simple.triangle_count(), 10.0, -1.0, 20.0});
  world.scene.parts.push_back({static_cast<std::uint32_t>(world.scene.meshes.size()), world.scene.parts[tree.first_part].material});
  world.scene.meshes.push_back(std::move(simple));
  world.placement.levels = placement_levels(world.scene);
  for (auto& one : world.placement.cpvs) one.bound_before_ms -= 0.5 * kTree_ms;
  EXPECT_THAT(sentences(world.check()), testing::IsEmpty());

  tree.levels[0].least_distance_m = 1e-3;
  EXPECT_THAT(sentences(world.check()), testing::Contains(testing::StartsWith("levels: object 1: level 1: is shown from 0.001")));
  tree.levels[0].least_distance_m = 20.0;
  tree.levels[0].error_m = 0.01;
  EXPECT_THAT(sentences(world.check()), testing::ElementsAre(testing::StartsWith("levels: object 1: level 1: its surface lies within")));
  tree.levels[0].error_m = 10.0;
  world.placement.levels[0].bounds.max.x += 1e-9;
  EXPECT_THAT(sentences(world.check()), testing::ElementsAre("levels: object 1: bounds differ from the scene's"));
}

TEST(Check, FindingsDoNotDependOnThreads) {
  Checked world;
  world.budget_ms = 0.001;
  EXPECT_EQ(sentences(world.check(1)), sentences(world.check(4)));
}

}  // namespace
}  // namespace standin
