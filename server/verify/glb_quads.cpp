#include "server/verify/glb_quads.h"

#include <set>

#include "render/base/error.h"
#include "render/image/image_io.h"
#include "render/scene/gltf_file.h"

namespace standin {
namespace {

constexpr int kDeepestNode = 64;  // nodes form trees; the limit only stops a file that says otherwise
constexpr std::uint64_t kTriangles = 4;

[[noreturn]] void fail(const std::string& what) {
  throw Failure(ErrorWord::kFileBroken, "impostor GLB: " + what);
}

std::vector<std::uint64_t> index_list(const Json& json, const char* key, const std::string& place) {
  std::vector<std::uint64_t> indices;
  const Json* list = member(json, key);
  if (list == nullptr) return indices;
  for (const Json& value : *list) {
    if (!value.is_number_unsigned()) fail(place + "." + key + " holds something else than indices");
    indices.push_back(value.get<std::uint64_t>());
  }
  return indices;
}

const Json& object_at(const Json& json, const char* key, const std::string& place) {
  const Json* found = member(json, key);
  if (found == nullptr || !found->is_object()) fail(place + " has no " + key);
  return *found;
}

/// Embedded, either way that glTF allows; a page that lies elsewhere would not ship.
Texture image_of(GltfFile& file, std::uint64_t image, const std::string& place) {
  const Json& json = file.item("images", image, place);
  const std::string name = "impostor GLB, images[" + std::to_string(image) + "]";
  const std::string uri = text(json, "uri");
  if (is_data_uri(uri)) return decode_image(decode_data_uri(uri, name), name);
  return decode_image(file.view(required_number(json, "bufferView", name)), name);
}

GlbPage page_of(GltfFile& file, std::uint64_t material) {
  const std::string place = "materials[" + std::to_string(material) + "]";
  const Json& json = file.item("materials", material, place);
  if (text(json, "alphaMode") != "MASK") fail(place + " has alphaMode \"" + text(json, "alphaMode") + "\", not MASK");
  const Json& surface = object_at(json, "pbrMetallicRoughness", place);
  const auto texture = required_number(object_at(surface, "baseColorTexture", place), "index", place);
  const auto image = required_number(file.item("textures", texture, place), "source", place);
  Texture decoded = image_of(file, image, place);
  return {decoded.width, decoded.height, std::move(decoded.rgba), real_number(json, "alphaCutoff", 0.5, place)};
}

void add_primitive(GltfFile& file, const Json& primitive, const GlbQuads& quads, const std::string& place, GlbImpostor& impostor) {
  const Json& attributes = object_at(primitive, "attributes", place);
  const auto positions = file.vectors<glm::vec3>(required_number(attributes, "POSITION", place));
  const auto uvs = file.vectors<glm::vec2>(required_number(attributes, "TEXCOORD_0", place));
  const auto indices = file.indices(required_number(primitive, "indices", place));
  const auto material = required_number(primitive, "material", place);
  if (material >= quads.pages.size()) fail(place + " names material " + std::to_string(material) + ", which does not exist");
  if (whole_number(primitive, "mode", place).value_or(kTriangles) != kTriangles || indices.size() % 3 != 0)
    fail(place + " is not a list of triangles");
  const Vec2 size(quads.pages[material].width, quads.pages[material].height);
  for (std::size_t first = 0; first < indices.size(); first += 3) {
    GlbTriangle triangle;
    triangle.page = static_cast<std::uint32_t>(material);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = indices[first + k];
      if (vertex >= positions.size() || vertex >= uvs.size()) fail(place + ": index " + std::to_string(vertex) + " names no vertex");
      triangle.offsets[k] = Vec3(positions[vertex]);
      triangle.texels[k] = Vec2(uvs[vertex]) * size;
    }
    impostor.triangles.push_back(triangle);
  }
}

Vec3 translation_of(const Json& node, const std::string& place) {
  for (const char* other : {"matrix", "rotation", "scale"})
    if (member(node, other) != nullptr) fail(place + " has a " + other + "; impostors are only moved");
  const auto t = real_numbers(node, "translation", 3, place).value_or(std::vector<double>{0.0, 0.0, 0.0});
  return {t[0], t[1], t[2]};
}

void add_meshes(GltfFile& file, const Json& node, const std::string& place, const GlbQuads& quads, GlbImpostor& impostor) {
  const auto mesh = whole_number(node, "mesh", place);
  if (!mesh) return;
  const std::string mesh_place = "meshes[" + std::to_string(*mesh) + "]";
  const Json* primitives = member(file.item("meshes", *mesh, place), "primitives");
  if (primitives == nullptr || !primitives->is_array()) fail(mesh_place + " has no primitives");
  for (const Json& primitive : *primitives) add_primitive(file, primitive, quads, mesh_place, impostor);
}

// `seen`: a node has one place; whoever visits all ways to it never comes to an end.
void add_nodes(GltfFile& file, std::uint64_t index, const Vec3& parent_origin, int depth, std::set<std::uint64_t>& seen, GlbQuads& quads) {
  if (depth > kDeepestNode) fail("nodes are nested without end");
  const std::string place = "nodes[" + std::to_string(index) + "]";
  const Json& node = file.item("nodes", index, place);
  if (!seen.insert(index).second) fail(place + " occurs twice in the node tree");
  const Vec3 origin = parent_origin + translation_of(node, place);
  if (text(node, "name").starts_with("imp_")) {
    GlbImpostor impostor{text(node, "name"), origin, {}};
    add_meshes(file, node, place, quads, impostor);
    quads.impostors.push_back(std::move(impostor));
  }
  for (const auto child : index_list(node, "children", place)) add_nodes(file, child, origin, depth + 1, seen, quads);
}

}  // namespace

const GlbImpostor& GlbQuads::impostor(std::string_view node) const {
  for (const auto& candidate : impostors)
    if (candidate.node == node) return candidate;
  fail("no node is named \"" + std::string(node) + "\"");
}

GlbQuads read_glb_quads(const std::string& bytes) {
  GltfFile file({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, SceneFolder("impostors.glb"));
  GlbQuads quads;
  for (std::uint64_t material = 0; material < file.count("materials"); ++material) quads.pages.push_back(page_of(file, material));
  std::set<std::uint64_t> seen;
  for (std::uint64_t scene = 0; scene < file.count("scenes"); ++scene) {
    const std::string place = "scenes[" + std::to_string(scene) + "]";
    for (const auto root : index_list(file.item("scenes", scene, place), "nodes", place)) add_nodes(file, root, Vec3(0.0), 0, seen, quads);
  }
  return quads;
}

}  // namespace standin
