#include "render/device/reference_frame.h"

#include <cmath>
#include <numeric>

#include "render/base/rng.h"

namespace standin {
namespace {

constexpr int kReliefCells = 32;  // 2,048 triangles
constexpr double kReliefSide_m = 80.0;
constexpr int kBoxesPerSide = 8;  // 64 boxes, 768 triangles
constexpr int kTextureSide = 256;
constexpr std::uint64_t kSeed = 20010923;

Texture make_noise_texture(std::uint64_t stream) {
  Texture texture{.name = "reference", .width = kTextureSide, .height = kTextureSide, .rgba = {}};
  Rng rng(kSeed, stream);
  for (int texel = 0; texel < kTextureSide * kTextureSide; ++texel) {
    for (int channel = 0; channel < 3; ++channel) texture.rgba.push_back(static_cast<std::uint8_t>(96 + rng.below(160)));
    texture.rgba.push_back(255);
  }
  return texture;
}

double relief_height_m(double x, double z) {
  return 1.5 * std::sin(0.21 * x) * std::cos(0.17 * z);
}

void push_triangles(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  for (const std::uint32_t index : {a, b, c, a, c, d}) mesh.indices.push_back(index);
}

Mesh make_relief() {
  Mesh mesh;
  mesh.name = "relief";
  for (int row = 0; row <= kReliefCells; ++row) {
    for (int column = 0; column <= kReliefCells; ++column) {
      const double x = kReliefSide_m * (static_cast<double>(column) / kReliefCells - 0.5);
      const double z = kReliefSide_m * (static_cast<double>(row) / kReliefCells - 0.5);
      mesh.positions.emplace_back(x, relief_height_m(x, z), z);
      mesh.normals.emplace_back(0.0F, 1.0F, 0.0F);
      mesh.uvs.emplace_back(0.2 * x, 0.2 * z);
    }
  }
  constexpr std::uint32_t kPitch = kReliefCells + 1;
  for (std::uint32_t row = 0; row < kReliefCells; ++row)
    for (std::uint32_t column = 0; column < kReliefCells; ++column)
      push_triangles(mesh, row * kPitch + column, (row + 1) * kPitch + column, (row + 1) * kPitch + column + 1, row * kPitch + column + 1);
  return mesh;
}

// A unit cube on the ground, four vertices a face.
Mesh make_box() {
  Mesh mesh;
  mesh.name = "box";
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0F, 1.0F}) {
      glm::vec3 normal(0.0F);
      normal[axis] = sign;
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const auto& [u, v] : {std::pair{0.0F, 0.0F}, {1.0F, 0.0F}, {1.0F, 1.0F}, {0.0F, 1.0F}}) {
        glm::vec3 position = 0.5F * normal + glm::vec3(0.0F, 0.5F, 0.0F);
        position[(axis + 1) % 3] += u - 0.5F;
        position[(axis + 2) % 3] += v - 0.5F;
        mesh.positions.push_back(position);
        mesh.normals.push_back(normal);
        mesh.uvs.emplace_back(u, v);
      }
      push_triangles(mesh, first, first + 1, first + 2, first + 3);
    }
  }
  return mesh;
}

void add_object(Scene& scene, std::uint32_t mesh, std::uint32_t material, const Mat4& world_from_object) {
  Object object;
  object.world_from_object = world_from_object;
  object.first_part = static_cast<std::uint32_t>(scene.parts.size());
  object.part_count = 1;
  scene.parts.push_back({.mesh = mesh, .material = material});
  scene.objects.push_back(object);
}

void add_boxes(Scene& scene) {
  Rng rng(kSeed);
  for (int i = 0; i < kBoxesPerSide * kBoxesPerSide; ++i) {
    const int row = i / kBoxesPerSide;
    const int column = i % kBoxesPerSide;
    const double x = 9.0 * (column - 0.5 * kBoxesPerSide);
    const double z = 9.0 * (row - 0.5 * kBoxesPerSide);
    Mat4 world_from_box(1.0);
    world_from_box[0][0] = rng.uniform(0.8, 2.0);
    world_from_box[1][1] = rng.uniform(0.8, 5.0);
    world_from_box[2][2] = rng.uniform(0.8, 2.0);
    world_from_box[3] = Vec4(x, relief_height_m(x, z), z, 1.0);
    add_object(scene, 1, static_cast<std::uint32_t>(rng.below(4)), world_from_box);
  }
}

}  // namespace

Scene make_reference_scene() {
  Scene scene;
  scene.name = "reference";
  for (int i = 0; i < 3; ++i) {
    scene.textures.push_back(make_noise_texture(static_cast<std::uint64_t>(i)));
    scene.materials.emplace_back().texture = i;
  }
  scene.materials.emplace_back().base_colour = {0.7F, 0.6F, 0.5F, 1.0F};  // untextured
  scene.meshes = {make_relief(), make_box()};
  add_object(scene, 0, 0, Mat4(1.0));
  add_boxes(scene);
  update_derived(scene);
  return scene;
}

ReferenceFrame::ReferenceFrame(Context& context)
    : scene_(make_reference_scene()),
      renderer_(context, scene_, Camera{.width = 256, .height = 256}),
      view_{.position = Vec3(-38.0, 9.0, 40.0), .direction = glm::normalize(Vec3(0.7, -0.25, -0.75))} {
  everything_.objects.resize(scene_.objects.size());
  std::iota(everything_.objects.begin(), everything_.objects.end(), 0U);
}

}  // namespace standin
