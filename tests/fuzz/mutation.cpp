#include "tests/fuzz/mutation.h"

#include <cstring>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "render/base/rng.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most_bytes);

namespace standin::fuzz {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostNodes = 20'000;
constexpr std::size_t kGlbHeader = 12, kChunkHeader = 8;

// Every value of a document, the document first.
std::vector<Json*> nodes_of(Json& document) {
  std::vector<Json*> nodes{&document};
  for (std::size_t i = 0; i < nodes.size() && nodes.size() < kMostNodes; ++i)
    if (nodes[i]->is_structured())
      for (Json& child : *nodes[i]) nodes.push_back(&child);
  return nodes;
}

Json strange_value(Rng& rng) {
  static const std::vector<Json> values = {nullptr,
                                           true,
                                           false,
                                           0,
                                           1,
                                           -1,
                                           2,
                                           3,
                                           4,
                                           5,
                                           7,
                                           16,
                                           255,
                                           256,
                                           65535,
                                           65536,
                                           16'777'216,
                                           16'777'217,
                                           2147483647,
                                           2147483648U,
                                           4294967295U,
                                           4294967296U,
                                           9007199254740993LL,
                                           std::numeric_limits<std::int64_t>::min(),
                                           std::numeric_limits<std::uint64_t>::max(),
                                           std::numeric_limits<std::uint64_t>::max() - 3,
                                           0.5,
                                           -0.0,
                                           1e-320,
                                           1e-30,
                                           1e9,
                                           1e18,
                                           1e19,
                                           1e39,
                                           -1e39,
                                           1e300,
                                           1.7976931348623157e308,
                                           "",
                                           "x",
                                           "../x",
                                           "/etc/passwd",
                                           "data:;base64,AAAA",
                                           "SCALAR",
                                           "VEC2",
                                           "VEC3",
                                           "VEC4",
                                           "MASK",
                                           "BLEND",
                                           std::string(300, 'n'),
                                           Json::array(),
                                           Json::object(),
                                           Json::array({0}),
                                           Json::array({0, 0}),
                                           Json::array({1, 2, 3}),
                                           Json::array({1e300, -1e300, 1e300}),
                                           5120,
                                           5121,
                                           5122,
                                           5123,
                                           5125,
                                           5126};
  return values[rng.below(values.size())];
}

Json near_value(const Json& value, Rng& rng) {
  if (value.is_number_integer()) {
    const auto number = value.get<std::uint64_t>();
    const std::uint64_t choices[] = {number + 1, number - 1, number * 2, number / 2, number + rng.below(100)};
    return choices[rng.below(5)];
  }
  const double number = value.get<double>();
  const double choices[] = {-number, number * 1e6, number * 1e-6, number * 1.0000001, 1.0 / number};
  return choices[rng.below(5)];
}

auto some_child(Json& node, Rng& rng) {
  return std::next(node.begin(), static_cast<std::ptrdiff_t>(rng.below(node.size())));  // iterators of objects take no steps but one
}

void double_child(Json& node, Rng& rng) {
  const Json child = *some_child(node, rng);
  if (node.is_array())
    node.push_back(child);
  else
    node[std::string(1, static_cast<char>('a' + rng.below(26)))] = child;
}

void edit(Json& document, Rng& rng) {
  const std::vector<Json*> nodes = nodes_of(document);
  Json& node = *nodes[rng.below(nodes.size())];
  switch (rng.below(6)) {
    case 0:
      node = strange_value(rng);
      break;
    case 1:
      node = node.is_number() ? near_value(node, rng) : strange_value(rng);
      break;
    case 2:
      if (node.is_structured() && !node.empty()) node.erase(some_child(node, rng));
      break;
    case 3:
      if (node.is_structured() && !node.empty()) double_child(node, rng);
      break;
    case 4: {
      const Json graft = *nodes[rng.below(nodes.size())];  // a copy: it may hold the node
      node = graft;
      break;
    }
    default:
      if (node.is_string()) node = mutated_bytes(node.get<std::string>());
  }
}

std::uint32_t word_at(const std::string& bytes, std::size_t offset) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

std::string word(std::size_t value) {
  const auto number = static_cast<std::uint32_t>(value);
  return {reinterpret_cast<const char*>(&number), sizeof number};
}

std::string chunk(const std::string& content, const char* type, char filler) {
  std::string padded = content;
  padded.resize((content.size() + 3) / 4 * 4, filler);
  return word(padded.size()) + std::string(type, 4) + padded;
}

}  // namespace

std::string MutableInput::text(std::size_t from) const {
  return from >= size ? "" : std::string(reinterpret_cast<const char*>(data) + from, size - from);
}

std::size_t MutableInput::replaced(const std::string& text, std::size_t from) {
  if (from > size || text.size() > most_bytes - from) return size;
  std::memcpy(data + from, text.data(), text.size());
  return from + text.size();
}

std::string mutated_bytes(const std::string& bytes) {
  constexpr std::size_t kRoom = 256;
  std::string room = bytes;
  room.resize(bytes.size() + kRoom);
  room.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(room.data()), bytes.size(), room.size()));
  return room;
}

std::string mutated_json(const std::string& text, unsigned seed) {
  Json document = Json::parse(text, nullptr, false);
  if (document.is_discarded()) return mutated_bytes(text);
  Rng rng(seed);
  for (std::uint64_t edits = 1 + rng.below(4); edits > 0; --edits) edit(document, rng);
  return document.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string mutated_glb(const std::string& glb, unsigned seed) {
  const bool has_json = glb.size() >= kGlbHeader + kChunkHeader && glb.starts_with("glTF");
  const std::size_t json_size = has_json ? word_at(glb, kGlbHeader) : 0;
  constexpr std::size_t kJson = kGlbHeader + kChunkHeader;
  if (!has_json || json_size > glb.size() - kJson) return mutated_json(glb, seed);
  std::string json = glb.substr(kJson, json_size);
  const std::size_t binary_at = kJson + json_size + kChunkHeader;
  std::string binary = binary_at <= glb.size() ? glb.substr(binary_at) : "";
  if (!binary.empty() && seed % 4 == 0)
    binary = mutated_bytes(binary);
  else
    json = mutated_json(json, seed / 4);
  const std::string chunks = chunk(json, "JSON", ' ') + (binary.empty() ? "" : chunk(binary, "BIN\0", '\0'));
  return "glTF" + word(2) + word(kGlbHeader + chunks.size()) + chunks;
}

std::size_t mutate(MutableInput input, unsigned seed, const std::function<std::string(const std::string&, unsigned)>& mutation,
                   std::size_t from) {
  if (seed % 4 == 0 || input.size <= from) return LLVMFuzzerMutate(input.data, input.size, input.most_bytes);
  return input.replaced(mutation(input.text(from), seed / 4), from);
}

}  // namespace standin::fuzz
