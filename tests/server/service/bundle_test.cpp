// Archives that hold a scene, and archives that try to hold something else.
#include "server/service/bundle.h"

#include <archive.h>
#include <archive_entry.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "render/base/staged_file.h"
#include "tests/support/temp_folder.h"

namespace standin {
namespace {

struct Entry {
  std::string path;
  std::string content = "x";
  unsigned type = AE_IFREG;
};

class BundleTest : public test::TempFolder {
 protected:
  [[nodiscard]] std::filesystem::path zip(const std::vector<Entry>& entries) const {
    const auto file = root_ / "scene.zip";
    archive* writer = archive_write_new();
    archive_write_set_format_zip(writer);
    archive_write_open_filename(writer, file.c_str());
    for (const Entry& entry : entries) {
      archive_entry* header = archive_entry_new();
      archive_entry_set_pathname(header, entry.path.c_str());
      archive_entry_set_filetype(header, entry.type);
      archive_entry_set_perm(header, 0644);
      if (entry.type == AE_IFLNK) archive_entry_set_symlink(header, entry.content.c_str());
      archive_entry_set_size(header, entry.type == AE_IFREG ? static_cast<la_int64_t>(entry.content.size()) : 0);
      archive_write_header(writer, header);
      if (entry.type == AE_IFREG) archive_write_data(writer, entry.content.data(), entry.content.size());
      archive_entry_free(header);
    }
    archive_write_free(writer);
    return file;
  }
  [[nodiscard]] std::string unpacked(const std::filesystem::path& file, const BundleLimits& limits = {}) const {
    return std::filesystem::relative(unpack_bundle(file, root_ / "out", limits, {}), root_ / "out").string();
  }
  [[nodiscard]] ErrorWord word_of(const std::filesystem::path& file, const BundleLimits& limits = {}) const {
    try {
      (void)unpacked(file, limits);
    } catch (const Failure& failure) {
      return failure.word();
    }
    return ErrorWord::kInternal;
  }
};

TEST_F(BundleTest, TheHighestSceneIsTheScene) {
  EXPECT_EQ(unpacked(zip({{"a/parts/wheel.obj"}, {"a/city.gltf", "{}"}, {"a/city.bin"}, {"a/textures/wall.png"}})), "a/city.gltf");
  EXPECT_EQ(read_file(root_ / "out/a/city.gltf"), "{}");
  EXPECT_TRUE(std::filesystem::exists(root_ / "out/a/textures/wall.png"));
}

TEST_F(BundleTest, NeitherNoneNorTwo) {
  EXPECT_EQ(word_of(zip({{"readme.txt"}})), ErrorWord::kFileBroken);
  EXPECT_EQ(word_of(zip({{"a.glb"}, {"b.glb"}})), ErrorWord::kFileBroken);
}

TEST_F(BundleTest, NothingLeavesTheFolder) {
  for (const char* path : {"../a.glb", "a/../../b.glb", "/etc/a.glb", "..", "a\\..\\..\\b.glb"})
    EXPECT_EQ(word_of(zip({{path}})), ErrorWord::kUriForbidden) << path;
  EXPECT_EQ(word_of(zip({{"a.glb", "/etc/passwd", AE_IFLNK}})), ErrorWord::kUriForbidden);
  EXPECT_EQ(entries(), 1U) << "the archive alone";
}

TEST_F(BundleTest, ABombIsCountedAsItGoesOff) {
  const auto bomb = zip({{"a.glb", std::string(50'000'000, '\0')}});
  EXPECT_LT(std::filesystem::file_size(bomb), 200'000U);
  EXPECT_EQ(word_of(bomb, {.bytes = 1'000'000}), ErrorWord::kTooLarge);
  EXPECT_LT(std::filesystem::file_size(root_ / "out/a.glb"), 1'100'000U);
  EXPECT_EQ(word_of(zip({{"a.glb"}, {"b"}, {"c"}}), {.files = 2}), ErrorWord::kTooLarge);
}

TEST_F(BundleTest, WhatIsCutOrNoArchiveIsBroken) {
  const auto file = zip({{"a.glb", std::string(100'000, 'q') + "end"}});
  std::string bytes = read_file(file);
  for (const std::size_t size : {std::size_t{0}, std::size_t{3}, std::size_t{40}, bytes.size() / 2}) {
    write_file(root_ / "scene.zip", bytes.substr(0, size));
    EXPECT_EQ(word_of(root_ / "scene.zip"), ErrorWord::kFileBroken) << size;
  }
  write_file(root_ / "scene.zip", "this is text");
  EXPECT_EQ(word_of(root_ / "scene.zip"), ErrorWord::kFileBroken);
}

}  // namespace
}  // namespace standin
