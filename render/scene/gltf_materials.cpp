#include "render/scene/gltf_materials.h"

#include <algorithm>
#include <cmath>

#include "render/base/error.h"
#include "render/image/image_io.h"

namespace standin {
namespace {

using Kind = LoadNote::Kind;
const Json kNothing = Json::object();
constexpr double kAllTransparent = 2.0;  // a cutoff above 1 leaves nothing

// Factors are in [0, 1] by the standard; others may not even be floats.
glm::vec4 encoded_colour(const std::optional<std::vector<double>>& factor) {
  if (!factor) return glm::vec4(1.0F);
  const glm::dvec4 f = glm::clamp(glm::dvec4((*factor)[0], (*factor)[1], (*factor)[2], (*factor)[3]), 0.0, 1.0);
  return glm::vec4(glm::dvec4(srgb_encoded(f.r), srgb_encoded(f.g), srgb_encoded(f.b), f.a));
}

UvTransform read_uv_transform(const Json& json, const std::string& place) {
  UvTransform transform;
  if (const auto offset = real_numbers(json, "offset", 2, place)) transform.offset = {(*offset)[0], (*offset)[1]};
  if (const auto scale = real_numbers(json, "scale", 2, place)) transform.scale = {(*scale)[0], (*scale)[1]};
  transform.rotation_rad = real_number(json, "rotation", 0.0, place);
  return transform;
}

}  // namespace

double srgb_encoded(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

double srgb_decoded(double encoded) {
  return encoded <= 12.92 * 0.0031308 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

// Counter-clockwise as seen on the image, whose v axis points down.
glm::vec2 UvTransform::apply(const glm::vec2& uv) const {
  const glm::dvec2 scaled = scale * glm::dvec2(uv);
  const double c = std::cos(rotation_rad);
  const double s = std::sin(rotation_rad);
  return glm::vec2(offset + glm::dvec2(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x));
}

const GltfMaterial& GltfMaterials::material(std::optional<std::uint64_t> index) {
  const std::int64_t key = index ? static_cast<std::int64_t>(*index) : -1;
  const auto found = materials_.find(key);
  if (found != materials_.end()) return found->second;
  return materials_.emplace(key, read(index)).first->second;
}

GltfMaterial GltfMaterials::read(std::optional<std::uint64_t> index) {
  const std::string place = index ? "materials[" + std::to_string(*index) + "]" : "the default material";
  const Json& json = index ? file_.item("materials", *index, place) : kNothing;
  GltfMaterial result;
  Material material;
  material.name = text(json, "name", index ? "material_" + std::to_string(*index) : "default");
  const Json* double_sided = member(json, "doubleSided");
  material.double_sided = double_sided != nullptr && double_sided->is_boolean() && double_sided->get<bool>();
  material.unlit = extension(json, "KHR_materials_unlit") != nullptr;
  const Json* specular = extension(json, "KHR_materials_pbrSpecularGlossiness");
  const Json* metallic = member(json, "pbrMetallicRoughness");
  const Json& surface = specular != nullptr ? *specular : (metallic != nullptr ? *metallic : kNothing);
  material.base_colour = encoded_colour(real_numbers(surface, specular != nullptr ? "diffuseFactor" : "baseColorFactor", 4, place));
  const Json* info = member(surface, specular != nullptr ? "diffuseTexture" : "baseColorTexture");
  if (info != nullptr) read_texture(*info, place, result, material);
  read_alpha(json, place, material);
  result.index = static_cast<std::uint32_t>(scene_.materials.size());
  scene_.materials.push_back(material);
  return result;
}

void GltfMaterials::read_texture(const Json& info, const std::string& place, GltfMaterial& result, Material& material) {
  const std::uint64_t index = required_number(info, "index", place);
  const Json& texture = file_.item("textures", index, place);
  result.uv_set = whole_number(info, "texCoord", place).value_or(0);
  if (const Json* transform = extension(info, "KHR_texture_transform")) {
    result.uv_transform = read_uv_transform(*transform, place);
    result.uv_set = whole_number(*transform, "texCoord", place).value_or(result.uv_set);
  }
  const std::string texture_place = "textures[" + std::to_string(index) + "]";
  if (const auto sampler = whole_number(texture, "sampler", texture_place)) {
    constexpr std::uint64_t kRepeat = 10497;
    const Json& json = file_.item("samplers", *sampler, texture_place);
    const bool repeats = whole_number(json, "wrapS", texture_place).value_or(kRepeat) == kRepeat &&
                         whole_number(json, "wrapT", texture_place).value_or(kRepeat) == kRepeat;
    add_note(scene_, Kind::kChosen, "textures", repeats ? 0 : 1, "clamped or mirrored ones are drawn repeating");
  }
  const Json* webp = extension(texture, "EXT_texture_webp");
  const auto image = whole_number(webp != nullptr ? *webp : texture, "source", texture_place);
  if (image) material.texture = texture_of_image(*image);
  if (!image) add_note(scene_, Kind::kWarning, "textures", 1, "no image in a form that is read");
  result.textured = material.texture >= 0;
}

void GltfMaterials::read_alpha(const Json& json, const std::string& place, Material& material) {
  const std::string mode = text(json, "alphaMode", "OPAQUE");
  if (mode == "OPAQUE") return;
  material.alpha_mode = AlphaMode::kMask;
  if (mode == "MASK")
    material.alpha_cutoff = static_cast<float>(std::clamp(real_number(json, "alphaCutoff", 0.5, place), 0.0, kAllTransparent));
  add_note(scene_, Kind::kChosen, "materials", mode == "MASK" ? 0 : 1, "blended ones are drawn as a mask at alpha 0.5");
}

std::int32_t GltfMaterials::texture_of_image(std::uint64_t image) {
  const auto [place, fresh] = images_.try_emplace(image, -1);
  if (!fresh) return place->second;
  try {
    place->second = add_texture(import_, load_image(image));
  } catch (const Failure& failure) {
    if (failure.word() != ErrorWord::kFileMissing && failure.word() != ErrorWord::kFileBroken) throw;
    add_note(scene_, Kind::kWarning, "textures", 1, std::string("left out: ") + failure.what());
  }
  return place->second;
}

Texture GltfMaterials::load_image(std::uint64_t image) {
  const std::string place = "images[" + std::to_string(image) + "]";
  const Json& json = file_.item("images", image, place);
  const std::string uri = text(json, "uri");
  Texture texture;
  if (uri.empty()) {
    texture = decode_image(file_.view(required_number(json, "bufferView", place)), place);
  } else if (is_data_uri(uri)) {
    texture = decode_image(decode_data_uri(uri, place), place);
  } else {
    texture = read_image(file_.folder().resolve_uri(uri));
  }
  texture.name = text(json, "name", uri.empty() || is_data_uri(uri) ? place : uri);
  return texture;
}

}  // namespace standin
