#include "server/verify/glb_quads.h"

#include <tiny_gltf.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <limits>

#include "render/base/error.h"

namespace standin {
namespace {

[[noreturn]] void fail(const std::string& what) {
  throw Failure(ErrorWord::kFileBroken, "impostor GLB: " + what);
}

template <class Container>
const auto& at(const Container& items, int index, const char* what) {
  if (index < 0 || static_cast<std::size_t>(index) >= items.size())
    fail(std::string(what) + " " + std::to_string(index) + " does not exist");
  return items[static_cast<std::size_t>(index)];
}

// Typed elements of an accessor, checked against the buffer once.
class Elements {
 public:
  Elements(const tinygltf::Model& model, int index, int type) : accessor_(at(model.accessors, index, "accessor")) {
    const auto& view = at(model.bufferViews, accessor_.bufferView, "buffer view");
    const auto& bytes = at(model.buffers, view.buffer, "buffer").data;
    const int stride = accessor_.ByteStride(view);
    component_bytes_ =
        static_cast<std::size_t>(std::max(0, tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor_.componentType))));
    const auto size = component_bytes_ * static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
    if (accessor_.type != type || stride <= 0 || accessor_.count == 0)
      fail("accessor " + std::to_string(index) + " is not of the type it is used as");
    stride_ = static_cast<std::size_t>(stride);
    const std::size_t begin = view.byteOffset + accessor_.byteOffset;
    if (begin + stride_ * (accessor_.count - 1) + size > bytes.size()) fail("accessor " + std::to_string(index) + " leaves its buffer");
    first_ = bytes.data() + begin;
  }
  [[nodiscard]] std::size_t count() const { return accessor_.count; }
  [[nodiscard]] double real(std::size_t element, std::size_t component) const {
    if (accessor_.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) fail("vertex data must be float");
    float value = 0.0F;
    std::memcpy(&value, first_ + element * stride_ + component * component_bytes_, sizeof(value));
    return value;
  }
  [[nodiscard]] std::size_t index(std::size_t element) const {
    std::uint32_t value = 0;  // glTF is little-endian, as are the machines this runs on
    std::memcpy(&value, first_ + element * stride_, std::min(component_bytes_, sizeof(value)));
    return value;
  }

 private:
  const tinygltf::Accessor& accessor_;
  const unsigned char* first_ = nullptr;
  std::size_t stride_ = 0;
  std::size_t component_bytes_ = 0;
};

GlbPage page_of(const tinygltf::Model& model, const tinygltf::Material& material) {
  if (material.alphaMode != "MASK") fail("material \"" + material.name + "\" has alphaMode " + material.alphaMode + ", not MASK");
  const auto& texture = at(model.textures, material.pbrMetallicRoughness.baseColorTexture.index, "texture");
  const auto& image = at(model.images, texture.source, "image");
  if (image.component != 4 || image.bits != 8 || image.width <= 0 || image.height <= 0) fail("image \"" + image.name + "\" is not RGBA8");
  GlbPage page{image.width, image.height, {}, image.image};
  for (std::size_t i = 3; i < image.image.size(); i += 4) page.opaque.push_back(image.image[i] / 255.0 >= material.alphaCutoff);
  if (page.opaque.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    fail("image \"" + image.name + "\" is incomplete");
  return page;
}

Mat4 local_transform(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
  Mat4 result(1.0);
  if (node.translation.size() == 3) result = glm::translate(result, glm::make_vec3(node.translation.data()));
  if (node.rotation.size() == 4)
    result *= glm::mat4_cast(glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]));
  if (node.scale.size() == 3) result = glm::scale(result, glm::make_vec3(node.scale.data()));
  return result;
}

int attribute(const tinygltf::Primitive& primitive, const char* name) {
  const auto found = primitive.attributes.find(name);
  if (found == primitive.attributes.end()) fail(std::string("a primitive has no ") + name);
  return found->second;
}

void add_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive, const Mat3& world_from_node, const GlbQuads& quads,
                   GlbImpostor& impostor) {
  const Elements positions(model, attribute(primitive, "POSITION"), TINYGLTF_TYPE_VEC3);
  const Elements uvs(model, attribute(primitive, "TEXCOORD_0"), TINYGLTF_TYPE_VEC2);
  const Elements indices(model, primitive.indices, TINYGLTF_TYPE_SCALAR);
  const GlbPage& page = at(quads.pages, primitive.material, "material");
  if ((primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != -1) || indices.count() % 3 != 0)
    fail("a primitive is not a list of triangles");
  for (std::size_t first = 0; first < indices.count(); first += 3) {
    GlbTriangle triangle;
    triangle.page = static_cast<std::uint32_t>(primitive.material);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t vertex = indices.index(first + k);
      if (vertex >= positions.count() || vertex >= uvs.count()) fail("index " + std::to_string(vertex) + " names no vertex");
      triangle.offsets[k] = world_from_node * Vec3(positions.real(vertex, 0), positions.real(vertex, 1), positions.real(vertex, 2));
      triangle.texels[k] = Vec2(uvs.real(vertex, 0) * page.width, uvs.real(vertex, 1) * page.height);
    }
    impostor.triangles.push_back(triangle);
  }
}

// glTF nodes form trees; the depth limit only stops a file that says otherwise.
void add_nodes(const tinygltf::Model& model, int index, const Mat4& world_from_parent, int depth, GlbQuads& quads) {
  if (depth > 64) fail("nodes are nested without end");
  const auto& node = at(model.nodes, index, "node");
  const Mat4 world_from_node = world_from_parent * local_transform(node);
  if (node.name.starts_with("imp_")) {
    GlbImpostor impostor{node.name, Vec3(world_from_node[3]), {}};
    if (node.mesh >= 0)
      for (const auto& primitive : at(model.meshes, node.mesh, "mesh").primitives)
        add_primitive(model, primitive, Mat3(world_from_node), quads, impostor);
    quads.impostors.push_back(std::move(impostor));
  }
  for (const int child : node.children) add_nodes(model, child, world_from_node, depth + 1, quads);
}

}  // namespace

const GlbImpostor& GlbQuads::impostor(std::string_view node) const {
  for (const auto& candidate : impostors)
    if (candidate.node == node) return candidate;
  fail("no node is named \"" + std::string(node) + "\"");
}

GlbQuads read_glb_quads(const std::string& bytes) {
  if (bytes.size() > std::numeric_limits<unsigned int>::max()) fail(std::to_string(bytes.size()) + " bytes are more than a GLB can hold");
  tinygltf::Model model;
  std::string error;
  std::string warning;
  tinygltf::TinyGLTF reader;
  if (!reader.LoadBinaryFromMemory(&model, &error, &warning, reinterpret_cast<const unsigned char*>(bytes.data()),
                                   static_cast<unsigned int>(bytes.size())))
    fail(error.empty() ? "unreadable" : error);
  GlbQuads quads;
  for (const auto& material : model.materials) quads.pages.push_back(page_of(model, material));
  for (const auto& scene : model.scenes)
    for (const int root : scene.nodes) add_nodes(model, root, Mat4(1.0), 0, quads);
  return quads;
}

}  // namespace standin
