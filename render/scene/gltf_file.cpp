#include "render/scene/gltf_file.h"

#include <meshoptimizer.h>

#include <cmath>
#include <cstring>

#include "render/base/error.h"
#include "render/base/json_text.h"

namespace standin {
namespace {

[[noreturn]] void broken(const std::string& sentence) {
  throw Failure(ErrorWord::kFileBroken, sentence);
}

std::uint32_t word_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

constexpr int kDeepestJson = 200;  // than any real glTF
// The vertex codec packs at most 64:1; a larger claim is not worth its memory.
constexpr std::uint64_t kBestRatio = 128;
constexpr std::uint64_t kSlack = 4096;  // small files have headers, too

std::string at(const char* array, std::uint64_t index) {
  return std::string(array) + "[" + std::to_string(index) + "]";
}

}  // namespace

const Json* member(const Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

std::optional<std::uint64_t> whole_number(const Json& object, const char* key, const std::string& place) {
  const Json* value = member(object, key);
  if (value == nullptr) return std::nullopt;
  if (value->is_number_unsigned()) return value->get<std::uint64_t>();
  const double real = value->is_number() ? value->get<double>() : -1.0;
  if (!(real >= 0.0 && real <= 9e15 && real == std::floor(real))) {
    broken(place + "." + key + " is " + value->dump().substr(0, 40) + ", not a whole number >= 0");
  }
  return static_cast<std::uint64_t>(real);
}

std::uint64_t required_number(const Json& object, const char* key, const std::string& place) {
  const auto value = whole_number(object, key, place);
  if (!value) broken(place + " has no " + key);
  return *value;
}

double real_number(const Json& object, const char* key, double otherwise, const std::string& place) {
  const Json* value = member(object, key);
  if (value == nullptr) return otherwise;
  if (!value->is_number() || !std::isfinite(value->get<double>())) broken(place + "." + key + " is not a finite number");
  return value->get<double>();
}

std::optional<std::vector<double>> real_numbers(const Json& object, const char* key, std::size_t count, const std::string& place) {
  const Json* list = member(object, key);
  if (list == nullptr) return std::nullopt;
  if (!list->is_array() || list->size() != count) broken(place + "." + key + " is not a list of " + std::to_string(count) + " numbers");
  std::vector<double> values;
  for (const Json& value : *list) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) broken(place + "." + key + " holds something else than finite numbers");
    values.push_back(value.get<double>());
  }
  return values;
}

std::string text(const Json& object, const char* key, const std::string& otherwise) {
  const Json* value = member(object, key);
  return value != nullptr && value->is_string() ? value->get<std::string>() : otherwise;
}

const Json* extension(const Json& object, const char* name) {
  const Json* extensions = member(object, "extensions");
  return extensions == nullptr ? nullptr : member(*extensions, name);
}

GltfFile::GltfFile(std::span<const std::uint8_t> bytes, const SceneFolder& folder) : folder_(folder) {
  const bool binary = bytes.size() >= 4 && word_at(bytes, 0) == 0x46546C67U;  // "glTF"
  if (binary) {
    parse_container(bytes);
  } else {
    parse_json(bytes);
  }
}

void GltfFile::parse_container(std::span<const std::uint8_t> bytes) {
  constexpr std::uint32_t kJsonChunk = 0x4E4F534AU;
  constexpr std::uint32_t kBinaryChunk = 0x004E4942U;
  if (bytes.size() < 20) broken("the GLB ends after " + std::to_string(bytes.size()) + " bytes, inside its header");
  if (const auto version = word_at(bytes, 4); version != 2) broken("the GLB is of version " + std::to_string(version) + ", not 2");
  const std::size_t length = word_at(bytes, 8);
  if (length > bytes.size()) {
    broken("the GLB claims " + std::to_string(length) + " bytes and has " + std::to_string(bytes.size()) + ": truncated");
  }
  for (std::size_t offset = 12, chunk = 0; offset + 8 <= length; ++chunk) {
    const std::size_t size = word_at(bytes, offset);
    const std::uint32_t type = word_at(bytes, offset + 4);
    if (size > length - offset - 8) broken("chunk " + std::to_string(chunk) + " of the GLB reaches past its end");
    const auto content = bytes.subspan(offset + 8, size);
    if (chunk == 0 && type != kJsonChunk) broken("the first chunk of the GLB is not JSON");
    if (chunk == 0) parse_json(content);
    if (type == kBinaryChunk && binary_chunk_.empty()) {
      binary_chunk_ = content;
      buffer_bytes_ = content.size();
    }
    offset += 8 + (size + 3) / 4 * 4;
  }
  if (json_.is_null()) broken("the GLB has no JSON chunk");
}

