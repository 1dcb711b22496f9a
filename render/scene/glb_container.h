// The container of binary glTF 2.0: a header, the JSON and one binary chunk, each padded to 4 bytes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "render/base/error.h"

namespace standin {

class GlbContainer {
 public:
  /// `binary` is padded already, and must outlive this.
  GlbContainer(std::string json, std::string_view binary) : json_(std::move(json)), binary_(binary) {
    json_.resize((json_.size() + 3) / 4 * 4, ' ');
    const std::size_t length = sizeof head_ + json_.size() + sizeof binary_head_ + binary_.size();
    if (length > 0xFFFFFFFFU)
      throw Failure(ErrorWord::kBadUsage, "the scene takes " + std::to_string(length) + " bytes; a GLB holds 4 GiB");
    const auto word = [](std::size_t value) { return static_cast<std::uint32_t>(value); };
    head_ = {0x46546C67U, 2, word(length), word(json_.size()), 0x4E4F534AU};
    binary_head_ = {word(binary_.size()), 0x004E4942U};
  }

  /// The file's bytes in order.
  [[nodiscard]] std::array<std::string_view, 4> pieces() const { return {bytes(head_), json_, bytes(binary_head_), binary_}; }

 private:
  template <class List>
  static std::string_view bytes(const List& list) {
    return {reinterpret_cast<const char*>(list.data()), sizeof list};
  }

  std::string json_;
  std::string_view binary_;
  std::array<std::uint32_t, 5> head_{};
  std::array<std::uint32_t, 2> binary_head_{};
};

}  // namespace standin
