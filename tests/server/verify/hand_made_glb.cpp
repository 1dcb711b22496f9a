#include "tests/server/verify/hand_made_glb.h"

#include <tiny_gltf.h>

#include <cstring>
#include <sstream>

namespace standin::test {
namespace {

// Appends values as one accessor in a view of its own.
template <class Value>
int add_accessor(tinygltf::Model& model, const std::vector<Value>& values, int component_type, int type) {
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = model.buffers[0].data.size();
  view.byteLength = values.size() * sizeof(Value);
  model.buffers[0].data.resize(view.byteOffset + view.byteLength);
  std::memcpy(model.buffers[0].data.data() + view.byteOffset, values.data(), view.byteLength);
  model.bufferViews.push_back(view);
  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model.bufferViews.size()) - 1;
  accessor.componentType = component_type;
  accessor.type = type;
  accessor.count = values.size() / static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size()) - 1;
}

tinygltf::Image image_of(const HandMadeQuad& quad) {
  tinygltf::Image image;
  image.name = "page";
  image.mimeType = "image/png";
  image.width = image.height = quad.texels;
  image.component = 4;
  image.bits = 8;
  image.pixel_type = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
  for (int row = 0; row < quad.texels; ++row)
    for (int column = 0; column < quad.texels; ++column)
      for (int channel = 0; channel < 4; ++channel) image.image.push_back(channel == 3 && !quad.opaque(column, row) ? 0 : 255);
  return image;
}

tinygltf::Primitive primitive_of(tinygltf::Model& model, const HandMadeQuad& quad, int material) {
  const auto r = static_cast<float>(quad.depth_m * quad.half_slope);
  const auto z = static_cast<float>(-quad.depth_m);
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = material;
  primitive.attributes["POSITION"] =
      add_accessor<float>(model, {-r, r, z, -r, -r, z, r, -r, z, r, r, z}, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3);
  primitive.attributes["TEXCOORD_0"] =
      add_accessor<float>(model, {0, 0, 0, 1, 1, 1, 1, 0}, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC2);
  primitive.indices = add_accessor<std::uint32_t>(model, {0, 1, 2, 0, 2, 3}, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR);
  return primitive;
}

void add_material(tinygltf::Model& model, const HandMadeQuad& quad, const std::string& alpha_mode) {
  tinygltf::Texture texture;
  texture.source = static_cast<int>(model.images.size());
  tinygltf::Material material;
  material.name = "atlas";
  material.alphaMode = alpha_mode;
  material.pbrMetallicRoughness.baseColorTexture.index = static_cast<int>(model.textures.size());
  model.images.push_back(image_of(quad));
  model.textures.push_back(texture);
  model.materials.push_back(material);
}

}  // namespace

std::string write_glb(const HandMadeGlb& glb) {
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.buffers.emplace_back();
  model.meshes.emplace_back();
  for (const auto& quad : glb.quads) {
    add_material(model, quad, glb.alpha_mode);
    model.meshes[0].primitives.push_back(primitive_of(model, quad, static_cast<int>(model.materials.size()) - 1));
  }
  tinygltf::Node node;
  node.name = glb.node;
  node.mesh = 0;
  node.translation = {glb.origin.x, glb.origin.y, glb.origin.z};
  model.nodes.push_back(node);
  model.scenes.emplace_back();
  model.scenes[0].nodes.push_back(0);
  model.defaultScene = 0;
  std::ostringstream stream;
  tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, true);
  return stream.str();
}

}  // namespace standin::test
