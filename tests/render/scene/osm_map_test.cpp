#include "render/scene/osm_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/render/scene/temporary_folder.h"
#include "tests/render/scene/tile_maker.h"

namespace standin {
namespace {

using test::rectangle;
using test::reversed;
using test::TemporaryFolder;
using test::TileMaker;

// At zoom 14 and the equator a tile is 2446 m wide; 2446 units to a tile make a unit a metre but for 1 part in 12,000.
constexpr std::uint32_t kExtent = 2446;
constexpr const char* kName = "14-8192-8191.mvt";

StreetMap read_one(const TileMaker& tile) {
  const TemporaryFolder folder;
  folder.write(kName, tile.bytes());
  return read_street_map(folder.path());
}

ErrorWord refusal(const std::filesystem::path& folder, const std::string& part) {
  try {
    (void)read_street_map(folder);
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find(part), std::string::npos) << failure.what();
    return failure.word();
  }
  ADD_FAILURE() << "read " << folder;
  return ErrorWord::kInternal;
}

TEST(StreetMap, BuildingsInMetresWithTheirFloorsAndYards) {
  TileMaker tile(kExtent);
  tile.polygon({{"building", "yes"}, {"building:levels", "9"}}, {rectangle(100, 100, 160, 140), reversed(rectangle(120, 110, 140, 130))});
  tile.polygon({{"building", "house"}}, {rectangle(200, 100, 210, 112)});
  tile.polygon({{"building", "no"}}, {rectangle(300, 100, 310, 112)});
  tile.polygon({{"landuse", "grass"}}, {rectangle(0, 0, 500, 500)});
  const StreetMap map = read_one(tile);
  ASSERT_EQ(map.buildings.size(), 2U);
  EXPECT_NEAR(map.buildings[0].footprint.area_m2(), 60 * 40 - 20 * 20, 1.0);
  EXPECT_EQ(map.buildings[0].floors, 9.0);
  EXPECT_EQ(map.buildings[1].floors, 1.0);
  EXPECT_EQ(map.greens.size(), 1U);
  EXPECT_EQ(map.bounds.size(), kMapSize_m);
}

// Tiles of version 1 say nothing of the winding.
TEST(StreetMap, TheFirstRingIsTheOuterOne) {
  const auto area_with = [](bool turned) {
    std::vector<test::TilePath> rings{rectangle(100, 100, 160, 140), reversed(rectangle(120, 110, 140, 130)),
                                      rectangle(170, 100, 180, 140)};
    for (auto& ring : rings) {
      if (turned) ring = reversed(ring);
    }
    return read_one(TileMaker(kExtent).polygon({{"building", "yes"}}, rings)).buildings.at(0).footprint.area_m2();
  };
  EXPECT_NEAR(area_with(false), 60 * 40 - 20 * 20 + 10 * 40, 1.0);
  EXPECT_DOUBLE_EQ(area_with(true), area_with(false));
}

TEST(StreetMap, FloorsOfABuilding) {
  EXPECT_EQ(floors_of("5", "100", 50.0), 5.0);
  EXPECT_EQ(floors_of("", "33", 50.0), 10.0);
  EXPECT_EQ(floors_of("many", "", 50.0), 1.0);
  EXPECT_EQ(floors_of("-3", "", 500.0), 2.0);
  EXPECT_EQ(floors_of("88000", "", 50.0), 120.0);
  EXPECT_EQ(floors_of("nan", "inf", 50.0), 1.0);
}

TEST(StreetMap, ABuildingOnTheBorderOfTwoTilesIsOne) {
  const TemporaryFolder folder;
  const test::Tags tags{{"building", "yes"}, {"@id", "77"}};
  const int border = kExtent;
  folder.write("14-8192-8191.mvt", TileMaker(kExtent).polygon(tags, {rectangle(border - 30, 100, border, 140)}).bytes());
  folder.write("14-8193-8191.mvt", TileMaker(kExtent).polygon(tags, {rectangle(0, 100, 20, 140)}).bytes());
  const StreetMap map = read_street_map(folder.path());
  ASSERT_EQ(map.buildings.size(), 1U);
  EXPECT_NEAR(map.buildings[0].footprint.area_m2(), 50 * 40, 1.0);
  EXPECT_EQ(map.buildings[0].footprint.polygons().size(), 1U);
}

TEST(StreetMap, ABuildingMostlyWithinAnotherIsLeftOut) {
  TileMaker tile(kExtent);
  tile.polygon({{"building", "yes"}}, {rectangle(100, 100, 160, 140)});
  tile.polygon({{"building", "roof"}}, {rectangle(110, 110, 130, 130)});
  tile.polygon({{"building", "yes"}}, {rectangle(155, 100, 200, 140)});
  EXPECT_EQ(read_one(tile).buildings.size(), 2U);
}

TEST(StreetMap, StreetsHaveWidthsAndTunnelsAreNone) {
  TileMaker tile(kExtent);
  tile.polygon({{"building", "yes"}}, {rectangle(100, 100, 160, 140)});
  tile.line({{"highway", "residential"}}, {{0, 200}, {900, 200}});
  tile.line({{"highway", "primary"}, {"lanes", "6"}}, {{0, 300}, {900, 300}});
  tile.line({{"highway", "primary"}, {"oneway", "yes"}}, {{0, 400}, {900, 400}});
  tile.line({{"highway", "footway"}}, {{0, 500}, {900, 500}});
  tile.line({{"highway", "primary"}, {"tunnel", "yes"}}, {{0, 600}, {900, 600}});
  tile.line({{"highway", "proposed"}}, {{0, 600}, {900, 600}});
  tile.line({{"railway", "rail"}}, {{0, 600}, {900, 600}});
  const StreetMap map = read_one(tile);
  ASSERT_EQ(map.streets.size(), 4U);
  EXPECT_EQ(map.streets[0].width_m, 9.0);
  EXPECT_EQ(map.streets[1].width_m, 22.0);
  EXPECT_EQ(map.streets[2].width_m, 12.0);
  EXPECT_TRUE(map.streets[2].vehicles);
  EXPECT_FALSE(map.streets[3].vehicles);
}

TEST(StreetMap, IsCutWhereTheMostFloorsAre) {
  TileMaker tile(kExtent);
  tile.polygon({{"building", "yes"}, {"building:levels", "2"}}, {rectangle(0, 0, 40, 40)});
  tile.polygon({{"building", "yes"}, {"building:levels", "30"}}, {rectangle(2300, 2300, 2340, 2340)});
  const StreetMap map = read_one(tile);
  ASSERT_EQ(map.buildings.size(), 1U);
  EXPECT_EQ(map.buildings[0].floors, 30.0);
  EXPECT_TRUE(map.bounds.holds(map.buildings[0].bounds));
}

TEST(StreetMap, RefusesWhatIsNoMap) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal(folder.path() / "absent", "absent"), ErrorWord::kFileMissing);
  EXPECT_EQ(refusal(folder.path(), "no tile"), ErrorWord::kFileMissing);
  folder.write("notes.txt", "no tile either");
  EXPECT_EQ(refusal(folder.path(), "no tile"), ErrorWord::kFileMissing);
  folder.write(kName, TileMaker().line({{"highway", "residential"}}, {{0, 0}, {100, 0}}).bytes());
  EXPECT_EQ(refusal(folder.path(), "no building"), ErrorWord::kSceneEmpty);
  const std::string whole = TileMaker(kExtent).polygon({{"building", "yes"}}, {rectangle(0, 0, 40, 40)}).bytes();
  folder.write(kName, whole.substr(0, whole.size() - 5));
  EXPECT_EQ(refusal(folder.path(), kName), ErrorWord::kFileBroken);
  folder.write(kName, "not a tile");
  EXPECT_EQ(refusal(folder.path(), kName), ErrorWord::kFileBroken);
  folder.write(kName, whole);
  folder.write("13-4096-4095.mvt", whole);
  EXPECT_EQ(refusal(folder.path(), "another zoom level"), ErrorWord::kFileBroken);
}

}  // namespace
}  // namespace standin
