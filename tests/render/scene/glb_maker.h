// Small GLB files by hand: bytes are appended as buffer views with an accessor each; the JSON stays open to every kind of damage.
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace standin::test {

class GlbMaker {
 public:
  using Json = nlohmann::json;

  GlbMaker() {
    json["asset"]["version"] = "2.0";
    json["scene"] = 0;
    json["scenes"] = Json::array({{{"nodes", {0}}}});
  }

  std::size_t view(const void* data, std::size_t size) {
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", size}});
    binary.append(static_cast<const char*>(data), size);
    return json["bufferViews"].size() - 1;
  }

  template <typename T>
  std::size_t accessor(const std::vector<T>& numbers, int component_type, const std::string& type) {
    const std::size_t components = type == "SCALAR" ? 1 : static_cast<std::size_t>(type.back() - '0');
    const std::size_t at = view(numbers.data(), numbers.size() * sizeof(T));
    json["accessors"].push_back(
        {{"bufferView", at}, {"componentType", component_type}, {"count", numbers.size() / components}, {"type", type}});
    return json["accessors"].size() - 1;
  }
  std::size_t floats(const std::vector<float>& numbers, const std::string& type) { return accessor(numbers, 5126, type); }
  std::size_t indices(const std::vector<std::uint32_t>& numbers) { return accessor(numbers, 5125, "SCALAR"); }

  /// One mesh of one primitive, and a node that shows it.
  void show(const std::vector<float>& positions, const std::vector<std::uint32_t>& corners) {
    Json primitive{{"attributes", {{"POSITION", floats(positions, "VEC3")}}}};
    if (!corners.empty()) primitive["indices"] = indices(corners);
    json["meshes"].push_back({{"name", "mesh"}, {"primitives", {primitive}}});
    json["nodes"].push_back({{"name", "node"}, {"mesh", json["meshes"].size() - 1}});
  }
  Json& primitive() { return json["meshes"][0]["primitives"][0]; }

  [[nodiscard]] std::string glb() const {
    Json whole = json;
    if (!whole.contains("buffers")) whole["buffers"] = Json::array({{{"byteLength", binary.size()}}});
    std::string text = whole.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string data = binary;
    data.resize((data.size() + 3) / 4 * 4, '\0');
    std::string file = "glTF" + word(2) + word(12 + 8 + text.size() + 8 + data.size());
    return file + word(text.size()) + "JSON" + text + word(data.size()) + std::string("BIN\0", 4) + data;
  }

  [[nodiscard]] static std::string word(std::size_t value) {
    const auto number = static_cast<std::uint32_t>(value);
    std::string bytes(4, '\0');
    std::memcpy(bytes.data(), &number, 4);
    return bytes;
  }

  Json json;
  std::string binary;
};

/// A unit square of two triangles in the plane z = 0.
inline GlbMaker square_glb() {
  GlbMaker maker;
  maker.show({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, {0, 1, 2, 0, 2, 3});
  return maker;
}

}  // namespace standin::test
