// The GLB writer: every impostor a node at its reference viewpoint, with one primitive per atlas page that it uses.
//
// The binary chunk holds all positions, then all texture coordinates, all indices and the pages as PNG, each in a buffer view of its own.
#include "render/impostor/impostor_glb.h"

#include <algorithm>
#include <map>

#include "render/image/image_io.h"
#include "render/impostor/atlas.h"
#include "render/scene/glb_container.h"

namespace standin {
namespace {

using Json = OrderedJson;

// Names of glTF 2.0.
constexpr int kNearest = 9728, kClampToEdge = 33071;
enum BufferView : int { kPositions, kUvs, kIndices, kFirstImage };

constexpr std::uint64_t kBytesPerVertex = 3 * sizeof(float) + 2 * sizeof(float);

/// One width for all of an impostor's primitives.
std::uint64_t bytes_per_index(std::uint64_t vertices) {
  return vertices <= gltf::kHighestShort + 1U ? 2 : 4;
}

template <class Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(Value));  // glTF is little-endian, as every target of ours is
}

/// The binary chunk's sections and the JSON arrays that refer to them, in the making.
struct Document {
  std::string positions, uvs, indices;
  Json accessors = Json::array(), meshes = Json::array(), nodes = Json::array();
};

int add_accessor(Document& document, BufferView view, std::size_t offset, int component, std::uint64_t count, const char* type) {
  document.accessors.push_back(
      {{"bufferView", view}, {"byteOffset", offset}, {"componentType", component}, {"count", count}, {"type", type}});
  return static_cast<int>(document.accessors.size()) - 1;
}

void append_vertices(const TexturedMesh& mesh, const Chart& chart, const AtlasSlot& slot, const Texture& page, Document& document,
                     Box& bounds) {
  for (std::uint32_t i = chart.first_vertex; i < chart.first_vertex + chart.vertex_count; ++i) {
    const ImpostorVertex& vertex = mesh.vertices[i];
    const glm::vec3 position(vertex.offset);
    bounds.extend(Vec3(position));
    for (int axis = 0; axis < 3; ++axis) append(document.positions, position[axis]);
    append(document.uvs, static_cast<float>(slot.x + vertex.texel.x) / static_cast<float>(page.width));
    append(document.uvs, static_cast<float>(slot.y + vertex.texel.y) / static_cast<float>(page.height));
  }
}

void append_indices(const TexturedMesh& mesh, const Chart& chart, std::uint64_t first_vertex, std::uint64_t index_bytes,
                    std::string& indices) {
  for (std::uint32_t i = chart.first_index; i < chart.first_index + chart.index_count; ++i) {
    const std::uint64_t index = first_vertex + mesh.indices[i];
    if (index_bytes == 2)
      append(indices, static_cast<std::uint16_t>(index));
    else
      append(indices, static_cast<std::uint32_t>(index));
  }
}

/// The charts of one impostor that lie on one page.
Json add_primitive(const TexturedMesh& mesh, const std::vector<AtlasSlot>& slots, const std::vector<std::uint32_t>& charts,
                   const Texture& page, Document& document) {
  const std::uint64_t index_bytes = bytes_per_index(mesh.vertices.size());
  const std::size_t first_position = document.positions.size(), first_uv = document.uvs.size(), first_index = document.indices.size();
  Box bounds;
  std::uint64_t vertices = 0, indices = 0;
  for (const std::uint32_t c : charts) {
    const Chart& chart = mesh.charts[c];
    append_vertices(mesh, chart, slots[c], page, document, bounds);
    append_indices(mesh, chart, vertices, index_bytes, document.indices);
    vertices += chart.vertex_count;
    indices += chart.index_count;
  }
  pad_binary(document.indices);
  const int positions = add_accessor(document, kPositions, first_position, gltf::kFloat, vertices, "VEC3");
  const int uvs = add_accessor(document, kUvs, first_uv, gltf::kFloat, vertices, "VEC2");
  const int triangles =
      add_accessor(document, kIndices, first_index, index_bytes == 2 ? gltf::kUnsignedShort : gltf::kUnsignedInt, indices, "SCALAR");
  document.accessors[static_cast<std::size_t>(positions)]["min"] = {bounds.min.x, bounds.min.y, bounds.min.z};
  document.accessors[static_cast<std::size_t>(positions)]["max"] = {bounds.max.x, bounds.max.y, bounds.max.z};
  return {{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}}, {"indices", triangles}, {"material", slots[charts.front()].page}};
}

