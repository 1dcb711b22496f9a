#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "placement/view_space/ground.h"
#include "placement/view_space/view_space.h"
#include "render/base/error.h"
#include "tests/support/ascii_world.h"

namespace standin {
namespace {

// Heights drawn as digits in metres; '.' is no surface. Returns a drawing of the ground: 'g', else '-'.
std::vector<std::string> draw_ground(const std::vector<std::string>& heights, double max_rise_m) {
  HeightField field;
  field.width = static_cast<int>(heights.front().size());
  field.depth = static_cast<int>(heights.size());
  field.spacing_m = 1.0;
  for (const std::string& row : heights)
    for (const char digit : row) field.height_m.push_back(digit == '.' ? HeightField::kNone : digit - '0');
  const auto ground = find_ground(field, max_rise_m);
  std::vector<std::string> drawing = heights;
  for (int z = 0; z < field.depth; ++z)
    for (int x = 0; x < field.width; ++x)
      drawing[static_cast<std::size_t>(z)][static_cast<std::size_t>(x)] = ground[field.at(x, z)] ? 'g' : '-';
  return drawing;
}

TEST(Ground, RoofsAreNotGroundAndCourtyardsAre) {
  EXPECT_THAT(draw_ground({"00000000", "09999900", "09009900", "09999900", "00000000"}, 1.0),
              testing::ElementsAre("gggggggg", "g-----gg", "g-gg--gg", "g-----gg", "gggggggg"));
}

TEST(Ground, ATerraceInACourtyardIsGroundARoofThereIsNot) {
  EXPECT_THAT(draw_ground({"00000000", "99999990", "91939190", "99999990", "00000000"}, 1.0),
              testing::ElementsAre("gggggggg", "-------g", "-g---g-g", "-------g", "gggggggg"));
}

TEST(Ground, HillsAreGroundHoweverHigh) {
  EXPECT_THAT(draw_ground({"0123456789", "0123956789"}, 1.0), testing::ElementsAre("gggggggggg", "gggg-ggggg"));
}

TEST(Ground, HollowsAreGroundAndTheirWallsDoNotMatter) {
  EXPECT_THAT(draw_ground({"55555", "52225", "52725", "55555"}, 1.0), testing::ElementsAre("ggggg", "ggggg", "gg-gg", "ggggg"));
}

TEST(Ground, NoSurfaceIsNoGroundButDoesNotCutOff) {
  EXPECT_THAT(draw_ground({"000..0..9"}, 1.0), testing::ElementsAre("ggg--g---"));
  EXPECT_THAT(draw_ground({"...."}, 1.0), testing::ElementsAre("----"));
}

bool holds(const ViewSpace& space, const Vec3& position) {
  return std::any_of(space.boxes.begin(), space.boxes.end(), [&](const Box& box) { return box.contains(position); });
}

double floor_area(const ViewSpace& space) {
  double area = 0.0;
  for (const Box& box : space.boxes) area += box.size().x * box.size().z;
  return area;
}

ViewSpace walk(const Scene& scene, const ViewSpaceOptions& options = {}, int threads = 1) {
  return make_walk_view_space(scene, Raytracer(scene), options, threads);
}

TEST(Walk, PeopleStandOnThePlaneAndKeepClearOfTheHouse) {
  const ViewSpace space = walk(test::ascii_world({".......", ".......", "..###..", "..###..", ".......", "......."}));
  EXPECT_TRUE(holds(space, {10, 1.7, 30}));
  EXPECT_FALSE(holds(space, {35, 9.7, 30}));  // on the roof
  EXPECT_FALSE(holds(space, {35, 1.7, 30}));  // inside
  const Box house{{20, 0, 20}, {50, 8, 40}};
  for (const Box& box : space.boxes) {
    EXPECT_NEAR(box.min.y, 1.6, 1e-12);
    EXPECT_NEAR(box.max.y, 1.8, 1e-12);
    EXPECT_GE(distance(box, house), 0.3);
  }
  // 4,200 m^2 less the house and a margin of at most one and a half squares around it, and less than a square more at the edges.
  EXPECT_GT(floor_area(space), 4200.0 - 34.4 * 24.4);
  EXPECT_LT(floor_area(space), 71.5 * 61.5 - 30.6 * 20.6);
  EXPECT_LE(space.boxes.size(), 8U);  // merged
}

TEST(Walk, BoxesDoNotOverlapAndStartOnTheFinestGrid) {
  const ViewSpace space = walk(test::ascii_world({"..T..", ".T.#.", "o...."}));
  double volume = 0.0;
  for (std::size_t i = 0; i < space.boxes.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Box common = intersection(space.boxes[i], space.boxes[j]);
      if (!common.empty()) volume += common.size().x * common.size().y * common.size().z;
    }
  EXPECT_EQ(volume, 0.0);
  for (const Box& box : space.boxes) {
    const double squares = (box.min.x - space.root_min.x) / (23.0 / 16.0);
    EXPECT_NEAR(squares, std::round(squares), 1e-9);
  }
}

TEST(Walk, TopsOfLowObjectsAreNotGround) {
  const ViewSpace space = walk(test::ascii_world({"...", ".o.", "..."}));
  EXPECT_FALSE(holds(space, {15, 3.7, 15}));
  EXPECT_LT(space.bounds().max.y, 2.0);
}

TEST(Walk, CourtyardsCount) {
  EXPECT_TRUE(holds(walk(test::ascii_world({".....", ".###.", ".#.#.", ".###.", "....."})), {25, 1.7, 25}));
}

TEST(Walk, EyesFollowAHill) {
  Scene scene;
  test::add_material(scene, {});
  Mesh slope = test::make_ground(200, 50);
  slope.positions[1].y = slope.positions[2].y = 20.0F;  // 10 %
  test::add_object(scene, test::add_mesh(scene, slope), 0);
  update_derived(scene);
  const ViewSpace space = walk(scene);
  EXPECT_NEAR(floor_area(space), 200 * 50, 500);
  for (const Box& box : space.boxes) {
    EXPECT_LE(box.min.y, 0.1 * box.min.x + 1.7);
    EXPECT_GE(box.max.y, 0.1 * (box.max.x - 1.5) + 1.7);
    EXPECT_LE(box.size().y, 0.2 + 0.6);  // one column of 5.75 m
  }
}

TEST(Walk, TheSameForAnyNumberOfThreads) {
  const Scene scene = test::ascii_world({"..T..", ".T.#.", "o...."});
  EXPECT_EQ(walk(scene, {}, 1).boxes, walk(scene, {}, 3).boxes);
}

TEST(Walk, ASceneWithoutASurfaceToStandOnIsRefused) {
  Scene scene;
  test::add_material(scene, {});
  test::add_object(scene, test::add_mesh(scene, test::make_rectangle(0, 0, 30, 10, 0)), 0);  // one wall
  update_derived(scene);
  try {
    (void)walk(scene);
    FAIL() << "a wall cannot be stood on";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kViewSpaceEmpty);
  }
}

}  // namespace
}  // namespace standin
