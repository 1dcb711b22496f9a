// Accessors: typed numbers out of checked bytes.

#include <array>
#include <cstring>

#include "render/base/error.h"
#include "render/scene/gltf_file.h"

namespace standin {
namespace {

constexpr std::uint64_t kByte = 5120;
constexpr std::uint64_t kUnsignedByte = 5121;
constexpr std::uint64_t kShort = 5122;
constexpr std::uint64_t kUnsignedShort = 5123;
constexpr std::uint64_t kUnsignedInt = 5125;
constexpr std::uint64_t kFloat = 5126;

// Accessors without bytes cost the file nothing and us their elements: so many in a file.
constexpr std::uint64_t kMaxZeros = std::uint64_t{1} << 24;

std::size_t size_of_component(std::uint64_t type, const std::string& place) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      throw Failure(ErrorWord::kFileBroken, place + ".componentType is " + std::to_string(type));
  }
}

std::size_t components_of(const std::string& type, const std::string& place) {
  static constexpr std::array<std::pair<std::string_view, std::size_t>, 4> kTypes{{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}}};
  for (const auto& [name, count] : kTypes) {
    if (type == name) return count;
  }
  throw Failure(ErrorWord::kFileBroken, place + ".type is '" + type + "', which no attribute read here has");
}

template <typename T>
T read_as(const std::uint8_t* bytes) {
  T value{};
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

// Normalised integers as glTF 2.0, 3.11 says.
float component(const std::uint8_t* bytes, std::uint64_t type, bool normalised) {
  const auto scaled = [&](float value, float most) { return normalised ? std::max(value / most, -1.0F) : value; };
  switch (type) {
    case kByte:
      return scaled(read_as<std::int8_t>(bytes), 127.0F);
    case kUnsignedByte:
      return scaled(read_as<std::uint8_t>(bytes), 255.0F);
    case kShort:
      return scaled(read_as<std::int16_t>(bytes), 32767.0F);
    case kUnsignedShort:
      return scaled(read_as<std::uint16_t>(bytes), 65535.0F);
    case kUnsignedInt:
      return static_cast<float>(read_as<std::uint32_t>(bytes));
    default:
      return read_as<float>(bytes);
  }
}

std::uint32_t index_at(const std::uint8_t* bytes, std::uint64_t type) {
  if (type == kUnsignedByte) return read_as<std::uint8_t>(bytes);
  if (type == kUnsignedShort) return read_as<std::uint16_t>(bytes);
  return read_as<std::uint32_t>(bytes);
}

void check_index_type(std::uint64_t type, const std::string& place) {
  if (type == kUnsignedByte || type == kUnsignedShort || type == kUnsignedInt) return;
  throw Failure(ErrorWord::kFileBroken, place + " holds indices of componentType " + std::to_string(type));
}

}  // namespace

// Fills in the bytes of `shape` (whose count and types are known) from a bufferView and byteOffset, once it is sure they are there.
GltfFile::Elements GltfFile::located(const Json& where, const Elements& shape, bool packed) {
  Elements result = shape;
  const std::size_t size = size_of_component(shape.component_type, shape.place) * shape.components;
  const std::uint64_t index = required_number(where, "bufferView", shape.place);
  const auto bytes = view(index);
  const std::uint64_t offset = whole_number(where, "byteOffset", shape.place).value_or(0);
  const Json& view_json = item("bufferViews", index, shape.place);
  const std::uint64_t stride = packed ? size : whole_number(view_json, "byteStride", shape.place).value_or(size);
  const bool fits = stride >= size && stride <= 256 && offset <= bytes.size() && size <= bytes.size() - offset &&
                    shape.count - 1 <= (bytes.size() - offset - size) / stride;
  if (shape.count > 0 && !fits) {
    throw Failure(ErrorWord::kFileBroken, shape.place + ": " + std::to_string(shape.count) + " elements of " + std::to_string(size) +
                                              " bytes, stride " + std::to_string(stride) + ", offset " + std::to_string(offset) +
                                              " do not fit into bufferViews[" + std::to_string(index) + "] of " +
                                              std::to_string(bytes.size()) + " bytes");
  }
  result.stride = static_cast<std::size_t>(stride);
  result.bytes = shape.count > 0 ? bytes.subspan(static_cast<std::size_t>(offset)) : bytes.first(0);
  return result;
}

