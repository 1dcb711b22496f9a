#include "render/impostor/cluster_surface.h"

#include <algorithm>

#include "render/impostor/recording.h"

namespace standin {
namespace {

std::vector<Vec3> corners_of(const Shaft& shaft) {
  std::vector<Vec3> corners;
  for (const double x : {-shaft.tan_half.x, shaft.tan_half.x})
    for (const double y : {-shaft.tan_half.y, shaft.tan_half.y})
      corners.push_back(shaft.apex + shaft.min_distance_m * (shaft.axis + x * shaft.right + y * shaft.up));
  return corners;
}

std::vector<Vec3> corners_of(const Box& box) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.push_back(box.corner(i));
  return corners;
}

/// Which planes someone in the view cell is in front of. A shaft is open: its corner rays tell as well as its near corners.
class Viewers {
 public:
  Viewers(const ViewCell& cell, const Vec3& origin) : corners_(corner_viewpoints(cell, origin)) {
    if (const auto* shaft = std::get_if<Shaft>(&cell))
      for (const Vec3& corner : corners_) rays_.push_back(corner + origin - shaft->apex);
  }

  [[nodiscard]] bool any_in_front_of(const std::array<Vec3, 3>& triangle) const {
    const Vec3 normal = unit_normal(triangle);
    const auto sees = [&](const Vec3& corner) { return glm::dot(normal, corner - triangle[0]) > 0.0; };
    const auto comes_to_see = [&](const Vec3& ray) { return glm::dot(normal, ray) > 0.0; };
    return std::any_of(corners_.begin(), corners_.end(), sees) || std::any_of(rays_.begin(), rays_.end(), comes_to_see);
  }

 private:
  std::vector<Vec3> corners_;
  std::vector<Vec3> rays_;
};

class Collector {
 public:
  Collector(const Scene& scene, const BakeRequest& request, const Vec3& origin)
      : scene_(scene), request_(request), origin_(origin), viewers_(request.view_cell, origin) {}

  void add_object(std::uint32_t id) {
    const Object& object = scene_.objects[id];
    for (std::uint32_t i = 0; i < object.part_count; ++i) {
      const Part& part = scene_.parts[object.first_part + i];
      if (scene_.materials[part.material].alpha_mode == AlphaMode::kMask)
        throw impossible(request_, "object " + std::to_string(id) + " has masked surfaces; a LOD-sprite takes opaque ones alone");
      add_part(object, part);
    }
  }

  [[nodiscard]] std::vector<SurfaceTriangle> take() { return std::move(triangles_); }

 private:
  void add_part(const Object& object, const Part& part) {
    const Mesh& mesh = scene_.meshes[part.mesh];
    const Mat3 m(object.world_from_object);
    const bool mirrored = glm::determinant(m) < 0.0;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      std::array<std::uint32_t, 3> corners{mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]};
      if (mirrored) std::swap(corners[1], corners[2]);
      add_triangle(object, part, mesh, corners);
    }
  }

  void add_triangle(const Object& object, const Part& part, const Mesh& mesh, const std::array<std::uint32_t, 3>& corners) {
    const Mat3 m(object.world_from_object);
    const Mat3 world_from_normal(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    SurfaceTriangle triangle;
    triangle.material = part.material;
    triangle.textured = !mesh.uvs.empty();
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.corners[k] = m * Vec3(mesh.positions[corners[k]]) + (Vec3(object.world_from_object[3]) - origin_);
      triangle.attributes.normal[k] = world_from_normal * Vec3(mesh.normals[corners[k]]);
      if (triangle.textured) triangle.attributes.uv[k] = Vec2(mesh.uvs[corners[k]]);
    }
    if (unit_normal(triangle.corners) == Vec3(0.0)) return;  // no ray ever hits it
    if (scene_.materials[part.material].double_sided || viewers_.any_in_front_of(triangle.corners)) triangles_.push_back(triangle);
  }

  const Scene& scene_;
  const BakeRequest& request_;
  Vec3 origin_;
  Viewers viewers_;
  std::vector<SurfaceTriangle> triangles_;
};

}  // namespace

Vec3 unit_normal(const std::array<Vec3, 3>& corners) {
  const Vec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double length = glm::length(normal);
  return length > 0.0 ? normal / length : Vec3(0.0);
}

std::vector<Vec3> corner_viewpoints(const ViewCell& cell, const Vec3& reference_viewpoint) {
  std::vector<Vec3> corners = std::visit([](const auto& shape) { return corners_of(shape); }, cell);
  for (Vec3& corner : corners) corner -= reference_viewpoint;
  return corners;
}

std::vector<SurfaceTriangle> cluster_surface(const Scene& scene, const BakeRequest& request, const Vec3& reference_viewpoint) {
  Collector collector(scene, request, reference_viewpoint);
  for (const std::uint32_t id : request.objects) collector.add_object(id);
  return collector.take();
}

}  // namespace standin
