// Where a job's cache may lie.

#include "server/job/job_cache.h"

#include <gtest/gtest.h>

#include "render/base/error.h"
#include "tests/support/temp_folder.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

class JobCaches : public test::TempFolder {
 protected:
  JobCaches() { fs::current_path(root_); }
  ~JobCaches() override { fs::current_path(before_); }

  static bool is_refused(const fs::path& cache, const fs::path& result_folder) {
    JobSpec spec;
    spec.cache = cache.string();
    try {
      (void)open_cache(spec, result_folder);
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.word(), ErrorWord::kBadUsage);
      return true;
    }
    return false;
  }

  fs::path before_ = fs::current_path();
};

// However either is written, and whether or not it is there.
TEST_F(JobCaches, InTheResultFolderIsRefused) {
  for (const bool exists : {false, true}) {
    if (exists) fs::create_directories(root_ / "out" / "deep");
    for (const fs::path& folder : {fs::path("out"), fs::path("./out/"), root_ / "out", root_ / "other" / ".." / "out"})
      for (const fs::path& cache : {fs::path("out"), fs::path("out/cache"), fs::path("out/deep/cache"), root_ / "out" / "cache"})
        EXPECT_TRUE(is_refused(cache, folder)) << cache << " in " << folder;
  }
  EXPECT_FALSE(fs::exists(root_ / "out" / "cache"));
}

TEST_F(JobCaches, BesideItIsNot) {
  for (const fs::path& folder : {fs::path("out"), root_ / "out"})
    for (const fs::path& cache : {fs::path("cache"), fs::path("out2"), fs::path("out/../cache"), root_ / "cache"})
      EXPECT_FALSE(is_refused(cache, folder)) << cache << " beside " << folder;
  EXPECT_FALSE(is_refused("cache", "")) << "no folder is written";
}

}  // namespace
}  // namespace standin
