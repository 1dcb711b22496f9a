// Mutations that keep a format's frame: values of JSON instead of its bytes, and the JSON and the binary of a GLB with the lengths put
// right.
//
// libFuzzer's own mutations of bytes hardly ever get past a JSON parser or the header of a chunk; readers behind those are reached by
// these.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace standin::fuzz {

/// libFuzzer's custom mutators work in place and return the new size.
struct MutableInput {
  std::uint8_t* data = nullptr;
  std::size_t size = 0;
  std::size_t most_bytes = 0;

  [[nodiscard]] std::string text(std::size_t from = 0) const;
  /// Leaves the first `from` bytes as they are. What has no room is not taken.
  std::size_t replaced(const std::string& text, std::size_t from = 0);
};

/// Some values changed, taken away, doubled or put elsewhere; what is no JSON has its bytes mutated.
[[nodiscard]] std::string mutated_json(const std::string& text, unsigned seed);
/// Of the JSON chunk or the binary one; what is no GLB is taken for JSON.
[[nodiscard]] std::string mutated_glb(const std::string& glb, unsigned seed);
/// By libFuzzer itself.
[[nodiscard]] std::string mutated_bytes(const std::string& bytes);

/// One mutation in four is of bytes: what is wrong in the frame must be seen, too.
std::size_t mutate(MutableInput input, unsigned seed, const std::function<std::string(const std::string&, unsigned)>& mutation,
                   std::size_t from = 0);

}  // namespace standin::fuzz
