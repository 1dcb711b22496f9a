// Files that are whole or not there, and their fingerprints.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <fstream>

#include "render/base/error.h"
#include "render/base/sha256.h"
#include "render/base/staged_file.h"
#include "tests/support/temp_folder.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

using StagedFile = test::TempFolder;

TEST_F(StagedFile, ReplacesAndLeavesNothingBeside) {
  write_file(root_ / "x", "1");
  write_file(root_ / "x", "22");
  EXPECT_EQ(read_file(root_ / "x"), "22");
  EXPECT_EQ(entries(), 1U);
}

TEST_F(StagedFile, PiecesFollowEachOther) {
  const std::array<std::string_view, 3> pieces{"a", "", std::string_view("b\0c", 3)};
  write_file(root_ / "x", pieces);
  EXPECT_EQ(read_file(root_ / "x"), std::string("ab\0c", 4));
}

TEST_F(StagedFile, NamesWhatCannotBeReadOrWritten) {
  const auto word_of = [](const auto& act) {
    try {
      act();
    } catch (const Failure& failure) {
      return failure.word();
    }
    return ErrorWord::kBadUsage;
  };
  EXPECT_EQ(word_of([&] { (void)read_file(root_ / "y"); }), ErrorWord::kFileMissing);
  EXPECT_EQ(word_of([&] { (void)read_file(root_); }), ErrorWord::kFileMissing);
  EXPECT_EQ(word_of([&] { write_file(root_ / "no" / "folder", "1"); }), ErrorWord::kFileMissing);
  fs::create_directories(root_ / "occupied" / "inside");
  EXPECT_EQ(word_of([&] { write_file(root_ / "occupied", "1"); }), ErrorWord::kInternal);
  EXPECT_EQ(entries(), 1U);
}

TEST_F(StagedFile, SweepsOnlyWhatProcessesThatAreGoneLeft) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  std::ofstream(root_ / ("x.partial-" + std::to_string(child))) << "half";
  std::ofstream(root_ / "x.partial-1") << "init runs";
  std::ofstream(root_ / "x.partial-") << "no process";
  write_file(root_ / "x", "1");
  EXPECT_FALSE(fs::exists(root_ / ("x.partial-" + std::to_string(child))));
  EXPECT_EQ(entries(), 3U);
}

TEST(Sha256, KnownAnswers) {  // FIPS 180-2, appendix B.1, and the empty text
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

}  // namespace
}  // namespace standin
