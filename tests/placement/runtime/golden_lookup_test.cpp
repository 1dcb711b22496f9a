// The lookup that ships, read into by hand as an engine would, and the program's own form of it, against the queries that the TypeScript
// module answers too.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "placement/runtime/placement.h"
#include "render/base/placement_lookup.h"
#include "tests/support/golden.h"

namespace standin {
namespace {

using nlohmann::json;

constexpr const char* kFile = "placement_lookup.json";

LookupVector vector_of(const json& value) {
  return value.get<LookupVector>();
}
Vec3 to_vec3(const json& value) {
  return {value[0], value[1], value[2]};
}
std::optional<std::uint32_t> id_of(const json& value) {
  return value.is_null() ? std::nullopt : std::optional<std::uint32_t>(value.get<std::uint32_t>());
}

int face_of(const std::string& name) {
  const std::string order = "+x-x+y-y+z-z";
  return static_cast<int>(order.find(name) / 2);
}

struct EngineArrays {
  std::vector<LookupCell> cells;
  std::vector<LookupInterval> intervals;
  std::vector<LookupCpv> cpvs;
  PlacementView view;

  explicit EngineArrays(const json& placement) {
    for (const auto& cell : placement.at("cells"))
      cells.push_back({cell.at("level"), cell.at("index"), vector_of(cell.at("min")), vector_of(cell.at("max"))});
    for (const auto& interval : placement.at("intervals"))
      intervals.push_back({face_of(interval.at("face")), interval.at("level"), interval.at("index")});
    for (const auto& cpv : placement.at("cpvs")) cpvs.push_back({cpv.at("cell"), cpv.at("interval")});
    const auto& root = placement.at("view_space").at("root");
    view = {vector_of(root.at("min")), root.at("side"), cells, intervals, cpvs, levels_in_use(intervals)};
  }
};

Placement read_by_hand(const json& file) {
  Placement placement;
  const auto& root = file.at("view_space").at("root");
  placement.root_min = to_vec3(root.at("min"));
  placement.root_side_m = root.at("side");
  for (const auto& cell : file.at("cells")) {
    placement.cells.push_back({{cell.at("level"), cell.at("index")}, {to_vec3(cell.at("min")), to_vec3(cell.at("max"))}, -1});
    if (cell.at("visible_objects").is_null()) continue;
    placement.cells.back().visible_set = static_cast<std::int32_t>(placement.visible_sets.size());
    placement.visible_sets.push_back(cell.at("visible_objects"));
  }
  for (const auto& entry : file.at("intervals"))
    placement.intervals.push_back(
        {static_cast<Face>(face_of(entry.at("face"))), entry.at("level"), entry.at("index")[0], entry.at("index")[1]});
  for (const auto& entry : file.at("cpvs"))
    placement.cpvs.push_back({entry.at("cell"), entry.at("interval"), 0.0, 0.0, entry.at("solved"), entry.at("impostors")});
  for (const auto& entry : file.at("impostors"))
    placement.impostors.emplace_back().objects = entry.at("objects").get<std::vector<std::uint32_t>>();
  for (const auto& entry : file.at("lods").at("objects")) {
    const auto& bounds = file.at("scene").at("objects").at(entry.at("object").get<std::size_t>()).at("bounds");
    PlacementLevels levels{entry.at("object"), {to_vec3(bounds.at("min")), to_vec3(bounds.at("max"))}, {}};
    for (const auto& level : entry.at("levels")) levels.least_distance_m.push_back(level.at("least_distance"));
    placement.levels.push_back(std::move(levels));
  }
  return placement;
}

TEST(PlacementLookup, AnswersAsWorkedOutByHand) {
  const json cases = test::golden_cases(kFile);
  const EngineArrays arrays(test::golden_file(kFile).at("placement"));
  for (const auto& query : cases) {
    const Lookup found = find_cell(arrays.view, vector_of(query.at("position")), vector_of(query.at("direction")));
    EXPECT_EQ(found.cell, id_of(query.at("cell"))) << query;
    EXPECT_EQ(found.cpv, id_of(query.at("cpv"))) << query;
  }
}

TEST(PlacementLookup, TheProgramsOwnFormAnswersTheSameAndDrawsWhatIsNamed) {
  const json cases = test::golden_cases(kFile);
  const json file = test::golden_file(kFile).at("placement");
  const Placement placement = read_by_hand(file);
  const PlacementIndex index(placement);
  const auto object_count = static_cast<std::uint32_t>(file.at("scene").at("objects").size());
  for (const auto& query : cases) {
    const Lookup found = index.find(to_vec3(query.at("position")), to_vec3(query.at("direction")));
    EXPECT_EQ(found.cell, id_of(query.at("cell"))) << query;
    EXPECT_EQ(found.cpv, id_of(query.at("cpv"))) << query;
    if (!query.contains("objects")) continue;
    ViewContent content = content_of(placement, found, object_count);
    content.levels.resize(content.objects.size());  // none: all show their own parts
    EXPECT_EQ(json(content.objects), query.at("objects")) << query;
    EXPECT_EQ(json(content.levels), query.at("levels")) << query;
    EXPECT_EQ(json(content.impostors), query.at("impostors")) << query;
  }
}

}  // namespace
}  // namespace standin
