// Small scenes by hand: rectangles and boxes with a material each.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "render/scene/scene.h"

namespace standin::test {

/// Texel (x, y) is colour(x, y); rows go down.
template <typename Colour>
[[nodiscard]] Texture make_texture(int width, int height, const Colour& colour) {
  Texture texture{.name = "test", .width = width, .height = height, .rgba = {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::array<std::uint8_t, 4> texel = colour(x, y);
      for (const std::uint8_t channel : texel) texture.rgba.push_back(channel);
    }
  }
  return texture;
}

/// The rectangle [x0, x1] x [y0, y1] in the plane z, facing +z; uv (0, 0) at its upper left.
[[nodiscard]] inline Mesh make_rectangle(double x0, double y0, double x1, double y1, double z) {
  Mesh mesh;
  mesh.name = "rectangle";
  for (const auto& [u, v] : {std::pair{0.0, 1.0}, {1.0, 1.0}, {1.0, 0.0}, {0.0, 0.0}}) {
    mesh.positions.emplace_back(x0 + u * (x1 - x0), y1 - v * (y1 - y0), z);
    mesh.normals.emplace_back(0.0F, 0.0F, 1.0F);
    mesh.uvs.emplace_back(u, v);
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// The cube [-1, 1]^3, flat normals outward, every face with its own uv square.
[[nodiscard]] inline Mesh make_cube() {
  Mesh mesh;
  mesh.name = "cube";
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0F, 1.0F}) {
      glm::vec3 normal(0.0F);
      normal[axis] = sign;
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const auto& [u, v] : {std::pair{-1.0F, -1.0F}, {1.0F, -1.0F}, {1.0F, 1.0F}, {-1.0F, 1.0F}}) {
        glm::vec3 position = normal;
        position[(axis + 1) % 3] = u * sign;  // counter-clockwise seen from outside
        position[(axis + 2) % 3] = v;
        mesh.positions.push_back(position);
        mesh.normals.push_back(normal);
        mesh.uvs.emplace_back(0.5F * (u + 1.0F), 0.5F * (v + 1.0F));
      }
      for (const std::uint32_t corner : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(first + corner);
    }
  }
  return mesh;
}

inline std::uint32_t add_mesh(Scene& scene, Mesh mesh) {
  scene.meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(scene.meshes.size() - 1);
}

inline std::uint32_t add_material(Scene& scene, Material material) {
  scene.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

/// An object of one part; call update_derived(scene) after the last.
inline std::uint32_t add_object(Scene& scene, std::uint32_t mesh, std::uint32_t material, const Mat4& world_from_object = Mat4(1.0)) {
  Object object;
  object.world_from_object = world_from_object;
  object.first_part = static_cast<std::uint32_t>(scene.parts.size());
  object.part_count = 1;
  scene.parts.push_back({.mesh = mesh, .material = material});
  scene.objects.push_back(object);
  return static_cast<std::uint32_t>(scene.objects.size() - 1);
}

}  // namespace standin::test
