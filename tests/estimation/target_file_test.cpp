#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "estimation/time_model.h"
#include "render/base/error.h"

namespace standin {
namespace {

class TargetFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("standin_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path file() const { return folder_ / "target.json"; }
  void write_text(const std::string& text) const { std::ofstream(file()) << text; }
  /// The failure that reading gives after `change` to a good file.
  [[nodiscard]] std::optional<Failure> failure_after(const std::function<void(nlohmann::json&)>& change) const;

  std::filesystem::path folder_;
};

Target some_target() {
  Target target;
  target.id = "osmesa-llvmpipe";
  for (std::size_t i = 0; i < kTermCount; ++i) target.model.milliseconds_per_unit[i] = 0.1 / static_cast<double>(i + 3);
  target.model.combination = Combination::kMax;
  target.model.bound_steps = {{1.0 / 3.0, 2.0}, {std::numeric_limits<double>::infinity(), 1.1}};
  target.model.coverage = 0.99;
  target.machine.device = "osmesa";
  target.machine.renderer = "llvmpipe (\"quoted\", 256 bits)";
  target.machine.gl_version = "4.5 (Core Profile)";
  target.machine.processor = "some processor";
  target.machine.reference_ms = 4.0 / 3.0;
  target.machine.clock = "wall";
  target.learning_curve = {{5.0, 31, 0.2, 0.5, 0.97, 1.6}, {10.0, 64, 1.0 / 7.0, 0.4, 0.985, 1.5}};
  target.samples = 812;
  target.median_error = 0.11;
  target.p90_error = 0.27;
  target.measured_coverage = 0.991;
  target.left_out = {"plain_pixels: no timed frame has any"};
  return target;
}

std::optional<Failure> failure_of_reading(const std::filesystem::path& file) {
  try {
    (void)read_target(file);
  } catch (const Failure& failure) {
    return failure;
  }
  return std::nullopt;
}

std::optional<Failure> TargetFile::failure_after(const std::function<void(nlohmann::json&)>& change) const {
  write_target(some_target(), file());
  nlohmann::json json = nlohmann::json::parse(std::ifstream(file()));
  change(json);
  write_text(json.dump());
  return failure_of_reading(file());
}

TEST_F(TargetFile, ComesBackBitForBit) {
  const Target written = some_target();
  write_target(written, file());
  const Target read = read_target(file());
  EXPECT_EQ(read.model.milliseconds_per_unit, written.model.milliseconds_per_unit);
  EXPECT_EQ(read.model.combination, written.model.combination);
  ASSERT_EQ(read.model.bound_steps.size(), 2U);
  EXPECT_EQ(read.model.bound_steps[0].until_ms, written.model.bound_steps[0].until_ms);
  EXPECT_EQ(read.model.bound_steps[1].until_ms, written.model.bound_steps[1].until_ms);
  EXPECT_EQ(read.model.bound_steps[1].factor, written.model.bound_steps[1].factor);
  EXPECT_EQ(read.model.coverage, written.model.coverage);
  EXPECT_EQ(read.id, written.id);
  EXPECT_EQ(read.machine.device, written.machine.device);
  EXPECT_EQ(read.machine.renderer, written.machine.renderer);
  EXPECT_EQ(read.machine.gl_version, written.machine.gl_version);
  EXPECT_EQ(read.machine.processor, written.machine.processor);
  EXPECT_EQ(read.machine.reference_ms, written.machine.reference_ms);
  EXPECT_EQ(read.machine.clock, written.machine.clock);
  ASSERT_EQ(read.learning_curve.size(), 2U);
  EXPECT_EQ(read.learning_curve[1].frames, 64U);
  EXPECT_EQ(read.learning_curve[1].median_error, 1.0 / 7.0);
  EXPECT_EQ(read.learning_curve[1].bound_over_measured_median, 1.5);
  EXPECT_EQ(read.samples, written.samples);
  EXPECT_EQ(read.median_error, written.median_error);
  EXPECT_EQ(read.p90_error, written.p90_error);
  EXPECT_EQ(read.measured_coverage, written.measured_coverage);
  EXPECT_EQ(read.left_out, written.left_out);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1) << "nothing is left beside it";
}

TEST(ShippedTargets, CanBeRead) {
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(STANDIN_SOURCE_DIR) / "configs/targets")) {
    const Target target = read_target(entry.path());
    EXPECT_GT(target.model.bound_ms(10.0), 10.0) << entry.path();
    EXPECT_FALSE(target.learning_curve.empty()) << entry.path();
    ++read;
  }
  EXPECT_GT(read, 0);
}

TEST_F(TargetFile, SameTargetSameBytesSameDigest) {
  write_target(some_target(), file());
  const std::string first = read_target(file()).sha256;
  EXPECT_EQ(first.size(), 64U);
  write_target(some_target(), file());
  EXPECT_EQ(read_target(file()).sha256, first);
  Target other = some_target();
  other.samples = 813;
  write_target(other, file());
  EXPECT_NE(read_target(file()).sha256, first);
}

