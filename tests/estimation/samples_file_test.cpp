#include "estimation/samples_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "render/base/error.h"
#include "render/base/rng.h"
#include "render/base/staged_file.h"
#include "tests/support/temp_folder.h"

namespace standin {
namespace {

using testing::HasSubstr;

CalibrationSamples random_samples(std::uint64_t seed, std::size_t count) {
  Rng rng(seed);
  CalibrationSamples samples;
  samples.machine = {"osmesa", "llvmpipe (LLVM 15, 256 bits)", "4.5", "a processor, with a comma", 2.0 / 3.0, "wall"};
  for (std::size_t i = 0; i < count; ++i) {
    TimedFrame frame;
    frame.group = static_cast<std::uint32_t>(i % 3);
    for (double& value : frame.features.value) value = std::pow(10.0, rng.uniform(-9.0, 9.0));
    frame.features[Term::kFrame] = 1.0;
    frame.milliseconds = 1e-3 * frame.features[Term::kDraws] + rng.uniform(0.1, 100.0);
    frame.designed = i % 3 == 2;
    frame.spread = rng.uniform(0.0, 0.3);
    frame.seconds = 0.1 * static_cast<double>(i + 1);
    frame.passed_pixels = std::floor(rng.uniform(0.0, 1e6));
    samples.frames.push_back(frame);
  }
  return samples;
}

class SamplesFile : public test::TempFolder {
 protected:
  std::string sentence_of(const std::string& text) {
    write_file(file, text);
    try {
      (void)read_samples(file);
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.word(), ErrorWord::kFileBroken);
      return failure.what();
    }
    return "no failure";
  }
  std::string written(const CalibrationSamples& samples) {
    write_samples(samples, file);
    return read_file(file);
  }

  std::filesystem::path file = root_ / "samples.csv";
};

TEST_F(SamplesFile, ReadsBackBitForBit) {
  CalibrationSamples samples = random_samples(7, 500);
  samples.scenes = "a hall.glb, machines.obj";
  const std::string bytes = written(samples);
  const CalibrationSamples read = read_samples(file);
  ASSERT_EQ(read.frames.size(), samples.frames.size());
  for (std::size_t i = 0; i < read.frames.size(); ++i) {
    EXPECT_EQ(read.frames[i].group, samples.frames[i].group);
    EXPECT_EQ(read.frames[i].milliseconds, samples.frames[i].milliseconds);
    EXPECT_EQ(read.frames[i].designed, samples.frames[i].designed);
    EXPECT_EQ(read.frames[i].spread, samples.frames[i].spread);
    EXPECT_EQ(read.frames[i].seconds, samples.frames[i].seconds);
    EXPECT_EQ(read.frames[i].passed_pixels, samples.frames[i].passed_pixels);
    EXPECT_EQ(read.frames[i].features.value, samples.frames[i].features.value);
  }
  EXPECT_EQ(read.machine.processor, samples.machine.processor);
  EXPECT_EQ(read.machine.reference_ms, samples.machine.reference_ms);
  EXPECT_EQ(read.machine.clock, "wall");
  EXPECT_EQ(read.scenes, samples.scenes);
  EXPECT_EQ(written(read), bytes);
}

TEST_F(SamplesFile, OfTheBuiltInScenesNamesNone) {
  EXPECT_EQ(written(random_samples(7, 2)).find("# scenes"), std::string::npos);
  EXPECT_EQ(read_samples(file).scenes, "");
}

TEST_F(SamplesFile, TheSameFitComesOutOfIt) {
  const CalibrationSamples samples = random_samples(11, 120);
  write_samples(samples, file);
  const FitSummary direct = fit_time_model(samples.frames, 0.99);
  const FitSummary again = fit_time_model(read_samples(file).frames, 0.99);
  EXPECT_EQ(again.model.milliseconds_per_unit, direct.model.milliseconds_per_unit);
  EXPECT_EQ(again.model.bound_ms(10.0), direct.model.bound_ms(10.0));
  EXPECT_EQ(again.p90_error, direct.p90_error);
}

TEST_F(SamplesFile, ALineBreakInANameDoesNotBreakTheFile) {
  CalibrationSamples samples = random_samples(3, 2);
  samples.machine.renderer = "two\nlines";
  write_samples(samples, file);
  EXPECT_EQ(read_samples(file).machine.renderer, "two lines");
}

TEST_F(SamplesFile, WhatIsWrongIsNamedWithItsLine) {
  const std::string good = written(random_samples(5, 3));
  const auto spoilt = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return sentence_of(text.replace(at, from.size(), to));
  };
  EXPECT_THAT(spoilt("samples 2", "samples 1"), HasSubstr("line 1"));
  EXPECT_THAT(spoilt("# renderer", "# vendor"), HasSubstr("line 3"));
  EXPECT_THAT(spoilt("clock: wall", "clock: cpu"), HasSubstr("line 7: clock \"cpu\" violates"));
  EXPECT_THAT(spoilt("reference_ms: 0.6666666666666666", "reference_ms: 0"), HasSubstr("line 6: reference_ms is 0"));
  EXPECT_THAT(spoilt("group,designed", "scene,designed"), HasSubstr("line 8"));
  EXPECT_THAT(spoilt("\n1,", "\n1,2,"), HasSubstr("line 10: 18 columns"));
  EXPECT_THAT(spoilt("\n1,", "\n1,nan"), HasSubstr("line 10"));
  EXPECT_THAT(spoilt("\n2,", "\n-2,"), HasSubstr("line 11: \"-2\" is not a finite number >= 0"));
  EXPECT_THAT(sentence_of(""), HasSubstr("line 1"));
  EXPECT_THAT(sentence_of(good.substr(0, good.size() - 40)), HasSubstr("line 11"));
}

}  // namespace
}  // namespace standin
