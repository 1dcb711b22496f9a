// A glTF file as checked bytes: JSON, buffers, buffer views (decompressed where EXT_meshopt_compression says so) and accessors.
//
// Nothing here trusts the file: an index, a type or a byte range that does not fit ends in Failure(kFileBroken) with the place.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/scene/file_access.h"
#include "render/scene/scene.h"

namespace standin {

using Json = nlohmann::json;

/// Member of an object, or null where it is absent.
[[nodiscard]] const Json* member(const Json& object, const char* key);
/// Whole number >= 0, or nothing where it is absent. Throws Failure(kFileBroken) for anything else.
[[nodiscard]] std::optional<std::uint64_t> whole_number(const Json& object, const char* key, const std::string& place);
[[nodiscard]] std::uint64_t required_number(const Json& object, const char* key, const std::string& place);
[[nodiscard]] double real_number(const Json& object, const char* key, double otherwise, const std::string& place);
/// `count` finite numbers, or nothing where the member is absent.
[[nodiscard]] std::optional<std::vector<double>> real_numbers(const Json& object, const char* key, std::size_t count,
                                                              const std::string& place);
[[nodiscard]] std::string text(const Json& object, const char* key, const std::string& otherwise = "");
/// object.extensions[name], or null.
[[nodiscard]] const Json* extension(const Json& object, const char* name);

class GltfFile {
 public:
  /// `bytes` (GLB or JSON) must outlive this.
  GltfFile(std::span<const std::uint8_t> bytes, const SceneFolder& folder);

  [[nodiscard]] const Json& json() const { return json_; }
  [[nodiscard]] const SceneFolder& folder() const { return folder_; }
  /// Element of a top-level array such as "meshes".
  [[nodiscard]] const Json& item(const char* array, std::uint64_t index, const std::string& place) const;
  [[nodiscard]] std::size_t count(const char* array) const;

  [[nodiscard]] std::span<const std::uint8_t> view(std::uint64_t index);
  /// Elements of `components` numbers each, normalised integers scaled, sparse substitutions applied.
  template <typename Vector>
  [[nodiscard]] std::vector<Vector> vectors(std::uint64_t accessor) {
    const Elements from = elements(accessor, static_cast<std::size_t>(Vector::length()));
    std::vector<Vector> values(from.count);
    read_floats(accessor, from, {reinterpret_cast<float*>(values.data()), from.count * from.components});
    return values;
  }
  [[nodiscard]] std::vector<std::uint32_t> indices(std::uint64_t accessor);

 private:
  // Where the elements of an accessor (or of its sparse parts) lie; `bytes` empty: all zero.
  struct Elements {
    std::span<const std::uint8_t> bytes;
    std::size_t count = 0;
    std::size_t stride = 0;
    std::uint64_t component_type = 0;
    std::size_t components = 0;
    bool normalised = false;
    std::string place;
  };

  void parse_container(std::span<const std::uint8_t> bytes);
  void parse_json(std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::span<const std::uint8_t> buffer(std::uint64_t index);
  [[nodiscard]] std::span<const std::uint8_t> slice(const Json& view, const std::string& place);
  [[nodiscard]] std::vector<std::uint8_t> decompressed(const Json& extension, const std::string& place);
  [[nodiscard]] Elements elements(std::uint64_t accessor, std::size_t components);
  [[nodiscard]] Elements located(const Json& where, const Elements& shape, bool packed);
  void read_floats(std::uint64_t accessor, const Elements& from, std::span<float> values);
  void substitute_sparse(const Json& accessor, const Elements& shape, std::span<float> values);

  SceneFolder folder_;
  Json json_;
  std::span<const std::uint8_t> binary_chunk_;
  std::map<std::string, std::vector<std::uint8_t>> external_buffers_;  // by URI; data URIs by their place
  std::map<std::uint64_t, std::vector<std::uint8_t>> decompressed_views_;
  std::uint64_t buffer_bytes_ = 0;    // of all buffers opened
  std::uint64_t unpacked_bytes_ = 0;  // of decompressed views
  std::uint64_t zeros_ = 0;           // elements of accessors without bytes
};

}  // namespace standin
