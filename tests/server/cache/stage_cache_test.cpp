#include "server/cache/stage_cache.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "render/base/build_identity.h"
#include "render/base/rng.h"
#include "render/base/staged_file.h"
#include "tests/support/temp_folder.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

constexpr CacheStage kStage{"things"};

Fingerprint inputs(int number) {
  return Fingerprinter().add(number).fingerprint();
}

std::string read_text(ByteReader& bytes) {
  return std::string(bytes.raw(bytes.size_left()));
}

class StageCaches : public test::TempFolder {
 protected:
  [[nodiscard]] StageCache open() const { return StageCache(root_ / "cache", fingerprint_of("build")); }
  [[nodiscard]] static std::optional<std::string> recall(StageCache& cache, int number) {
    return cache.recall(kStage, inputs(number), read_text);
  }
  [[nodiscard]] std::size_t files() const {
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(root_ / "cache")) count += entry.is_regular_file() ? 1 : 0;
    return count;
  }
  static void write(const fs::path& file, std::string_view bytes) {
    std::ofstream(file, std::ios::binary | std::ios::trunc).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
};

TEST_F(StageCaches, RecallsWhatWasKeptAlsoInAnotherProcess) {
  StageCache first = open();
  EXPECT_EQ(recall(first, 1), std::nullopt);
  first.keep(kStage, inputs(1), "one");
  first.keep(kStage, inputs(2), "");
  StageCache second = open();
  EXPECT_EQ(recall(second, 1), "one");
  EXPECT_EQ(recall(second, 2), "");
  EXPECT_EQ(recall(second, 3), std::nullopt);
  const CacheFigures figures = second.figures();
  EXPECT_EQ(figures.stages.at("things").hits, 2U);
  EXPECT_EQ(figures.stages.at("things").misses, 0U);
  EXPECT_EQ(first.figures().stages.at("things").misses, 2U);
  EXPECT_EQ(figures.folder_bytes, first.figures().stages.at("things").bytes_written);
  EXPECT_EQ(figures.folder_bytes, figures.stages.at("things").bytes_read);
}

TEST_F(StageCaches, OtherInputsStagesFormatsAndBuildsAreOtherEntries) {
  StageCache cache = open();
  cache.keep(kStage, inputs(1), "one");
  EXPECT_FALSE(cache.recall(kStage, inputs(2), read_text));
  EXPECT_FALSE(cache.recall(CacheStage{"others"}, inputs(1), read_text));
  EXPECT_FALSE(cache.recall(CacheStage{"things", 2}, inputs(1), read_text));
  StageCache other_build(root_ / "cache", fingerprint_of("another build"));
  EXPECT_FALSE(other_build.recall(kStage, inputs(1), read_text));
}

TEST_F(StageCaches, AnEntryCutShortAnywhereIsAbsentAndReplaced) {
  StageCache cache = open();
  cache.keep(kStage, inputs(1), "payload");
  const fs::path file = cache.file_of(kStage, inputs(1));
  const std::string whole = read_file(file);
  ASSERT_GT(whole.size(), 7U);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    write(file, whole.substr(0, length));
    EXPECT_EQ(recall(cache, 1), std::nullopt) << length << " of " << whole.size() << " bytes";
  }
  write(file, whole + "x");
  EXPECT_EQ(recall(cache, 1), std::nullopt) << "a byte more";
  cache.keep(kStage, inputs(1), "payload");
  EXPECT_EQ(read_file(file), whole);
  EXPECT_EQ(recall(cache, 1), "payload");
}

// A file of 4 TB that takes up none: whether its header says so, too, or something else, nobody asks for as much memory.
TEST_F(StageCaches, AnEntryOfAHugeSizeIsAbsentAndReplaced) {
  StageCache cache = open();
  cache.keep(kStage, inputs(1), "payload");
  const fs::path file = cache.file_of(kStage, inputs(1));
  const std::string whole = read_file(file);
  constexpr std::uint64_t kHuge = std::uint64_t{1} << 42;
  for (const bool consistent : {false, true}) {
    std::string header = whole.substr(0, whole.size() - 7);
    const std::uint64_t claimed = kHuge - header.size();
    if (consistent)
      header.replace(header.size() - sizeof(Fingerprint) - sizeof claimed, sizeof claimed, reinterpret_cast<const char*>(&claimed),
                     sizeof claimed);
    write(file, header);
    fs::resize_file(file, kHuge);
    EXPECT_EQ(recall(cache, 1), std::nullopt);
    cache.keep(kStage, inputs(1), "payload");
    EXPECT_EQ(recall(cache, 1), "payload");
  }
}

