// Vector tiles for tests, written message by message as specification 2.1 has them.
#pragma once

#include <cstdint>
#include <map>
#include <protozero/pbf_writer.hpp>
#include <string>
#include <vector>

namespace standin::test {

/// x and y in units of the tile's extent.
using TilePath = std::vector<std::pair<int, int>>;
using Tags = std::map<std::string, std::string>;

class TileMaker {
 public:
  explicit TileMaker(std::uint32_t extent = 4096) : extent_(extent) {}

  TileMaker& polygon(const Tags& tags, const std::vector<TilePath>& rings) { return feature(3, tags, rings, true); }
  TileMaker& line(const Tags& tags, const TilePath& path) { return feature(2, tags, {path}, false); }
  /// With whatever numbers in place of tags and geometry.
  TileMaker& raw(std::uint32_t kind, const std::vector<std::uint32_t>& tags, const std::vector<std::uint32_t>& geometry) {
    std::string bytes;
    protozero::pbf_writer writer(bytes);
    writer.add_packed_uint32(2, tags.begin(), tags.end());
    writer.add_enum(3, static_cast<std::int32_t>(kind));
    writer.add_packed_uint32(4, geometry.begin(), geometry.end());
    features_.push_back(bytes);
    return *this;
  }
  /// The index of a value written by `write`, for raw features.
  template <typename Write>
  std::uint32_t value(const Write& write) {
    std::string bytes;
    protozero::pbf_writer writer(bytes);
    write(writer);
    values_.push_back(bytes);
    return static_cast<std::uint32_t>(values_.size() - 1);
  }
  std::uint32_t key(const std::string& name) {
    keys_.push_back(name);
    return static_cast<std::uint32_t>(keys_.size() - 1);
  }

  [[nodiscard]] std::string bytes() const {
    std::string layer_bytes;
    protozero::pbf_writer layer(layer_bytes);
    layer.add_uint32(15, 2);
    layer.add_string(1, "osm");
    for (const std::string& feature : features_) layer.add_message(2, feature);
    for (const std::string& key : keys_) layer.add_string(3, key);
    for (const std::string& value : values_) layer.add_message(4, value);
    layer.add_uint32(5, extent_);
    std::string tile_bytes;
    protozero::pbf_writer(tile_bytes).add_message(3, layer_bytes);
    return tile_bytes;
  }

 private:
  TileMaker& feature(std::uint32_t kind, const Tags& tags, const std::vector<TilePath>& paths, bool closed) {
    std::vector<std::uint32_t> indices;
    for (const auto& [name, text] : tags) {
      indices.push_back(key(name));
      indices.push_back(value([&text = text](protozero::pbf_writer& writer) { writer.add_string(1, text); }));
    }
    std::vector<std::uint32_t> stream;
    std::pair<int, int> at{0, 0};
    const auto step = [&](const std::pair<int, int>& to) {
      stream.push_back(protozero::encode_zigzag32(to.first - at.first));
      stream.push_back(protozero::encode_zigzag32(to.second - at.second));
      at = to;
    };
    for (const TilePath& path : paths) {
      stream.push_back(1U | (1U << 3U));
      step(path.front());
      stream.push_back(2U | (static_cast<std::uint32_t>(path.size() - 1) << 3U));
      for (std::size_t i = 1; i < path.size(); ++i) step(path[i]);
      if (closed) stream.push_back(7U | (1U << 3U));
    }
    return raw(kind, indices, stream);
  }

  std::uint32_t extent_;
  std::vector<std::string> features_;
  std::vector<std::string> keys_;
  std::vector<std::string> values_;
};

/// The four corners of a rectangle, clockwise on a map, as outer rings run.
inline TilePath rectangle(int left, int top, int right, int bottom) {
  return {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
}

inline TilePath reversed(TilePath path) {
  return {path.rbegin(), path.rend()};
}

}  // namespace standin::test
