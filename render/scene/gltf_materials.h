// glTF materials and their images, as far as the shading rule (shading.h) goes: base colour, alpha mask, unlit.
#pragma once

#include <map>
#include <optional>

#include "render/scene/gltf_file.h"
#include "render/scene/import.h"

namespace standin {

/// KHR_texture_transform: applied to the texture coordinates when a mesh is read. Identity by default.
struct UvTransform {
  glm::dvec2 offset{0.0};
  double rotation_rad = 0.0;
  glm::dvec2 scale{1.0};
  [[nodiscard]] bool identity() const { return offset == glm::dvec2(0.0) && rotation_rad == 0.0 && scale == glm::dvec2(1.0); }
  [[nodiscard]] glm::vec2 apply(const glm::vec2& uv) const;
};

struct GltfMaterial {
  std::uint32_t index = 0;  // in Scene::materials
  bool textured = false;
  std::uint64_t uv_set = 0;
  UvTransform uv_transform;
};

class GltfMaterials {
 public:
  GltfMaterials(GltfFile& file, Import& import) : file_(file), import_(import), scene_(import.scene) {}

  /// Reads each material once; without an index, glTF's default material.
  [[nodiscard]] const GltfMaterial& material(std::optional<std::uint64_t> index);

 private:
  GltfMaterial read(std::optional<std::uint64_t> index);
  void read_texture(const Json& info, const std::string& place, GltfMaterial& result, Material& material);
  void read_alpha(const Json& json, const std::string& place, Material& material);
  [[nodiscard]] std::int32_t texture_of_image(std::uint64_t image);
  [[nodiscard]] Texture load_image(std::uint64_t image);

  GltfFile& file_;
  Import& import_;
  Scene& scene_;
  std::map<std::int64_t, GltfMaterial> materials_;  // by glTF index, -1 for the default
  std::map<std::uint64_t, std::int32_t> images_;    // glTF image to Scene::textures, -1 where it cannot be read
};

/// glTF factors are linear; Scene colours are sRGB encoded. Both ways in double, so that writing and reading gives the same floats.
[[nodiscard]] double srgb_encoded(double linear);
[[nodiscard]] double srgb_decoded(double encoded);

}  // namespace standin
