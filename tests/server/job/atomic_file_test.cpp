// Results appear whole or not at all.
#include "server/files/atomic_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "render/base/error.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

class OutputFolderTest : public testing::Test {
 protected:
  OutputFolderTest() { fs::create_directories(root_); }
  ~OutputFolderTest() override { fs::remove_all(root_); }

  [[nodiscard]] std::size_t entries() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(root_), {})); }

  fs::path root_ = fs::temp_directory_path() / ("standin_output_" + std::to_string(::getpid()));
  fs::path folder_ = root_ / "result";
};

TEST_F(OutputFolderTest, NothingIsThereBeforeCommitAndAllOfItAfter) {
  OutputFolder output(folder_, "job 1");
  output.write("a.txt", "alpha");
  EXPECT_FALSE(fs::exists(folder_));
  output.commit();
  EXPECT_EQ(read_file(folder_ / "a.txt"), "alpha");
  EXPECT_EQ(entries(), 1U);
}

TEST_F(OutputFolderTest, AnAbandonedOneLeavesNoTrace) {
  { OutputFolder(folder_, "job 1").write("a.txt", "alpha"); }
  EXPECT_EQ(entries(), 0U);
}

TEST_F(OutputFolderTest, AnotherJobsFolderIsRefusedAndUntouched) {
  OutputFolder first(folder_, "job 1");
  first.write("a.txt", "alpha");
  first.commit();
  try {
    OutputFolder(folder_, "job 2");
    FAIL() << "accepted";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kOutputOccupied);
  }
  EXPECT_EQ(read_file(folder_ / "a.txt"), "alpha");
  EXPECT_EQ(entries(), 1U);
}

TEST_F(OutputFolderTest, ForeignFilesAreRefused) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "thesis.txt") << "mine";
  EXPECT_THROW(OutputFolder(folder_, "job 1"), Failure);
  EXPECT_EQ(read_file(folder_ / "thesis.txt"), "mine");
}

TEST_F(OutputFolderTest, TheSameJobReplacesItsResultWhole) {
  for (const char* text : {"one", "two"}) {
    OutputFolder output(folder_, "job 1");
    output.write(text, text);
    output.commit();
  }
  EXPECT_FALSE(fs::exists(folder_ / "one"));
  EXPECT_EQ(read_file(folder_ / "two"), "two");
  EXPECT_EQ(entries(), 1U);
}

TEST_F(OutputFolderTest, WriteFileReplacesAndReadFileNamesWhatIsMissing) {
  const fs::path file = root_ / "x";
  write_file(file, "1");
  write_file(file, "22");
  EXPECT_EQ(read_file(file), "22");
  EXPECT_EQ(entries(), 1U);
  EXPECT_THROW((void)read_file(root_ / "y"), Failure);
  EXPECT_THROW((void)read_file(root_), Failure);
  EXPECT_THROW(write_file(root_ / "no" / "such" / "folder", "1"), Failure);
}

TEST(Sha256, KnownAnswer) {  // FIPS 180-2, appendix B.1
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace standin
