// What all writers of binary glTF 2.0 share: its names, buffer views at multiples of 4, and the container: a header, the JSON and one
// binary chunk, each padded to 4 bytes.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/error.h"

namespace standin {

using OrderedJson = nlohmann::ordered_json;

/// Names of glTF 2.0.
namespace gltf {
inline constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125, kArrayBuffer = 34962, kElementArrayBuffer = 34963;
inline constexpr std::uint32_t kHighestShort = 0xFFFE;  // index 65535 itself is kept free: it restarts primitives
}  // namespace gltf

/// glTF forbids empty lists.
inline void add_unless_empty(OrderedJson& json, const char* key, const OrderedJson& list) {
  if (!list.empty()) json[key] = list;
}

inline void pad_binary(std::string& binary) {
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
}

/// Appends `bytes` to the binary chunk, and a view of them to `views`; returns its number. Stride or target 0: none.
inline std::size_t add_buffer_view(OrderedJson& views, std::string& binary, std::string_view bytes, std::size_t stride, int target) {
  pad_binary(binary);
  OrderedJson view{{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}};
  if (stride != 0) view["byteStride"] = stride;
  if (target != 0) view["target"] = target;
  views.push_back(std::move(view));
  binary += bytes;
  return views.size() - 1;
}

/// The values' bytes: glTF is little-endian, as every target of ours is.
template <class Value>
std::string_view bytes_of_values(const std::vector<Value>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)};
}

class GlbContainer {
 public:
  /// Adds `buffers` to the JSON. `binary` must outlive this; empty: there is no chunk of it.
  GlbContainer(OrderedJson json, std::string& binary) : binary_(binary) {
    pad_binary(binary);
    binary_ = binary;
    if (!binary.empty()) json["buffers"] = OrderedJson::array({{{"byteLength", binary.size()}}});
    json_ = json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
    json_.resize((json_.size() + 3) / 4 * 4, ' ');
    const std::size_t length = sizeof head_ + json_.size() + (binary.empty() ? 0 : sizeof binary_head_ + binary.size());
    if (length > 0xFFFFFFFFU)
      throw Failure(ErrorWord::kBadUsage, "the scene takes " + std::to_string(length) + " bytes; a GLB holds 4 GiB");
    const auto word = [](std::size_t value) { return static_cast<std::uint32_t>(value); };
    head_ = {0x46546C67U, 2, word(length), word(json_.size()), 0x4E4F534AU};
    binary_head_ = {word(binary.size()), 0x004E4942U};
    pieces_ = {bytes(head_), json_, bytes(binary_head_), binary_};
  }
  GlbContainer(const GlbContainer&) = delete;
  GlbContainer& operator=(const GlbContainer&) = delete;

  /// The file's bytes in order.
  [[nodiscard]] std::span<const std::string_view> pieces() const { return {pieces_.data(), binary_.empty() ? 2U : 4U}; }
  [[nodiscard]] std::string joined() const {
    std::string all;
    for (const std::string_view piece : pieces()) all += piece;
    return all;
  }

 private:
  template <class List>
  static std::string_view bytes(const List& list) {
    return {reinterpret_cast<const char*>(list.data()), sizeof list};
  }

  std::string json_;
  std::string_view binary_;
  std::array<std::uint32_t, 5> head_{};
  std::array<std::uint32_t, 2> binary_head_{};
  std::array<std::string_view, 4> pieces_{};
};

}  // namespace standin