void GltfFile::parse_json(std::span<const std::uint8_t> bytes) {
  const std::string_view text_of_json(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (nested_deeper(text_of_json, kDeepestJson)) broken("the glTF JSON is nested deeper than " + std::to_string(kDeepestJson));
  json_ = Json::parse(text_of_json, nullptr, false);
  if (json_.is_discarded() || !json_.is_object()) broken("the glTF JSON cannot be parsed");
  const Json* asset = member(json_, "asset");
  const std::string version = asset == nullptr ? "" : text(*asset, "version");
  if (!version.starts_with("2.")) broken("the glTF asset.version is '" + version + "', not 2.x");
}

const Json& GltfFile::item(const char* array, std::uint64_t index, const std::string& place) const {
  if (index >= count(array)) broken(place + " refers to " + at(array, index) + ", of which there are " + std::to_string(count(array)));
  return json_[array][static_cast<std::size_t>(index)];
}

std::size_t GltfFile::count(const char* array) const {
  const Json* list = member(json_, array);
  return list != nullptr && list->is_array() ? list->size() : 0;
}

std::span<const std::uint8_t> GltfFile::buffer(std::uint64_t index) {
  const std::string place = at("buffers", index);
  const Json& buffer = item("buffers", index, place);
  const std::uint64_t length = required_number(buffer, "byteLength", place);
  const std::string uri = text(buffer, "uri");
  std::span<const std::uint8_t> content = binary_chunk_;
  if (!uri.empty()) {
    const std::string source = is_data_uri(uri) ? "data:" + place : folder_.resolve_uri(uri).string();
    auto [place_in_cache, fresh] = external_buffers_.try_emplace(source);
    if (fresh) {
      place_in_cache->second = is_data_uri(uri) ? decode_data_uri(uri, place) : read_bytes(source);
      buffer_bytes_ += place_in_cache->second.size();
    }
    content = place_in_cache->second;
  } else if (index != 0) {
    broken(place + " has no uri");
  }
  if (length > content.size()) {
    broken(place + " claims " + std::to_string(length) + " bytes and has " + std::to_string(content.size()) + ": truncated");
  }
  return content.first(static_cast<std::size_t>(length));
}

// The bytes [byteOffset, byteOffset + byteLength) of a buffer.
std::span<const std::uint8_t> GltfFile::slice(const Json& view, const std::string& place) {
  const auto whole = buffer(required_number(view, "buffer", place));
  const std::uint64_t offset = whole_number(view, "byteOffset", place).value_or(0);
  const std::uint64_t length = required_number(view, "byteLength", place);
  if (offset > whole.size() || length > whole.size() - offset) {
    broken(place + " covers bytes " + std::to_string(offset) + " + " + std::to_string(length) + " of a buffer of " +
           std::to_string(whole.size()));
  }
  return whole.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

std::span<const std::uint8_t> GltfFile::view(std::uint64_t index) {
  const std::string place = at("bufferViews", index);
  const Json& view = item("bufferViews", index, place);
  const Json* packed = extension(view, "EXT_meshopt_compression");
  if (packed == nullptr) return slice(view, place);
  auto [place_in_cache, fresh] = decompressed_views_.try_emplace(index);
  if (fresh) place_in_cache->second = decompressed(*packed, place);
  return place_in_cache->second;
}

std::vector<std::uint8_t> GltfFile::decompressed(const Json& packed, const std::string& place) {
  const auto bytes = slice(packed, place);
  const std::uint64_t count = required_number(packed, "count", place);
  const std::uint64_t stride = required_number(packed, "byteStride", place);
  if (stride == 0 || stride > 256 || count > kBestRatio * (bytes.size() + 64) / stride) {
    broken(place + " claims " + std::to_string(count) + " compressed elements of " + std::to_string(stride) + " bytes in " +
           std::to_string(bytes.size()));
  }
  const auto n = static_cast<std::size_t>(count);
  const auto s = static_cast<std::size_t>(stride);
  unpacked_bytes_ += n * s;
  if (unpacked_bytes_ > kBestRatio * (buffer_bytes_ + kSlack))
    broken(place + " and others unpack to " + std::to_string(unpacked_bytes_) + " bytes out of " + std::to_string(buffer_bytes_) +
           ": some are named again and again");
  std::vector<std::uint8_t> result(n * s);
  const std::string mode = text(packed, "mode");
  int failed = -1;
  if (mode == "ATTRIBUTES" && s % 4 == 0) failed = meshopt_decodeVertexBuffer(result.data(), n, s, bytes.data(), bytes.size());
  if (mode == "TRIANGLES" && n % 3 == 0 && (s == 2 || s == 4)) {
    failed = meshopt_decodeIndexBuffer(result.data(), n, s, bytes.data(), bytes.size());
  }
  if (mode == "INDICES" && (s == 2 || s == 4)) failed = meshopt_decodeIndexSequence(result.data(), n, s, bytes.data(), bytes.size());
  if (failed != 0) broken(place + " does not decompress in mode '" + mode + "'");
  const std::string filter = text(packed, "filter", "NONE");
  if (filter == "OCTAHEDRAL" && (s == 4 || s == 8)) {
    meshopt_decodeFilterOct(result.data(), n, s);
  } else if (filter == "QUATERNION" && s == 8) {
    meshopt_decodeFilterQuat(result.data(), n, s);
  } else if (filter == "EXPONENTIAL" && s % 4 == 0) {
    meshopt_decodeFilterExp(result.data(), n, s);
  } else if (filter != "NONE") {
    broken(place + " has the filter '" + filter + "' on elements of " + std::to_string(s) + " bytes");
  }
  return result;
}

}  // namespace standin