GltfFile::Elements GltfFile::elements(std::uint64_t accessor, std::size_t components) {
  Elements shape;
  shape.place = "accessors[" + std::to_string(accessor) + "]";
  const Json& json = item("accessors", accessor, shape.place);
  shape.count = static_cast<std::size_t>(required_number(json, "count", shape.place));
  shape.component_type = required_number(json, "componentType", shape.place);
  shape.components = components_of(text(json, "type"), shape.place);
  const Json* normalised = member(json, "normalized");
  shape.normalised = normalised != nullptr && normalised->is_boolean() && normalised->get<bool>();
  (void)size_of_component(shape.component_type, shape.place);
  if (shape.components != components) {
    throw Failure(ErrorWord::kFileBroken, shape.place + " has " + std::to_string(shape.components) + " components where " +
                                              std::to_string(components) + " are needed");
  }
  if (member(json, "bufferView") != nullptr) return located(json, shape, false);
  zeros_ += std::min<std::uint64_t>(shape.count, kMaxZeros + 1);
  if (zeros_ > kMaxZeros) {
    throw Failure(ErrorWord::kFileBroken, shape.place + " has " + std::to_string(shape.count) + " elements and no bytes; a file may have " +
                                              std::to_string(kMaxZeros) + " such elements");
  }
  return shape;
}

// `values` come as zeros.
void GltfFile::read_floats(std::uint64_t accessor, const Elements& from, std::span<float> values) {
  const std::size_t size = size_of_component(from.component_type, from.place);
  if (from.component_type == kFloat && from.stride == size * from.components && !from.bytes.empty()) {
    std::memcpy(values.data(), from.bytes.data(), values.size_bytes());
  } else if (!from.bytes.empty()) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t offset = i / from.components * from.stride + i % from.components * size;
      values[i] = component(from.bytes.data() + offset, from.component_type, from.normalised);
    }
  }
  substitute_sparse(item("accessors", accessor, from.place), from, values);
}

void GltfFile::substitute_sparse(const Json& accessor, const Elements& shape, std::span<float> values) {
  const Json* sparse = member(accessor, "sparse");
  if (sparse == nullptr) return;
  const std::string place = shape.place + ".sparse";
  const Json* indices_json = member(*sparse, "indices");
  const Json* values_json = member(*sparse, "values");
  if (indices_json == nullptr || values_json == nullptr) throw Failure(ErrorWord::kFileBroken, place + " lacks indices or values");
  Elements which;
  which.place = place;
  which.count = static_cast<std::size_t>(required_number(*sparse, "count", place));
  which.component_type = required_number(*indices_json, "componentType", place);
  which.components = 1;
  check_index_type(which.component_type, place);
  which = located(*indices_json, which, true);
  Elements what = shape;
  what.count = which.count;
  what = located(*values_json, what, true);
  const std::size_t size = size_of_component(what.component_type, place);
  for (std::size_t i = 0; i < which.count; ++i) {
    const std::size_t target = index_at(which.bytes.data() + i * which.stride, which.component_type);
    if (target >= shape.count) throw Failure(ErrorWord::kFileBroken, place + " replaces element " + std::to_string(target));
    for (std::size_t c = 0; c < shape.components; ++c) {
      const std::uint8_t* bytes = what.bytes.data() + i * what.stride + c * size;
      values[target * shape.components + c] = component(bytes, what.component_type, what.normalised);
    }
  }
}

std::vector<std::uint32_t> GltfFile::indices(std::uint64_t accessor) {
  const Elements from = elements(accessor, 1);
  check_index_type(from.component_type, from.place);
  std::vector<std::uint32_t> values(from.count, 0);
  if (from.bytes.empty()) return values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = index_at(from.bytes.data() + i * from.stride, from.component_type);
  return values;
}

}  // namespace standin
