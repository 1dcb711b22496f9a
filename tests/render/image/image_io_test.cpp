#include "render/image/image_io.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <set>

#include "render/base/error.h"
#include "render/base/rng.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

Texture random_texture(int width, int height, std::uint64_t seed) {
  Rng rng(seed);
  Texture texture{"random", width, height, {}};
  for (int i = 0; i < width * height * 4; ++i) texture.rgba.push_back(static_cast<std::uint8_t>(rng.below(256)));
  return texture;
}

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

ErrorWord word_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Failure& failure) {
    return failure.word();
  }
  ADD_FAILURE() << "no Failure was thrown";
  return ErrorWord::kInternal;
}

fs::path temporary_file(const std::string& name, const std::string& content) {
  const fs::path file = fs::path(testing::TempDir()) / ("standin_image_" + name);
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

// An uncompressed SGI image: 512 bytes of header, then one plane per channel, rows from the bottom.
std::string sgi(int width, int height, const std::vector<std::string>& planes) {
  std::string file(512, '\0');
  const auto put = [&](std::size_t offset, int value) {
    file[offset] = static_cast<char>(value >> 8);
    file[offset + 1] = static_cast<char>(value & 255);
  };
  put(0, 474);
  file[3] = 1;  // bytes per channel
  put(4, planes.size() == 1 ? 2 : 3);
  put(6, width);
  put(8, height);
  put(10, static_cast<int>(planes.size()));
  file[19] = static_cast<char>(255);  // largest value
  for (const std::string& plane : planes) file += plane;
  return file;
}

// Names of a PNG's chunks.
std::set<std::string> chunks_of(const std::string& png) {
  std::set<std::string> names;
  for (std::size_t at = 8; at + 8 <= png.size();) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < 4; ++i) size = size * 256 + static_cast<std::uint8_t>(png[at + i]);
    names.insert(png.substr(at + 4, 4));
    at += size + 12;
  }
  return names;
}

TEST(ImageIo, PngKeepsEveryByteAlsoUnderTransparentTexels) {
  const Texture image = random_texture(17, 9, 1);
  const Texture back = decode_image(bytes_of(encode_png(image)), "back");
  EXPECT_EQ(back.width, 17);
  EXPECT_EQ(back.height, 9);
  EXPECT_EQ(back.rgba, image.rgba);
}

TEST(ImageIo, PngIsTheSameBytesAndTellsNothingOfItsMaking) {
  const Texture image = random_texture(64, 64, 2);
  const std::string png = encode_png(image);
  EXPECT_EQ(png, encode_png(image));
  for (const std::string& name : chunks_of(png)) {
    EXPECT_TRUE((std::set<std::string>{"IHDR", "IDAT", "IEND", "gAMA", "sRGB", "pHYs", "oFFs"}.contains(name))) << name;
  }
}

TEST(ImageIo, ReadsSgiFromTheTopAndWidensIt) {
  // Bottom row red, green; top row blue, white.
  const std::string red("\xFF\x00\x00\xFF", 4);
  const std::string green("\x00\xFF\x00\xFF", 4);
  const std::string blue("\x00\x00\xFF\xFF", 4);
  const Texture colour = read_image(temporary_file("colour.rgb", sgi(2, 2, {red, green, blue})));
  EXPECT_EQ(colour.rgba, (std::vector<std::uint8_t>{0, 0, 255, 255, 255, 255, 255, 255, 255, 0, 0, 255, 0, 255, 0, 255}));
  const Texture grey = read_image(temporary_file("grey.sgi", sgi(2, 1, {std::string("\x10\xA0", 2)})));
  EXPECT_EQ(grey.rgba, (std::vector<std::uint8_t>{16, 16, 16, 255, 160, 160, 160, 255}));
}

TEST(ImageIo, RefusesWhatIsNoImage) {
  const std::string png = encode_png(random_texture(64, 64, 3));
  EXPECT_EQ(word_of([] { (void)read_image("/nowhere/no.png"); }), ErrorWord::kFileMissing);
  EXPECT_EQ(word_of([] { (void)decode_image({}, "empty"); }), ErrorWord::kFileBroken);
  EXPECT_EQ(word_of([] { (void)decode_image(bytes_of("these are words"), "words"); }), ErrorWord::kFileBroken);
  EXPECT_EQ(word_of([&] { (void)decode_image(bytes_of(png.substr(0, 20)), "cut in its header"); }), ErrorWord::kFileBroken);
  EXPECT_EQ(word_of([&] { (void)decode_image(bytes_of(png.substr(0, png.size() / 2)), "cut in its pixels"); }), ErrorWord::kFileBroken);
  EXPECT_EQ(word_of([&] { (void)read_image(temporary_file("text.png", "no png")); }), ErrorWord::kFileBroken);
}

TEST(ImageIo, RefusesAHeaderThatClaimsTooManyPixels) {
  const fs::path file = temporary_file("bomb.sgi", sgi(65535, 65535, {"\x01"}));
  EXPECT_EQ(word_of([&] { (void)read_image(file); }), ErrorWord::kFileBroken);
}

// 268 GB, if it were believed.
TEST(ImageIo, RefusesAHeaderThatClaimsTooManyChannels) {
  const fs::path file = temporary_file("channels.sgi", sgi(16384, 16384, std::vector<std::string>(1000)));
  try {
    (void)read_image(file);
    FAIL() << "it was read";
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find("1000 channels"), std::string::npos) << failure.what();
  }
}

}  // namespace
}  // namespace standin
