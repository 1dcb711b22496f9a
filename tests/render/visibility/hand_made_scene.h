// Small scenes for visibility tests: boxes, panes and loose triangles, one object each.
#pragma once

#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "render/scene/scene.h"

namespace standin::test {

class SceneMaker {
 public:
  SceneMaker() { scene_.materials.emplace_back(); }

  std::uint32_t add_mesh(std::vector<glm::vec3> positions, std::vector<std::uint32_t> indices, std::vector<glm::vec2> uvs = {}) {
    Mesh mesh;
    mesh.normals.assign(positions.size(), glm::vec3(0.0F, 1.0F, 0.0F));
    mesh.positions = std::move(positions);
    mesh.indices = std::move(indices);
    mesh.uvs = std::move(uvs);
    scene_.meshes.push_back(std::move(mesh));
    return static_cast<std::uint32_t>(scene_.meshes.size() - 1);
  }
  std::uint32_t add_object(std::uint32_t mesh, const Mat4& world_from_object, std::uint32_t material = 0) {
    Object object;
    object.world_from_object = world_from_object;
    object.first_part = static_cast<std::uint32_t>(scene_.parts.size());
    object.part_count = 1;
    scene_.parts.push_back({mesh, material});
    scene_.objects.push_back(object);
    return static_cast<std::uint32_t>(scene_.objects.size() - 1);
  }
  /// The closed cube [-1, 1]^3.
  std::uint32_t cube_mesh() {
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 8; ++i) corners.emplace_back((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1);
    return add_mesh(std::move(corners),
                    {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5});
  }
  /// The square [-1, 1]^2 in z = 0, texture upright.
  std::uint32_t pane_mesh() {
    return add_mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {0, 1, 2, 0, 2, 3}, {{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  }
  std::uint32_t add_box(const Box& box) {
    if (cube_ < 0) cube_ = static_cast<int>(cube_mesh());
    return add_object(static_cast<std::uint32_t>(cube_), glm::scale(glm::translate(Mat4(1.0), box.centre()), 0.5 * box.size()));
  }
  [[nodiscard]] Scene& scene() { return scene_; }
  [[nodiscard]] Scene take() {
    update_derived(scene_);
    return std::move(scene_);
  }

 private:
  Scene scene_;
  int cube_ = -1;
};

}  // namespace standin::test
