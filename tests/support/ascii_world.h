// Worlds drawn as floor plans, and a time model simple enough to check by hand.
//
//   ascii_world({"..T", "#.."})   rows go along +z, columns along +x, each symbol one square of 10 m; object 0 is the ground (2 triangles)
//     .  nothing      #  house: the whole square, 8 m high, 12 triangles      T  tree: the middle of the square, 6 m high, 1,200 triangles
//     o  kiosk: the middle of the square, 2 m high, 120 triangles
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "estimation/time_model.h"
#include "render/scene/scene.h"
#include "tests/support/scene_builder.h"

namespace standin::test {

inline constexpr double kSquare_m = 10.0;

/// The cube [0, 1]^3 in 12 * strips triangles: every face is cut into strips.
[[nodiscard]] inline Mesh make_strip_box(std::uint32_t strips) {
  Mesh mesh;
  mesh.name = "box";
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    glm::vec3 normal(0.0F);
    normal[axis] = face % 2 == 0 ? -1.0F : 1.0F;
    for (std::uint32_t s = 0; s < strips; ++s) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (int corner = 0; corner < 4; ++corner) {
        glm::vec3 position(0.0F);
        position[axis] = face % 2 == 0 ? 0.0F : 1.0F;
        position[(axis + 1) % 3] = static_cast<float>(s + (corner & 1)) / static_cast<float>(strips);
        position[(axis + 2) % 3] = static_cast<float>(corner >> 1);
        mesh.positions.push_back(position);
        mesh.normals.push_back(normal);
      }
      for (const std::uint32_t corner : {0U, 1U, 3U, 0U, 3U, 2U}) mesh.indices.push_back(first + corner);
    }
  }
  return mesh;
}

/// The unit cube's image.
[[nodiscard]] inline Mat4 world_from_unit(const Box& box) {
  Mat4 world_from_object(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    world_from_object[axis][axis] = box.size()[axis];
    world_from_object[3][axis] = box.min[axis];
  }
  return world_from_object;
}

[[nodiscard]] inline Mesh make_ground(double width_m, double depth_m) {
  Mesh mesh;
  mesh.name = "ground";
  mesh.positions = {{0, 0, 0}, {width_m, 0, 0}, {width_m, 0, depth_m}, {0, 0, depth_m}};
  mesh.normals.assign(4, {0, 1, 0});
  mesh.indices = {0, 2, 1, 0, 3, 2};
  return mesh;
}

[[nodiscard]] inline Scene ascii_world(const std::vector<std::string>& rows) {
  Scene scene;
  scene.name = "ascii";
  add_material(scene, {});
  const double width_m = kSquare_m * static_cast<double>(rows.front().size()), depth_m = kSquare_m * static_cast<double>(rows.size());
  scene.objects[add_object(scene, add_mesh(scene, make_ground(width_m, depth_m)), 0)].name = "ground";
  const std::uint32_t house = add_mesh(scene, make_strip_box(1)), kiosk = add_mesh(scene, make_strip_box(10)),
                      tree = add_mesh(scene, make_strip_box(100));
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (std::size_t column = 0; column < rows[row].size(); ++column) {
      const char symbol = rows[row][column];
      if (symbol == '.') continue;
      const double margin = symbol == '#' ? 0.0 : 0.3 * kSquare_m;
      const double height_m = symbol == '#' ? 8.0 : symbol == 'T' ? 6.0 : 2.0;
      const Vec3 corner(kSquare_m * static_cast<double>(column), 0.0, kSquare_m * static_cast<double>(row));
      const Box box{corner + Vec3(margin, 0.0, margin), corner + Vec3(kSquare_m - margin, height_m, kSquare_m - margin)};
      const std::uint32_t mesh = symbol == '#' ? house : symbol == 'T' ? tree : kiosk;
      scene.objects[add_object(scene, mesh, 0, world_from_unit(box))].name = symbol == '#' ? "house" : symbol == 'T' ? "tree" : "kiosk";
    }
  update_derived(scene);
  return scene;
}

/// 0.001 ms per submitted triangle, an impostor's quad being two, and nothing else: 1.2 ms a tree.
[[nodiscard]] inline TimeModel triangle_time_model() {
  TimeModel model;
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kTriangles)] = 0.001;
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kImpostorQuads)] = 0.002;
  return model;
}

/// Every term costs something.
[[nodiscard]] inline TimeModel full_time_model() {
  TimeModel model;
  for (std::size_t i = 0; i < kTermCount; ++i) {
    const auto term = static_cast<Term>(i);
    const bool counts_pixels = is_pixel_term(term) || term == Term::kEdgePixels || term == Term::kImpostorPixels;
    model.milliseconds_per_unit[i] = counts_pixels ? 2e-6 * static_cast<double>(i + 1) : 0.0005 * static_cast<double>(i + 1);
  }
  return model;
}

/// Rank = id: what a hierarchy over few objects may give.
[[nodiscard]] inline std::vector<std::uint32_t> identity_rank(const Scene& scene) {
  std::vector<std::uint32_t> rank(scene.objects.size());
  for (std::uint32_t i = 0; i < rank.size(); ++i) rank[i] = i;
  return rank;
}

}  // namespace standin::test
