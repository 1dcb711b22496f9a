#include "tests/fuzz/scene_seeds.h"

#include <meshoptimizer.h>

#include "render/image/image_io.h"
#include "render/scene/load.h"
#include "tests/render/scene/glb_maker.h"
#include "tests/support/scene_builder.h"

namespace standin::fuzz {
namespace {

using test::GlbMaker;
using Json = nlohmann::json;

std::string small_png() {
  return encode_png(test::make_texture(2, 2, [](int x, int y) {
    return std::array<std::uint8_t, 4>{255, 0, 0, std::uint8_t(x == y ? 255 : 0)};
  }));
}

GlbMaker textured() {
  GlbMaker maker = test::square_glb();
  const std::string png = small_png();
  maker.primitive()["attributes"]["NORMAL"] = maker.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  maker.primitive()["attributes"]["TEXCOORD_0"] = maker.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2");
  maker.primitive()["material"] = 0;
  maker.json["images"] = {{{"bufferView", maker.view(png.data(), png.size())}, {"mimeType", "image/png"}}};
  maker.json["samplers"] = {{{"wrapS", 10497}}};
  maker.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  const Json transform = {{"KHR_texture_transform", {{"offset", {0.1, 0.2}}, {"rotation", 0.3}, {"scale", {2, 2}}, {"texCoord", 0}}}};
  maker.json["materials"] = {
      {{"alphaMode", "MASK"},
       {"alphaCutoff", 0.4},
       {"doubleSided", true},
       {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.5, 0.5, 1}}, {"baseColorTexture", {{"index", 0}, {"extensions", transform}}}}},
       {"extensions", {{"KHR_materials_unlit", Json::object()}}}}};
  return maker;
}

GlbMaker instanced() {
  GlbMaker maker = test::square_glb();
  const Json attributes = {{"TRANSLATION", maker.floats({0, 0, 0, 5, 0, 0, 9, 0, 0}, "VEC3")},
                           {"ROTATION", maker.floats({0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC4")},
                           {"SCALE", maker.floats({1, 1, 1, 2, 2, 2, 3, 3, 3}, "VEC3")}};
  maker.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
  maker.json["nodes"].push_back({{"children", {0}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 3, 4, 1}}});
  maker.json["nodes"].push_back({{"children", {1}}, {"translation", {1, 2, 3}}, {"rotation", {0, 0, 0, 1}}, {"scale", {1, 2, 1}}});
  maker.json["scenes"][0]["nodes"] = {2};
  return maker;
}

GlbMaker of_levels() {
  GlbMaker maker = test::square_glb();
  maker.json["meshes"].push_back({{"primitives", {maker.primitive()}}});
  maker.json["nodes"].push_back({{"mesh", 1}});
  maker.json["nodes"][0]["extensions"]["MSFT_lod"]["ids"] = {1};
  maker.json["nodes"][0]["extras"]["MSFT_screencoverage"] = {0.5, 0.01};
  maker.json["extensionsUsed"] = {"MSFT_lod"};
  return maker;
}

GlbMaker compressed() {
  const std::vector<float> positions{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::vector<std::uint32_t> corners{0, 1, 2, 0, 2, 3};
  std::vector<unsigned char> vertices(meshopt_encodeVertexBufferBound(4, 12));
  vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), positions.data(), 4, 12));
  std::vector<unsigned char> indices(meshopt_encodeIndexBufferBound(6, 4));
  indices.resize(meshopt_encodeIndexBuffer(indices.data(), indices.size(), corners.data(), 6));
  GlbMaker maker = test::square_glb();
  const auto pack = [&](std::size_t view, const std::vector<unsigned char>& bytes, std::size_t count, std::size_t stride,
                        const char* mode) {
    Json extension = maker.json["bufferViews"][maker.view(bytes.data(), bytes.size())];
    extension.update({{"count", count}, {"byteStride", stride}, {"mode", mode}, {"filter", "NONE"}});
    maker.json["bufferViews"][view] = {
        {"buffer", 0}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", extension}}}};
  };
  pack(0, vertices, 4, 12, "ATTRIBUTES");
  pack(1, indices, 6, 4, "TRIANGLES");
  return maker;
}

GlbMaker sparse() {
  GlbMaker maker = test::square_glb();
  const std::size_t which = maker.accessor<std::uint16_t>({1, 2}, 5123, "SCALAR");
  const std::size_t what = maker.floats({2, 0, 0, 2, 2, 0}, "VEC3");
  maker.json["accessors"][0]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", maker.json["accessors"][which]["bufferView"]}, {"componentType", 5123}}},
      {"values", {{"bufferView", maker.json["accessors"][what]["bufferView"]}}}};
  maker.primitive()["mode"] = 5;
  return maker;
}

