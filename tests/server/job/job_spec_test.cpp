// One table describes every setting: parser, defaults, ranges, schema and documents must say the same.
#include "server/job/job_spec.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "render/base/error.h"

namespace standin {
namespace {

using nlohmann::json;

std::string text_of(const std::string& file) {
  std::ifstream stream(std::string(STANDIN_SOURCE_DIR) + "/" + file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::filesystem::path write_toml(const std::string& text) {
  const auto file = std::filesystem::temp_directory_path() / ("standin_spec_" + std::to_string(::getpid()) + ".toml");
  std::ofstream(file) << text;
  return file;
}

Failure failure_of(const std::string& toml) {
  JobSpec spec;
  try {
    read_config(spec, write_toml(toml));
  } catch (const Failure& failure) {
    return failure;
  }
  ADD_FAILURE() << "accepted: " << toml;
  return {ErrorWord::kInternal, ""};
}

TEST(JobSpec, KeysAndFlagsAreUnique) {
  std::set<std::string> keys, flags;
  for (const auto& field : spec_fields()) {
    EXPECT_TRUE(keys.insert(field.key).second) << field.key;
    EXPECT_TRUE(field.flag.empty() || flags.insert(field.flag).second) << field.flag;
    EXPECT_FALSE(field.help.empty()) << field.key;
  }
}

TEST(JobSpec, DefaultsLieInTheirOwnRanges) {
  const json defaults = to_json(JobSpec{}, false);
  JobSpec spec;
  for (const auto& field : spec_fields()) EXPECT_NO_THROW(set_field(spec, field, field.get(JobSpec{}), field.key)) << field.key;
  EXPECT_EQ(to_json(spec, false), defaults);
}

TEST(JobSpec, JsonRoundTripKeepsEverySetting) {
  JobSpec spec;
  spec.budget_ms = 16.25;
  spec.view_space = "boxes";
  spec.boxes = {Box{{0, 1, 2}, {3, 4, 5}}};
  spec.apex_deg = {30.0};
  spec.seed = 77;
  spec.force = {"visibility"};
  EXPECT_EQ(to_json(spec_from_json(to_json(spec, false)), false), to_json(spec, false));
}

TEST(JobSpec, ResultsCarryNoThreadCount) {
  EXPECT_FALSE(to_json(JobSpec{}, true).contains("threads"));
  EXPECT_TRUE(to_json(JobSpec{}, false).contains("threads"));
}

TEST(JobSpec, TomlSetsNestedKeys) {
  JobSpec spec;
  read_config(spec, write_toml("budget_ms = 20\n[view_space]\nkind = \"walk\"\nleaf_m = 11.5\n"));
  EXPECT_EQ(spec.budget_ms, 20.0);
  EXPECT_EQ(spec.view_space, "walk");
  EXPECT_EQ(spec.leaf_m, 11.5);
}

TEST(JobSpec, UnknownKeysAreNamedWithTheirPath) {
  const Failure failure = failure_of("[view_space]\nleafs_m = 3\n");
  EXPECT_EQ(failure.word(), ErrorWord::kBadConfig);
  EXPECT_NE(std::string(failure.what()).find("view_space.leafs_m"), std::string::npos) << failure.what();
}

TEST(JobSpec, ValuesOutOfRangeNameTheConstraint) {
  EXPECT_NE(std::string(failure_of("[view_space]\nleaf_m = 0\n").what()).find("view_space.leaf_m = 0 violates: > 0"), std::string::npos);
  EXPECT_NE(std::string(failure_of("[camera]\nfov_y_deg = 151\n").what()).find("<= 150"), std::string::npos);
  EXPECT_NE(std::string(failure_of("[camera]\nwidth = \"wide\"\n").what()).find("integer"), std::string::npos);
  EXPECT_NE(std::string(failure_of("[visibility]\nmode = \"maybe\"\n").what()).find("one of"), std::string::npos);
  EXPECT_NE(std::string(failure_of("budget_ms = nan\n").what()).find("budget_ms"), std::string::npos);
  EXPECT_EQ(failure_of("budget_ms = = 3\n").word(), ErrorWord::kBadConfig);
}

TEST(JobSpec, FlagTextIsParsedByType) {
  JobSpec spec;
  const auto set = [&](const std::string& flag, const std::string& text) {
    for (const auto& field : spec_fields())
      if (field.flag == flag) set_field_from_text(spec, field, text);
  };
  set("--apex-deg", "22.5,45");
  set("--seed", "9");
  set("--up", "z");
  EXPECT_EQ(spec.apex_deg, (std::vector<double>{22.5, 45.0}));
  EXPECT_EQ(spec.seed, 9U);
  EXPECT_EQ(spec.up, "z");
  EXPECT_THROW(set("--seed", "nine"), Failure);
  EXPECT_THROW(set("--seed", "-1"), Failure);
}

TEST(JobSpec, CommittedSchemaIsTheTable) {
  EXPECT_EQ(json::parse(text_of("configs/job.schema.json")), spec_schema())
      << "write configs/job.schema.json again: standin place --print-schema";
}

TEST(JobSpec, ReadmeNamesEverySetting) {
  const std::string readme = text_of("README.md");
  for (const auto& field : spec_fields()) EXPECT_NE(readme.find("`" + field.key + "`"), std::string::npos) << field.key;
}

}  // namespace
}  // namespace standin