// In the header every bit, the layout's version among them; in the payload some.
TEST_F(StageCaches, AnEntryWithAFlippedBitIsAbsent) {
  StageCache cache = open();
  const std::string payload(1000, 'p');
  cache.keep(kStage, inputs(1), payload);
  const fs::path file = cache.file_of(kStage, inputs(1));
  const std::string whole = read_file(file);
  std::vector<std::size_t> bits;
  for (std::size_t bit = 0; bit < 8 * (whole.size() - payload.size()); ++bit) bits.push_back(bit);
  Rng rng(7);
  for (int i = 0; i < 200; ++i) bits.push_back(rng.below(8 * whole.size()));
  for (const std::size_t bit : bits) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    write(file, damaged);
    EXPECT_EQ(recall(cache, 1), std::nullopt) << "bit " << bit;
  }
  write(file, whole);
  EXPECT_EQ(recall(cache, 1), payload);
}

TEST_F(StageCaches, AnEntryUnderAnotherNameIsAbsent) {
  StageCache cache = open();
  cache.keep(kStage, inputs(1), "one");
  fs::copy_file(cache.file_of(kStage, inputs(1)), cache.file_of(kStage, inputs(2)));
  EXPECT_EQ(recall(cache, 2), std::nullopt);
}

TEST_F(StageCaches, WhatIsNoFileIsAbsentAndCannotBeReplaced) {
  StageCache cache = open();
  fs::create_directories(cache.file_of(kStage, inputs(1)));
  EXPECT_EQ(recall(cache, 1), std::nullopt);
  cache.keep(kStage, inputs(1), "one");
  EXPECT_EQ(cache.figures().write_failures, 1U);
  EXPECT_EQ(recall(cache, 1), std::nullopt);
  EXPECT_EQ(files(), 0U);
}

TEST_F(StageCaches, WhatCannotBeDecodedIsAbsent) {
  StageCache cache = open();
  cache.keep(kStage, inputs(1), "ab");
  const auto too_much = [](ByteReader& bytes) { return bytes.value<double>(); };
  const auto too_little = [](ByteReader& bytes) { return bytes.value<char>(); };
  EXPECT_FALSE(cache.recall(kStage, inputs(1), too_much));
  EXPECT_FALSE(cache.recall(kStage, inputs(1), too_little));
  EXPECT_EQ(cache.figures().stages.count("things"), 1U);
  EXPECT_EQ(cache.figures().stages.at("things").hits, 0U);
}

TEST_F(StageCaches, WritersAndReadersMayMeet) {
  std::vector<std::thread> threads;
  std::atomic<int> broken{0};
  const std::string payload(100'000, 'w');
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      StageCache cache = open();
      for (int i = 0; i < 50; ++i) {
        cache.keep(kStage, inputs(i % 5), payload);
        const auto known = recall(cache, (i + 1) % 5);
        if (known && *known != payload) ++broken;
      }
    });
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(broken, 0);
  StageCache after = open();
  for (int i = 0; i < 5; ++i) EXPECT_EQ(recall(after, i), payload);
  EXPECT_EQ(files(), 5U) << "nothing staged is left";
}

TEST_F(StageCaches, AKilledWriterLeavesNothingThatIsRead) {
  const std::string payload(3'000'000, 'k');
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    StageCache cache = open();
    for (int i = 0;; ++i) cache.keep(kStage, inputs(i % 3), payload);
  }
  while (!fs::exists(root_ / "cache" / "things") || fs::is_empty(root_ / "cache" / "things")) ::usleep(1000);
  ::usleep(20'000);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  const fs::path left = root_ / "cache" / "things" / (std::string(64, 'a') + ".partial-0-" + std::to_string(child));
  write(left, "half");
  StageCache cache = open();
  for (int i = 0; i < 3; ++i) {
    const auto known = recall(cache, i);
    EXPECT_TRUE(!known || *known == payload);
    cache.keep(kStage, inputs(i), "whole");
    EXPECT_EQ(recall(cache, i), "whole");
  }
  cache.remove_unused();
  EXPECT_FALSE(fs::exists(left));
  EXPECT_EQ(files(), 3U);
}

