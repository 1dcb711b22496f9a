#include "render/scene/ac3d.h"

#include <algorithm>
#include <array>

namespace standin {
namespace {

bool is_lighting_layer(std::string_view line) {
  static constexpr std::array<std::string_view, 3> kLayers{" tiled", " skids", " shad"};
  if (!line.starts_with("texture ")) return false;
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
  return std::any_of(kLayers.begin(), kLayers.end(), [&](std::string_view layer) { return line.ends_with(layer); });
}

}  // namespace

std::string with_base_textures_only(std::string_view ac3d) {
  std::string result;
  result.reserve(ac3d.size());
  while (!ac3d.empty()) {
    const std::size_t end = std::min(ac3d.find('\n'), ac3d.size() - 1) + 1;
    const std::string_view line = ac3d.substr(0, end);
    if (!is_lighting_layer(line)) result += line;
    ac3d.remove_prefix(end);
  }
  return result;
}

}  // namespace standin
