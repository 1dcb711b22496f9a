// Results appear whole or not at all.
#include "server/files/output_folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "render/base/error.h"
#include "render/base/staged_file.h"
#include "tests/support/temp_folder.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

class OutputFolderTest : public test::TempFolder {
 protected:
  void commit_result() const {
    OutputFolder output(folder_, "job 1");
    output.write("a.txt", "alpha");
    output.commit();
  }

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

// A process that has come and gone.
pid_t dead_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

TEST_F(OutputFolderTest, SweepsWhatKilledProcessesLeftAndNothingElse) {
  commit_result();
  const auto stage = [&](const std::string& name) { fs::create_directories(root_ / name / "inside"); };
  const std::string dead = std::to_string(dead_process());
  stage("result.partial-" + dead);
  stage("result.old-" + dead);
  stage("other.partial-" + dead);
  stage("result.partial-" + dead + "x");
  stage("result.partial-1");  // init runs
  commit_result();
  EXPECT_FALSE(fs::exists(root_ / ("result.partial-" + dead)));
  EXPECT_FALSE(fs::exists(root_ / ("result.old-" + dead)));
  EXPECT_TRUE(fs::exists(root_ / ("other.partial-" + dead)));
  EXPECT_TRUE(fs::exists(root_ / ("result.partial-" + dead + "x")));
  EXPECT_TRUE(fs::exists(root_ / "result.partial-1"));
  EXPECT_EQ(entries(), 4U);
}

TEST_F(OutputFolderTest, AResultWhoseReplacementWasKilledHalfwayComesBack) {
  commit_result();
  fs::rename(folder_, root_ / ("result.old-" + std::to_string(dead_process())));
  { OutputFolder(folder_, "job 1"); }
  EXPECT_EQ(read_file(folder_ / "a.txt"), "alpha");
  EXPECT_EQ(entries(), 1U);
}

TEST_F(OutputFolderTest, ATrailingSlashNamesTheSameFolder) {
  OutputFolder output(folder_ / "", "job 1");
  EXPECT_EQ(entries(), 1U);
  output.commit();
  EXPECT_TRUE(fs::exists(folder_ / ".standin-job"));
  EXPECT_EQ(entries(), 1U);
}

}  // namespace
}  // namespace standin