void add_node(const ImpostorSet& set, std::size_t id, Document& document) {
  const Impostor& impostor = set.impostors[id];
  const Vec3& viewpoint = impostor.frame.reference_viewpoint;
  const std::string name = "imp_" + std::to_string(id);
  Json node = {{"name", name}, {"translation", {viewpoint.x, viewpoint.y, viewpoint.z}}};
  const TexturedMesh mesh = textured_mesh(impostor);
  std::map<std::uint32_t, std::vector<std::uint32_t>> charts_of_page;
  for (std::uint32_t chart = 0; chart < mesh.charts.size(); ++chart) charts_of_page[set.slots[id][chart].page].push_back(chart);
  if (!charts_of_page.empty()) {
    Json primitives = Json::array();
    for (const auto& [page, charts] : charts_of_page)
      primitives.push_back(add_primitive(mesh, set.slots[id], charts, set.pages[page], document));
    node["mesh"] = document.meshes.size();
    document.meshes.push_back({{"name", name}, {"primitives", std::move(primitives)}});
  }
  document.nodes.push_back(std::move(node));
}

Json material_of(std::size_t page) {
  return {{"name", "atlas_" + std::to_string(page)},
          {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", page}}}, {"metallicFactor", 0.0}, {"roughnessFactor", 1.0}}},
          {"alphaMode", "MASK"},
          {"alphaCutoff", 0.5},
          {"doubleSided", true},
          {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
}

/// The sections that depend on there being anything to show: glTF forbids empty arrays.
void add_contents(const ImpostorSet& set, Document& document, Json& root, std::string& binary) {
  Json views = Json::array();
  add_buffer_view(views, binary, document.positions, 3 * sizeof(float), gltf::kArrayBuffer);
  add_buffer_view(views, binary, document.uvs, 2 * sizeof(float), gltf::kArrayBuffer);
  add_buffer_view(views, binary, document.indices, 0, gltf::kElementArrayBuffer);
  for (std::size_t page = 0; page < set.pages.size(); ++page) {
    add_buffer_view(views, binary, encode_png(set.pages[page]), 0, 0);
    root["images"].push_back({{"name", set.pages[page].name}, {"mimeType", "image/png"}, {"bufferView", kFirstImage + page}});
    root["textures"].push_back({{"sampler", 0}, {"source", page}});
    root["materials"].push_back(material_of(page));
  }
  root["extensionsUsed"] = {"KHR_materials_unlit"};
  root["samplers"] = Json::array({{{"magFilter", kNearest}, {"minFilter", kNearest}, {"wrapS", kClampToEdge}, {"wrapT", kClampToEdge}}});
  root["meshes"] = std::move(document.meshes);
  root["accessors"] = std::move(document.accessors);
  root["bufferViews"] = std::move(views);
}

}  // namespace

std::string encode_impostor_glb(const ImpostorSet& set) {
  Document document;
  for (std::size_t id = 0; id < set.impostors.size(); ++id) add_node(set, id, document);
  Json root = {{"asset", {{"version", "2.0"}, {"generator", "Standin"}}}, {"scene", 0}};
  root["scenes"] = Json::array({Json::object()});
  for (std::size_t id = 0; id < set.impostors.size(); ++id) root["scenes"][0]["nodes"].push_back(id);
  if (!document.nodes.empty()) root["nodes"] = document.nodes;
  std::string binary;
  if (!document.positions.empty()) add_contents(set, document, root, binary);
  return GlbContainer(std::move(root), binary).joined();
}

std::uint64_t geometry_bytes(const Impostor& impostor) {
  const TexturedMesh mesh = textured_mesh(impostor);
  return mesh.vertices.size() * kBytesPerVertex + mesh.indices.size() * bytes_per_index(mesh.vertices.size());
}

}  // namespace standin
