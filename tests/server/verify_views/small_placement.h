// Two walls across -z, the near one of many triangles; a placement that lets an impostor stand for it in one region.
#pragma once

#include <algorithm>
#include <numbers>

#include "placement/runtime/placement.h"
#include "render/impostor/atlas.h"
#include "render/impostor/bake.h"
#include "render/impostor/impostor_glb.h"
#include "tests/support/scene_builder.h"

namespace standin::test {

inline constexpr std::uint64_t kWallTriangles = 200;

/// A wall of `strips` rectangles side by side, 20 m wide and 10 m high, at z.
[[nodiscard]] inline Mesh striped_wall(int strips, double z) {
  Mesh mesh;
  for (int i = 0; i < strips; ++i) {
    const Mesh strip = make_rectangle(-10.0 + 20.0 * i / strips, -5.0, -10.0 + 20.0 * (i + 1) / strips, 5.0, z);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), strip.positions.begin(), strip.positions.end());
    mesh.normals.insert(mesh.normals.end(), strip.normals.begin(), strip.normals.end());
    for (const auto index : strip.indices) mesh.indices.push_back(first + index);
  }
  return mesh;
}

[[nodiscard]] inline Material unlit_colour(const glm::vec4& colour) {
  Material material;
  material.base_colour = colour;
  material.unlit = true;
  return material;
}

[[nodiscard]] inline Scene two_walls() {
  Scene scene;
  const auto red = add_material(scene, unlit_colour({1.0F, 0.0F, 0.0F, 1.0F}));
  const auto green = add_material(scene, unlit_colour({0.0F, 1.0F, 0.0F, 1.0F}));
  add_object(scene, add_mesh(scene, striped_wall(static_cast<int>(kWallTriangles / 2), -40.0)), red);
  add_object(scene, add_mesh(scene, striped_wall(1, -60.0)), green);
  update_derived(scene);
  return scene;
}

/// An eye may be anywhere in [-4, 4] x [-1, 1] x [-4, 4]; the root cube is split in two per axis. Both cells of lower x (z below and above
/// 0) have two regions that look along -z at the wall.
struct SmallPlacement {
  Scene scene = two_walls();
  Camera camera{.fov_y_rad = 0.25 * std::numbers::pi, .width = 64, .height = 64};
  ViewSpace view_space;
  Placement placement;
  ImpostorSet impostors;
  std::string glb;

  SmallPlacement() {
    ViewSpaceOptions options;
    options.leaf_m = 4.0;
    view_space = make_box_view_space({{Vec3(-4.0, -1.0, -4.0), Vec3(4.0, 1.0, 4.0)}}, options);
    placement.root_min = view_space.root_min;
    placement.root_side_m = view_space.root_side_m;
    placement.intervals = {interval_of(Vec3(0.01, 0.01, -1.0), 2), interval_of(Vec3(-0.01, 0.01, -1.0), 2)};
    std::sort(placement.intervals.begin(), placement.intervals.end());
    for (const auto& key : leaf_keys()) placement.cells.push_back({key, view_space.cell_box(key), -1});
    bake();
    for (std::uint32_t cell = 0; cell < 2; ++cell)
      for (std::uint32_t interval = 0; interval < 2; ++interval)
        placement.cpvs.push_back({cell, interval, 30.0, 10.0 + cell + 0.5 * interval, true, {0}});
  }

  [[nodiscard]] std::vector<CellKey> leaf_keys() const {
    std::vector<CellKey> keys;
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 2; ++k) keys.push_back({1, {i, 0, k}});
    return keys;
  }

 private:
  void bake() {
    const Box served{Vec3(-4.0, -1.0, -4.0), Vec3(4.0, 1.0, 4.0)};
    Impostor impostor = bake_layered(scene, {{0}, served}, camera, {});
    PlacementImpostor placed;
    placed.objects = impostor.objects;
    placed.view_cell = impostor.view_cell;
    placed.frame = impostor.frame;
    placed.layers = impostor.layers;
    placed.quads = static_cast<std::uint32_t>(impostor.quads.size());
    placement.impostors = {placed};
    std::vector<Impostor> list;
    list.push_back(std::move(impostor));
    impostors = pack_atlas(std::move(list));
    glb = encode_impostor_glb(impostors);
  }
};

}  // namespace standin::test
