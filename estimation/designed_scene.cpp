#include "estimation/designed_scene.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "render/base/rng.h"

namespace standin {
namespace {

constexpr std::uint64_t kSeed = 20050505;
constexpr int kTextureSide = 256;
constexpr int kCrowdTextureSide = 64;
constexpr double kPitch_m = 12.0;
constexpr double kRadius_m = 2.5;
constexpr int kCopies = 2;  // of each ball
constexpr int kCrowd = 800;
constexpr int kCrowdSide = 20;
constexpr std::uint32_t kCrowdMeshes = 64;
constexpr std::uint32_t kCrowdTextures = 200;

/// Materials, by index; those of the crowd follow.
enum Style : std::uint32_t { kPlain, kTextured, kMasked, kPlainOneSided, kTexturedOneSided, kStyles };

/// Noise; with `holes`, two texels of five in blocks of 8 x 8 are transparent.
Texture noise_texture(std::uint64_t stream, int side, bool holes) {
  Texture texture{.name = holes ? "holes" : "noise", .width = side, .height = side, .rgba = {}};
  Rng rng(kSeed, stream);
  std::vector<bool> open;
  for (int block = 0; block < side * side / 64; ++block) open.push_back(holes && rng.uniform() < 0.4);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      for (int channel = 0; channel < 3; ++channel) texture.rgba.push_back(static_cast<std::uint8_t>(96 + rng.below(160)));
      texture.rgba.push_back(open[static_cast<std::size_t>(y / 8 * (side / 8) + x / 8)] ? 0 : 255);
    }
  return texture;
}

void add_materials(Scene& scene) {
  scene.textures = {noise_texture(1, kTextureSide, false), noise_texture(2, kTextureSide, true)};
  scene.materials.resize(kStyles);
  scene.materials[kPlain].base_colour = {0.7F, 0.6F, 0.5F, 1.0F};
  scene.materials[kTextured].texture = 0;
  scene.materials[kMasked].texture = 1;
  scene.materials[kMasked].alpha_mode = AlphaMode::kMask;
  scene.materials[kPlainOneSided] = scene.materials[kPlain];
  scene.materials[kTexturedOneSided] = scene.materials[kTextured];
  for (const Style style : {kPlainOneSided, kTexturedOneSided}) scene.materials[style].double_sided = false;
}

/// A ball of `rings` x 2 `rings` quads, its poles along y.
Mesh ball(int rings) {
  Mesh mesh;
  mesh.name = "ball";
  const int columns = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j <= columns; ++j) {
      const double polar = std::numbers::pi * i / rings, azimuth = 2.0 * std::numbers::pi * j / columns;
      const Vec3 normal(std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth));
      mesh.positions.emplace_back(kRadius_m * normal);
      mesh.normals.emplace_back(normal);
      mesh.uvs.emplace_back(4.0 * j / columns, 2.0 * i / rings);
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (columns + 1) + j); };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < columns; ++j)
      for (const std::uint32_t index : {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i + 1, j)})
        mesh.indices.push_back(index);
  return mesh;
}

/// Two triangles that face +z.
Mesh panel() {
  Mesh mesh;
  mesh.name = "panel";
  for (const auto& [x, y] : {std::pair{-1.0F, -1.0F}, {1.0F, -1.0F}, {1.0F, 1.0F}, {-1.0F, 1.0F}}) {
    mesh.positions.push_back(static_cast<float>(kRadius_m) * glm::vec3(x, y, 0.0F));
    mesh.normals.emplace_back(0.0F, 0.0F, 1.0F);
    mesh.uvs.emplace_back(x, y);
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

void add_object(Scene& scene, std::uint32_t mesh, std::uint32_t material, const Vec3& place, double scale) {
  Object object;
  object.name = scene.meshes[mesh].name + " " + std::to_string(scene.objects.size());
  object.world_from_object = glm::scale(glm::translate(Mat4(1.0), place), Vec3(scale));
  object.first_part = static_cast<std::uint32_t>(scene.parts.size());
  object.part_count = 1;
  scene.parts.push_back({mesh, material});
  scene.objects.push_back(object);
}

/// A row of every fineness, twice.
void add_row(Scene& scene, std::uint32_t meshes, Style style, double z_m) {
  for (int copy = 0; copy < kCopies; ++copy)
    for (std::uint32_t mesh = 0; mesh < meshes; ++mesh)
      add_object(scene, mesh, style, {kPitch_m * (meshes * static_cast<std::uint32_t>(copy) + mesh), kRadius_m, z_m}, 1.0);
}

/// Light objects close together, no two of one material: what a draw costs, with the changes of state that go with it in a scene of many
/// textures.
void add_crowd(Scene& scene, const Vec3& corner) {
  constexpr double kScale = 0.12;
  const auto first_mesh = static_cast<std::uint32_t>(scene.meshes.size());
  for (std::uint32_t i = 0; i < kCrowdMeshes; ++i) scene.meshes.push_back(i % 2 == 0 ? panel() : ball(3));
  const auto first_texture = static_cast<std::int32_t>(scene.textures.size());
  for (std::uint32_t i = 0; i < kCrowdTextures; ++i) scene.textures.push_back(noise_texture(3 + i, kCrowdTextureSide, false));
  Rng rng(kSeed);
  for (int i = 0; i < kCrowd; ++i) {
    Material& material = scene.materials.emplace_back();
    if (i % 8 != 0) material.texture = first_texture + static_cast<std::int32_t>(rng.below(kCrowdTextures));
    add_object(scene, first_mesh + static_cast<std::uint32_t>(rng.below(kCrowdMeshes)),
               static_cast<std::uint32_t>(scene.materials.size() - 1),
               corner + Vec3(0.9 * (i % kCrowdSide), kScale * kRadius_m, 0.9 * (i / kCrowdSide)), kScale);
  }
}

}  // namespace

Scene make_designed_scene() {
  Scene scene;
  scene.name = "designed";
  add_materials(scene);
  scene.meshes.push_back(panel());
  for (const int rings : {3, 10, 32, 120}) scene.meshes.push_back(ball(rings));
  const auto meshes = static_cast<std::uint32_t>(scene.meshes.size());
  for (const Style style : {kPlain, kTextured, kMasked, kPlainOneSided, kTexturedOneSided})
    add_row(scene, meshes, style, kPitch_m * static_cast<double>(style));
  add_crowd(scene, {0.0, 0.0, static_cast<double>(kStyles) * kPitch_m});
  update_derived(scene);
  return scene;
}

}  // namespace standin