TEST_F(TargetFile, OfAnotherFormatOrVersionIsRefusedByName) {
  const auto version = failure_after([](auto& json) { json["version"] = 7; });
  ASSERT_TRUE(version);
  EXPECT_EQ(version->word(), ErrorWord::kTargetUnreadable);
  const std::string sentence = version->what();
  EXPECT_NE(sentence.find("target.json"), std::string::npos);
  EXPECT_NE(sentence.find("version 7"), std::string::npos);
  EXPECT_NE(sentence.find("version 2"), std::string::npos);
  for (const auto& change : std::vector<std::function<void(nlohmann::json&)>>{
           [](auto& json) { json["format"] = "standin.placement"; }, [](auto& json) { json.erase("format"); },
           [](auto& json) { json["version"] = "1"; }, [](auto& json) { json = nlohmann::json::array(); }}) {
    const auto failure = failure_after(change);
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->word(), ErrorWord::kTargetUnreadable);
  }
}

TEST_F(TargetFile, WithABadValueIsRefusedNamingIt) {
  struct Case {
    const char* named;
    std::function<void(nlohmann::json&)> change;
  };
  const std::vector<Case> cases = {
      {"draws", [](auto& json) { json["model"]["milliseconds_per_unit"]["draws"] = -1e-9; }},
      {"draws", [](auto& json) { json["model"]["milliseconds_per_unit"]["draws"] = "1"; }},
      {"masked_pixels", [](auto& json) { json["model"]["milliseconds_per_unit"].erase("masked_pixels"); }},
      {"milliseconds_per_unit", [](auto& json) { json["model"]["milliseconds_per_unit"] = 3; }},
      {"combination", [](auto& json) { json["model"]["combination"] = "product"; }},
      {"combination", [](auto& json) { json["model"].erase("combination"); }},
      {"bound_steps", [](auto& json) { json["model"]["bound_steps"] = nlohmann::json::array(); }},
      {"bound_steps", [](auto& json) { json["model"]["bound_steps"][1]["until_ms"] = 9; }},
      {"bound_steps", [](auto& json) { json["model"]["bound_steps"] = nlohmann::json::object(); }},
      {"until_ms", [](auto& json) { json["model"]["bound_steps"].push_back(json["model"]["bound_steps"][0]); }},
      {"factor", [](auto& json) { json["model"]["bound_steps"][0]["factor"] = nullptr; }},
      {"coverage", [](auto& json) { json["model"]["coverage"] = 1.0; }},
      {"coverage", [](auto& json) { json["model"]["coverage"] = 0; }},
      {"model", [](auto& json) { json.erase("model"); }},
      {"renderer", [](auto& json) { json["machine"]["renderer"] = 5; }},
      {"reference_ms", [](auto& json) { json["machine"]["reference_ms"] = true; }},
      {"clock", [](auto& json) { json["machine"]["clock"] = "sundial"; }},
      {"learning_curve", [](auto& json) { json["quality"]["learning_curve"][1]["p90_error"] = "low"; }},
      {"samples", [](auto& json) { json["quality"]["samples"] = -1; }},
      {"left_out", [](auto& json) { json["quality"]["left_out"] = {1}; }},
      {"id", [](auto& json) { json.erase("id"); }},
  };
  for (const Case& bad : cases) {
    const auto failure = failure_after(bad.change);
    ASSERT_TRUE(failure) << bad.named;
    EXPECT_EQ(failure->word(), ErrorWord::kFileBroken) << failure->what();
    EXPECT_NE(std::string(failure->what()).find(bad.named), std::string::npos) << failure->what();
  }
}

TEST_F(TargetFile, TruncatedAnywhereIsRefused) {
  write_target(some_target(), file());
  std::ifstream stream(file());
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  for (std::size_t length = 0; length + 2 < text.size(); length += 37) {
    write_text(text.substr(0, length));
    const auto failure = failure_of_reading(file());
    ASSERT_TRUE(failure) << length;
    EXPECT_EQ(failure->word(), ErrorWord::kFileBroken);
  }
  write_text(R"({"format": "standin.target", "version": 1, "id": 1e999})");
  EXPECT_EQ(failure_of_reading(file())->word(), ErrorWord::kFileBroken);
}

// Whoever shows, copies or compares a value goes down as deep as it is nested.
TEST_F(TargetFile, NestedWithoutEndIsRefused) {
  for (const char* head : {R"({"format": )", R"({"format": "standin.target", "version": 2, "id": )"}) {
    write_text(head + std::string(200'000, '[') + std::string(200'000, ']') + "}");
    const auto failure = failure_of_reading(file());
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->word(), ErrorWord::kFileBroken);
    EXPECT_NE(std::string(failure->what()).find("deep"), std::string::npos) << failure->what();
  }
}

TEST_F(TargetFile, MissingOrUnwritableIsSaid) {
  EXPECT_EQ(failure_of_reading(folder_ / "none.json")->word(), ErrorWord::kFileMissing);
  EXPECT_EQ(failure_of_reading(folder_)->word(), ErrorWord::kFileMissing);
  EXPECT_THROW(write_target(some_target(), folder_ / "none" / "target.json"), Failure);
}

}  // namespace
}  // namespace standin
