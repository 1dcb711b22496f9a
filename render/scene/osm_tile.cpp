#include "render/scene/osm_tile.h"

#include <zlib.h>

#include <charconv>
#include <protozero/pbf_reader.hpp>

#include "render/base/error.h"

namespace standin {
namespace {

using protozero::pbf_reader;
using protozero::pbf_wire_type;
using protozero::tag_and_type;

constexpr auto kVarint = pbf_wire_type::varint;
constexpr auto kBytes = pbf_wire_type::length_delimited;
constexpr std::size_t kLargestTile = std::size_t{256} << 20U;

struct Broken {
  std::string why;
};

std::string text_of(double number) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

bool is_gzip(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 2 && bytes[0] == 0x1F && bytes[1] == 0x8B;
}

std::vector<std::uint8_t> unzipped(std::span<const std::uint8_t> bytes) {
  constexpr int kGzip = 16 + MAX_WBITS;
  z_stream stream{};
  if (inflateInit2(&stream, kGzip) != Z_OK) throw Failure(ErrorWord::kInternal, "zlib does not start");
  std::vector<std::uint8_t> result(std::max<std::size_t>(4 * bytes.size(), 1024));
  stream.next_in = const_cast<Bytef*>(bytes.data());  // zlib never writes there
  stream.avail_in = static_cast<uInt>(bytes.size());
  int state = Z_OK;
  while (state == Z_OK && result.size() <= kLargestTile) {
    if (stream.total_out == result.size()) result.resize(2 * result.size());
    stream.next_out = result.data() + stream.total_out;
    stream.avail_out = static_cast<uInt>(result.size() - stream.total_out);
    state = inflate(&stream, Z_NO_FLUSH);
  }
  result.resize(stream.total_out);
  inflateEnd(&stream);
  if (state != Z_STREAM_END) throw Broken{"its gzip stream is broken or ends early"};
  return result;
}

std::string read_value(pbf_reader value) {
  while (value.next()) {
    switch (value.tag_and_type()) {
      case tag_and_type(1, kBytes):
        return value.get_string();
      case tag_and_type(2, pbf_wire_type::fixed32):
        return text_of(static_cast<double>(value.get_float()));
      case tag_and_type(3, pbf_wire_type::fixed64):
        return text_of(value.get_double());
      case tag_and_type(4, kVarint):
        return std::to_string(value.get_int64());
      case tag_and_type(5, kVarint):
        return std::to_string(value.get_uint64());
      case tag_and_type(6, kVarint):
        return std::to_string(value.get_sint64());
      case tag_and_type(7, kVarint):
        return value.get_bool() ? "true" : "false";
      default:
        value.skip();
    }
  }
  throw Broken{"a tag's value is empty"};
}

// Commands and zigzag differences (specification, 4.3).
std::vector<Path> read_paths(std::span<const std::uint32_t> stream, double extent) {
  enum Command : std::uint32_t { kMoveTo = 1, kLineTo = 2, kClosePath = 7 };
  std::vector<Path> paths;
  std::int64_t x = 0;
  std::int64_t y = 0;
  for (std::size_t i = 0; i < stream.size();) {
    const std::uint32_t command = stream[i] & 7U;
    const std::size_t count = stream[i] >> 3U;
    ++i;
    if (command == kClosePath) continue;
    if (command != kMoveTo && command != kLineTo) throw Broken{"unknown geometry command " + std::to_string(command)};
    if (2 * count > stream.size() - i) throw Broken{"a geometry ends early"};
    if (command == kLineTo && paths.empty()) throw Broken{"a line starts nowhere"};
    for (std::size_t k = 0; k < count; ++k, i += 2) {
      if (command == kMoveTo) paths.emplace_back();
      x += protozero::decode_zigzag32(stream[i]);
      y += protozero::decode_zigzag32(stream[i + 1]);
      paths.back().push_back(Vec2(static_cast<double>(x), static_cast<double>(y)) / extent);
    }
  }
  return paths;
}

// One layer; its features may come before the keys and values that they refer to.
class LayerReader {
 public:
  void read(pbf_reader layer, std::vector<TileFeature>& features) {
    std::vector<pbf_reader> raw;
    while (layer.next()) {
      switch (layer.tag_and_type()) {
        case tag_and_type(2, kBytes):
          raw.push_back(layer.get_message());
          break;
        case tag_and_type(3, kBytes):
          keys_.push_back(layer.get_string());
          break;
        case tag_and_type(4, kBytes):
          values_.push_back(read_value(layer.get_message()));
          break;
        case tag_and_type(5, kVarint):
          extent_ = layer.get_uint32();
          break;
        default:
          layer.skip();
      }
    }
    if (extent_ == 0) throw Broken{"a layer's extent is 0"};
    for (const pbf_reader& feature : raw) features.push_back(read_feature(feature));
  }

 private:
  [[nodiscard]] TileFeature read_feature(pbf_reader reader) const {
    TileFeature feature;
    while (reader.next()) {
      switch (reader.tag_and_type()) {
        case tag_and_type(2, kBytes):
          read_tags(reader.get_packed_uint32(), feature);
          break;
        case tag_and_type(3, kVarint):
          feature.kind = kind_of(reader.get_enum());
          break;
        case tag_and_type(4, kBytes): {
          const auto packed = reader.get_packed_uint32();
          feature.paths = read_paths(std::vector<std::uint32_t>(packed.begin(), packed.end()), extent_);
          break;
        }
        default:
          reader.skip();
      }
    }
    return feature;
  }

  static TileFeature::Kind kind_of(std::int32_t number) {
    return number == 3 ? TileFeature::Kind::kPolygon : (number == 2 ? TileFeature::Kind::kLine : TileFeature::Kind::kPoint);
  }

  template <typename Packed>
  void read_tags(const Packed& packed, TileFeature& feature) const {
    const std::vector<std::uint32_t> indices(packed.begin(), packed.end());
    if (indices.size() % 2 != 0) throw Broken{"a tag has no value"};
    for (std::size_t i = 0; i < indices.size(); i += 2) {
      if (indices[i] >= keys_.size() || indices[i + 1] >= values_.size()) throw Broken{"a tag's index is out of range"};
      feature.tags[keys_[indices[i]]] = values_[indices[i + 1]];
    }
  }

  std::vector<std::string> keys_;
  std::vector<std::string> values_;
  std::uint32_t extent_ = 4096;
};

std::vector<TileFeature> read_plain(std::span<const std::uint8_t> bytes) {
  std::vector<TileFeature> features;
  std::size_t layers = 0;
  pbf_reader tile(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  while (tile.next()) {
    if (tile.tag_and_type() == tag_and_type(3, kBytes)) {
      LayerReader().read(tile.get_message(), features);
      ++layers;
    } else {
      tile.skip();
    }
  }
  if (layers == 0 && !bytes.empty()) throw Broken{"it holds no layer"};
  return features;
}

}  // namespace

const std::string& TileFeature::tag(const std::string& key) const {
  static const std::string kNone;
  const auto found = tags.find(key);
  return found == tags.end() ? kNone : found->second;
}

std::vector<TileFeature> read_vector_tile(std::span<const std::uint8_t> bytes, const std::string& place) {
  const auto broken = [&](const std::string& why) { return Failure(ErrorWord::kFileBroken, place + " is not a vector tile: " + why); };
  try {
    return is_gzip(bytes) ? read_plain(unzipped(bytes)) : read_plain(bytes);
  } catch (const Broken& error) {
    throw broken(error.why);
  } catch (const protozero::exception& error) {
    throw broken(error.what());
  }
}

}  // namespace standin