TEST_F(StageCaches, RemovesWhatThisRunDidNotUseAndNothingElse) {
  {
    StageCache before = open();
    for (int i = 0; i < 4; ++i) before.keep(kStage, inputs(i), "old");
    before.keep(CacheStage{"others"}, inputs(0), "old");
  }
  const fs::path stage = root_ / "cache" / "things";
  write(stage / "notes.txt", "the user's");
  write(stage / (std::string(64, 'b') + ".partial-3-" + std::to_string(::getpid())), "being written");
  StageCache cache = open();
  EXPECT_EQ(recall(cache, 1), "old");
  EXPECT_EQ(recall(cache, 9), std::nullopt);
  cache.keep(kStage, inputs(9), "new");
  cache.remove_unused();
  EXPECT_EQ(cache.figures().removed_entries, 4U);
  EXPECT_EQ(recall(cache, 1), "old");
  EXPECT_EQ(recall(cache, 9), "new");
  for (const int gone : {0, 2, 3}) EXPECT_EQ(recall(cache, gone), std::nullopt);
  EXPECT_FALSE(cache.recall(CacheStage{"others"}, inputs(0), read_text));
  EXPECT_TRUE(fs::exists(stage / "notes.txt"));
  EXPECT_EQ(files(), 4U) << "two entries, a note and a file that a running process is at";
}

TEST_F(StageCaches, AFolderThatCannotBeMadeIsAnErrorAtOnce) {
  write(root_ / "file", "no folder");
  try {
    StageCache cache(root_ / "file" / "cache", fingerprint_of("build"));
    FAIL() << "nothing can be written there";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kBadUsage);
    EXPECT_NE(std::string(failure.what()).find("Not a directory"), std::string::npos) << failure.what();
  }
}

// A limit on file sizes stands in for a full disk.
TEST_F(StageCaches, AResultThatCannotBeWrittenIsCountedAndNoError) {
  StageCache cache = open();
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{1000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &tight);
  cache.keep(kStage, inputs(1), std::string(100'000, 'x'));
  ::setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(cache.figures().write_failures, 1U);
  EXPECT_EQ(cache.figures().why_not_written, "File too large");
  EXPECT_EQ(cache.figures().stages.at("things").bytes_written, 0U);
  EXPECT_EQ(recall(cache, 1), std::nullopt);
  EXPECT_EQ(files(), 0U) << "no part of it is left";
  cache.keep(kStage, inputs(1), "fits");
  EXPECT_EQ(recall(cache, 1), "fits");
}

TEST(Fingerprints, DifferByEveryValueAndByWhereOneEnds) {
  const auto of = [](auto... values) {
    Fingerprinter to;
    (to.add(values), ...);
    return to.fingerprint();
  };
  using Text = std::string_view;
  const std::vector<Fingerprint> all = {of(1),
                                        of(2),
                                        of(1, 2),
                                        of(2, 1),
                                        of(std::uint64_t{1}),
                                        of(0.0),
                                        of(-0.0),
                                        of(Text("ab")),
                                        of(Text("a"), Text("b")),
                                        of(Text(""), Text("ab")),
                                        of(Text("ab"), Text(""))};
  EXPECT_EQ(std::set<Fingerprint>(all.begin(), all.end()).size(), all.size());
  EXPECT_EQ(of(1, 2), of(1, 2));
  EXPECT_EQ(fingerprint_of("abc").hex(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  Fingerprinter to;
  to.add(1);
  EXPECT_EQ(to.fingerprint(), of(1)) << "may be asked for in between";
  EXPECT_EQ(to.add(2).fingerprint(), of(1, 2));
}

TEST(BuildIdentity, IsThisPrograms) {
  EXPECT_NE(build_identity(), Fingerprint{});
  EXPECT_EQ(&build_identity(), &build_identity());
}

}  // namespace
}  // namespace standin
