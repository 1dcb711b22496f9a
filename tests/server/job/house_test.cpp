// The house's one direction: render < estimation < placement < server, and each heavy package in its own place.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Include {
  std::string file;
  std::string header;
};

std::vector<Include> includes_of(const std::string& floor) {
  static const std::regex kLine(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> includes;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(STANDIN_SOURCE_DIR) / floor)) {
    const auto extension = entry.path().extension();
    if (extension != ".h" && extension != ".cpp") continue;
    std::ifstream stream(entry.path());
    std::smatch match;
    for (std::string line; std::getline(stream, line);)
      if (std::regex_search(line, match, kLine)) includes.push_back({fs::relative(entry.path(), STANDIN_SOURCE_DIR).string(), match[1]});
  }
  return includes;
}

TEST(House, IncludesOnlyPointDown) {
  const std::map<std::string, std::vector<std::string>> above = {
      {"render", {"estimation/", "placement/", "server/"}}, {"estimation", {"placement/", "server/"}}, {"placement", {"server/"}}};
  std::size_t seen = 0;
  for (const auto& [floor, forbidden] : above)
    for (const auto& include : includes_of(floor)) {
      ++seen;
      for (const auto& prefix : forbidden)
        EXPECT_FALSE(include.header.starts_with(prefix)) << include.file << " includes " << include.header;
    }
  EXPECT_GT(seen, 100U);
}

TEST(House, WhatEnginesTakeNeedsTheStandardLibraryAlone) {
  std::size_t seen = 0;
  for (const auto& include : includes_of("render")) {
    if (include.file != "render/base/placement_lookup.h") continue;
    ++seen;
    EXPECT_EQ(include.header.find_first_of("./"), std::string::npos) << include.header;
  }
  EXPECT_GT(seen, 0U);
}

TEST(House, HeavyPackagesStayInTheirRooms) {
  const std::vector<std::pair<std::string, std::string>> rooms = {
      {"embree", "render/visibility/"},           {"OpenImageIO", "render/image/"}, {"ceres", "estimation/robust_fit.cpp"},
      {"Eigen/", "estimation/newton_finish.cpp"}, {"GL/", "render/device/"},        {"assimp", "render/scene/"},
      {"CLI/", "server/command_line/"},           {"toml++", "server/job/"},        {"geos_c", "render/scene/region.cpp"},
      {"protozero/", "render/scene/osm_tile.cpp"}};
  for (const std::string floor : {"render", "estimation", "placement", "server"})
    for (const auto& include : includes_of(floor))
      for (const auto& [package, room] : rooms)
        EXPECT_TRUE(!include.header.starts_with(package) || include.file.starts_with(room))
            << include.file << " includes " << include.header;
}

TEST(House, PlacementOpensNoFiles) {
  for (const auto& include : includes_of("placement"))
    for (const char* header : {"fstream", "filesystem", "cstdio", "iostream"}) EXPECT_NE(include.header, header) << include.file;
}

}  // namespace