GlbMaker quantised() {
  GlbMaker maker;
  Json primitive{
      {"attributes", {{"POSITION", maker.accessor<std::int16_t>({0, 0, 0, 0, 9, 0, 0, 0, 9, 9, 0, 0, 0, 9, 0, 0}, 5122, "VEC4")}}}};
  maker.json["accessors"][0]["type"] = "VEC3";
  maker.json["accessors"][0]["count"] = 4;
  maker.json["accessors"][0]["normalized"] = true;
  maker.json["bufferViews"][0]["byteStride"] = 8;
  primitive["indices"] = maker.accessor<std::uint8_t>({0, 1, 2, 3}, 5121, "SCALAR");
  primitive["mode"] = 6;
  maker.json["meshes"] = {{{"primitives", {primitive, primitive}}}};
  maker.json["nodes"] = {{{"mesh", 0}}};
  maker.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  return maker;
}

// More triangles than the fuzzer lets an object have: it is split.
std::string split() {
  Scene scene;
  Mesh mesh;
  for (int i = 0; i < 15; ++i) {
    const Mesh strip = test::make_rectangle(i, 0, i + 1, 1, -0.1 * i);
    for (const std::uint32_t index : strip.indices) mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()) + index);
    mesh.positions.insert(mesh.positions.end(), strip.positions.begin(), strip.positions.end());
    mesh.normals.insert(mesh.normals.end(), strip.normals.begin(), strip.normals.end());
    mesh.uvs.insert(mesh.uvs.end(), strip.uvs.begin(), strip.uvs.end());
  }
  test::add_object(scene, test::add_mesh(scene, mesh), test::add_material(scene, {}));
  update_derived(scene);
  return scene_glb(scene);
}

constexpr const char* kGltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";

}  // namespace

std::map<std::string, std::string> scene_seeds() {
  return {{"square", test::square_glb().glb()},
          {"textured", textured().glb()},
          {"instanced", instanced().glb()},
          {"levels", of_levels().glb()},
          {"compressed", compressed().glb()},
          {"sparse", sparse().glb()},
          {"quantised", quantised().glb()},
          {"split", split()},
          {"data_uri", kGltf}};
}

std::map<std::string, std::string> other_scene_seeds() {
  return {
      {".obj", "mtllib scene.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl m\nf 1/1/1 2/1/1 3/1/1 4/1/1\n"},
      {".ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
       "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {".stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n"},
      {".ac",
       "AC3Db\nMATERIAL \"m\" rgb 1 1 1 amb 0 0 0 emis 0 0 0 spec 0 0 0 shi 0 trans 0\nOBJECT world\nkids 1\nOBJECT poly\n"
       "name \"a\"\ntexture \"t.png\"\nnumvert 3\n0 0 0\n1 0 0\n0 1 0\nnumsurf 1\nSURF 0x20\nmat 0\nrefs 3\n0 0 0\n1 1 0\n2 0 1\nkids 0\n"},
      {".acc",
       "AC3Db\nMATERIAL \"m\" rgb 1 1 1 amb 0 0 0 emis 0 0 0 spec 0 0 0 shi 0 trans 0\nOBJECT world\nkids 1\nOBJECT poly\n"
       "texture t.png base\ntexture empty_texture_no_mapping tiled\nnumvert 3\n0 0 0\n1 0 0\n0 1 0\nnumsurf 1\nSURF 0x20\nmat 0\nrefs 3\n"
       "0 0 0\n1 1 0\n2 0 1\nkids 0\n"},
      {".dae",
       "<COLLADA version=\"1.4.1\"><library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"a\" count=\"9\">"
       "0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor source=\"#a\" count=\"3\" stride=\"3\"><param name=\"X\" "
       "type=\"float\"/>"
       "<param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common></source><vertices id=\"v\">"
       "<input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" "
       "offset=\"0\"/>"
       "<p>0 1 2</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id=\"s\"><node>"
       "<instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene "
       "url=\"#s\"/></scene></COLLADA>"}};
}

}  // namespace standin::fuzz
