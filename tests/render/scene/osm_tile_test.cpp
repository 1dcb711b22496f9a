#include "render/scene/osm_tile.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include "render/base/error.h"
#include "tests/render/scene/tile_maker.h"

namespace standin {
namespace {

using test::rectangle;
using test::reversed;
using test::TileMaker;

std::vector<TileFeature> read(const std::string& bytes) {
  return read_vector_tile({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, "here.mvt");
}

/// The sentence of the Failure(kFileBroken) that reading throws, "" where it reads.
std::string refusal(const std::string& bytes) {
  try {
    (void)read(bytes);
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kFileBroken);
    return failure.what();
  }
  return "";
}

std::string gzipped(std::string plain) {
  std::string packed(plain.size() + 200, '\0');
  z_stream stream{};
  deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(plain.data());
  stream.avail_in = static_cast<uInt>(plain.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

TileMaker yard_and_street() {
  TileMaker tile(1000);
  tile.polygon({{"building", "yes"}, {"building:levels", "5"}}, {rectangle(100, 100, 500, 300), reversed(rectangle(200, 150, 400, 250))});
  tile.line({{"highway", "residential"}}, {{0, 400}, {-50, 450}, {2000, 500}});
  return tile;
}

TEST(VectorTile, TellsWhatWasWritten) {
  const auto features = read(yard_and_street().bytes());
  ASSERT_EQ(features.size(), 2U);
  EXPECT_EQ(features[0].kind, TileFeature::Kind::kPolygon);
  EXPECT_EQ(features[0].tag("building:levels"), "5");
  EXPECT_EQ(features[0].tag("height"), "");
  ASSERT_EQ(features[0].paths.size(), 2U);
  EXPECT_EQ(features[0].paths[0], (Path{{0.1, 0.1}, {0.5, 0.1}, {0.5, 0.3}, {0.1, 0.3}}));
  EXPECT_EQ(features[0].paths[1], (Path{{0.2, 0.25}, {0.4, 0.25}, {0.4, 0.15}, {0.2, 0.15}}));
  EXPECT_GT(signed_area(features[0].paths[0]), 0.0);
  EXPECT_LT(signed_area(features[0].paths[1]), 0.0);
  EXPECT_EQ(features[1].kind, TileFeature::Kind::kLine);
  EXPECT_EQ(features[1].paths, (std::vector<Path>{{{0.0, 0.4}, {-0.05, 0.45}, {2.0, 0.5}}}));
}

TEST(VectorTile, GzippedIsTheSame) {
  const std::string plain = yard_and_street().bytes();
  const std::string packed = gzipped(plain);
  ASSERT_EQ(read(packed).size(), 2U);
  EXPECT_EQ(read(packed)[0].paths, read(plain)[0].paths);
  EXPECT_NE(refusal(packed.substr(0, packed.size() / 2)), "");
  EXPECT_NE(refusal(packed.substr(0, 2) + std::string(40, 'x')), "");
}

TEST(VectorTile, ValuesOfEveryTypeBecomeText) {
  TileMaker tile;
  using Writer = protozero::pbf_writer;
  const std::vector<std::pair<std::string, std::uint32_t>> values{
      {"word", tile.value([](Writer& w) { w.add_string(1, "word"); })}, {"0.5", tile.value([](Writer& w) { w.add_float(2, 0.5F); })},
      {"2.25", tile.value([](Writer& w) { w.add_double(3, 2.25); })},   {"-7", tile.value([](Writer& w) { w.add_int64(4, -7); })},
      {"12", tile.value([](Writer& w) { w.add_uint64(5, 12); })},       {"-3", tile.value([](Writer& w) { w.add_sint64(6, -3); })},
      {"true", tile.value([](Writer& w) { w.add_bool(7, true); })}};
  std::vector<std::uint32_t> tags;
  for (const auto& [text, index] : values) tags.insert(tags.end(), {tile.key(text), index});
  tile.raw(1, tags, {1U | (1U << 3U), 2, 2});
  const auto features = read(tile.bytes());
  ASSERT_EQ(features.size(), 1U);
  for (const auto& [text, index] : values) EXPECT_EQ(features[0].tag(text), text);
}

// A tile of one layer cannot end early without that layer ending early.
TEST(VectorTile, CutAnywhereIsRefused) {
  const std::string whole = yard_and_street().bytes();
  for (std::size_t size = 1; size < whole.size(); ++size) {
    const std::string sentence = refusal(whole.substr(0, size));
    EXPECT_NE(sentence.find("here.mvt"), std::string::npos) << size << " of " << whole.size();
  }
  EXPECT_EQ(refusal(whole), "");
  EXPECT_TRUE(read("").empty()) << "an empty tile is a tile";
}

TEST(VectorTile, OtherFilesAreRefused) {
  EXPECT_NE(refusal("This is not a tile, it is a sentence.\n"), "");
  EXPECT_NE(refusal("glTF\x02"), "");
  EXPECT_NE(refusal(std::string(300, '\xFF')), "");
  EXPECT_NE(refusal(std::string(64, '\0')), "");
}

TEST(VectorTile, NumbersOutOfRangeAreRefused) {
  const auto with = [](const std::vector<std::uint32_t>& tags, const std::vector<std::uint32_t>& geometry) {
    return refusal(TileMaker().raw(3, tags, geometry).bytes());
  };
  EXPECT_NE(with({0, 0}, {}).find("out of range"), std::string::npos);
  EXPECT_NE(with({0}, {}).find("no value"), std::string::npos);
  EXPECT_NE(with({}, {3}).find("unknown geometry command"), std::string::npos);
  EXPECT_NE(with({}, {2U | (1U << 3U), 2, 2}).find("starts nowhere"), std::string::npos);
  EXPECT_NE(with({}, {1U | (1U << 3U), 2}).find("ends early"), std::string::npos);
  EXPECT_NE(with({}, {1U | (0x1FFFFFFFU << 3U), 2, 2}).find("ends early"), std::string::npos);
  EXPECT_NE(refusal(TileMaker(0).line({}, {{0, 0}, {1, 1}}).bytes()).find("extent"), std::string::npos);
}

}  // namespace
}  // namespace standin
