// A Scene as one binary glTF 2.0 file. Objects that show the same parts become nodes of one glTF mesh; meshes are stored once however many
// materials they wear.

#include <algorithm>
#include <map>

#include "render/base/staged_file.h"
#include "render/image/image_io.h"
#include "render/scene/glb_container.h"
#include "render/scene/gltf_materials.h"
#include "render/scene/load.h"

namespace standin {
namespace {

class GlbWriter {
 public:
  explicit GlbWriter(const Scene& scene) : scene_(scene) {}

  /// Valid as long as this is.
  GlbContainer encode() {
    for (const Texture& texture : scene_.textures) add_texture(texture);
    for (const Material& material : scene_.materials) add_material(material);
    for (const Mesh& mesh : scene_.meshes) add_accessors(mesh);
    for (const Object& object : scene_.objects) add_node(object);
    return {assembled(), binary_};
  }

 private:
  template <typename T>
  std::size_t add_accessor(const std::vector<T>& values, int component_type, const char* type, int target) {
    const std::size_t view = add_buffer_view(views_, binary_, bytes_of_values(values), 0, target);
    accessors_.push_back({{"bufferView", view}, {"componentType", component_type}, {"count", values.size()}, {"type", type}});
    return accessors_.size() - 1;
  }

  void add_texture(const Texture& texture) {
    const std::string png = encode_png(texture);
    const std::size_t view = add_buffer_view(views_, binary_, png, 0, 0);
    const std::size_t index = images_.size();
    images_.push_back({{"name", texture.name}, {"mimeType", "image/png"}, {"bufferView", view}});
    textures_.push_back({{"source", index}});
  }

  void add_material(const Material& material) {
    const auto linear = [&](int channel) { return srgb_decoded(static_cast<double>(material.base_colour[channel])); };
    OrderedJson surface{{"baseColorFactor", {linear(0), linear(1), linear(2), static_cast<double>(material.base_colour.a)}},
                        {"metallicFactor", 0.0},
                        {"roughnessFactor", 1.0}};
    if (material.texture >= 0) surface["baseColorTexture"] = {{"index", material.texture}};
    OrderedJson json{{"name", material.name}, {"pbrMetallicRoughness", std::move(surface)}, {"doubleSided", material.double_sided}};
    if (material.alpha_mode == AlphaMode::kMask) {
      json["alphaMode"] = "MASK";
      json["alphaCutoff"] = static_cast<double>(material.alpha_cutoff);
    }
    if (material.unlit) {
      json["extensions"] = {{"KHR_materials_unlit", OrderedJson::object()}};
    }
    materials_.push_back(std::move(json));
  }

  // The primitive of each mesh, but for its material.
  void add_accessors(const Mesh& mesh) {
    OrderedJson attributes{{"POSITION", add_accessor(mesh.positions, gltf::kFloat, "VEC3", gltf::kArrayBuffer)}};
    OrderedJson& accessor = accessors_.back();
    const auto corner = [](const Vec3& v) { return OrderedJson{v.x, v.y, v.z}; };
    Box bounds;
    for (const glm::vec3& position : mesh.positions) bounds.extend(Vec3(position));
    accessor["min"] = corner(bounds.min);
    accessor["max"] = corner(bounds.max);
    attributes["NORMAL"] = add_accessor(mesh.normals, gltf::kFloat, "VEC3", gltf::kArrayBuffer);
    if (!mesh.uvs.empty()) attributes["TEXCOORD_0"] = add_accessor(mesh.uvs, gltf::kFloat, "VEC2", gltf::kArrayBuffer);
    primitives_.push_back({{"attributes", std::move(attributes)}, {"indices", add_indices(mesh)}});
  }

  std::size_t add_indices(const Mesh& mesh) {
    if (mesh.positions.size() > gltf::kHighestShort + 1U)
      return add_accessor(mesh.indices, gltf::kUnsignedInt, "SCALAR", gltf::kElementArrayBuffer);
    const std::vector<std::uint16_t> narrow(mesh.indices.begin(), mesh.indices.end());
    return add_accessor(narrow, gltf::kUnsignedShort, "SCALAR", gltf::kElementArrayBuffer);
  }

  std::size_t mesh_of(const Object& object) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> key;
    for (std::uint32_t p = 0; p < object.part_count; ++p) {
      const Part& part = scene_.parts[object.first_part + p];
      key.emplace_back(part.mesh, part.material);
    }
    const auto [place, fresh] = mesh_indices_.try_emplace(key, meshes_.size());
    if (!fresh) return place->second;
    OrderedJson primitives = OrderedJson::array();
    for (const auto& [mesh, material] : key) {
      primitives.push_back(primitives_[mesh]);
      primitives.back()["material"] = material;
    }
    const std::string name = key.empty() ? "" : scene_.meshes[key.front().first].name;
    meshes_.push_back({{"name", name}, {"primitives", std::move(primitives)}});
    return place->second;
  }

  void add_node(const Object& object) {
    OrderedJson matrix = OrderedJson::array();
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) matrix.push_back(object.world_from_object[column][row]);
    }
    nodes_.push_back({{"name", object.name}, {"mesh", mesh_of(object)}, {"matrix", std::move(matrix)}});
  }

  [[nodiscard]] OrderedJson assembled() const {
    OrderedJson roots = OrderedJson::array();
    for (std::size_t i = 0; i < nodes_.size(); ++i) roots.push_back(i);
    OrderedJson json;
    json["asset"] = {{"version", "2.0"}, {"generator", "standin"}};
    const bool unlit = std::any_of(scene_.materials.begin(), scene_.materials.end(), [](const Material& m) { return m.unlit; });
    if (unlit) json["extensionsUsed"] = {"KHR_materials_unlit"};
    json["scene"] = 0;
    json["scenes"] = OrderedJson::array({{{"nodes", roots}}});
    add_unless_empty(json, "nodes", nodes_);
    add_unless_empty(json, "meshes", meshes_);
    add_unless_empty(json, "materials", materials_);
    add_unless_empty(json, "textures", textures_);
    add_unless_empty(json, "images", images_);
    add_unless_empty(json, "accessors", accessors_);
    add_unless_empty(json, "bufferViews", views_);
    return json;
  }

  const Scene& scene_;
  OrderedJson nodes_ = OrderedJson::array();
  OrderedJson meshes_ = OrderedJson::array();
  OrderedJson materials_ = OrderedJson::array();
  OrderedJson textures_ = OrderedJson::array();
  OrderedJson images_ = OrderedJson::array();
  OrderedJson accessors_ = OrderedJson::array();
  OrderedJson views_ = OrderedJson::array();
  std::string binary_;
  std::vector<OrderedJson> primitives_;                                                       // per Scene::meshes
  std::map<std::vector<std::pair<std::uint32_t, std::uint32_t>>, std::size_t> mesh_indices_;  // by (mesh, material) of each part
};

}  // namespace

std::string scene_glb(const Scene& scene) {
  return GlbWriter(scene).encode().joined();
}

void write_scene_glb(const Scene& scene, const std::filesystem::path& file) {
  GlbWriter writer(scene);
  write_file(file, writer.encode().pieces());
}

}  // namespace standin
