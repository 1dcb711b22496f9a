// Reads one Mapbox vector tile (specification 2.1), the form in which extracts of OpenStreetMap are shipped: protocol buffers, gzipped or
// not. protozero walks the messages; what is done here is the tile's own geometry and tag encoding, with every index checked.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "render/scene/plan_geometry.h"

namespace standin {

struct TileFeature {
  enum class Kind { kPoint, kLine, kPolygon } kind = Kind::kPoint;
  std::map<std::string, std::string> tags;  // numbers and booleans as text
  std::vector<Path> paths;                  // in widths of the tile, x east and y south; rings do not repeat their first point

  /// The tag's text, "" where there is none.
  [[nodiscard]] const std::string& tag(const std::string& key) const;
};

/// Throws Failure(kFileBroken) for bytes that are no vector tile or end early; `place` names them in the message.
[[nodiscard]] std::vector<TileFeature> read_vector_tile(std::span<const std::uint8_t> bytes, const std::string& place);

}  // namespace standin
