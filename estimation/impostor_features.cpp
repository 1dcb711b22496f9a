// Features of impostors: triangles of known places, so pixels follow from areas and distances (thesis Fig. 5.6).
//
// A texel of slope step e on the layer at distance A from the reference viewpoint is e A metres wide. Seen by an eye whose distance from
// the layer's plane is h <= r, it covers f^2 (e A)^2 h / z^3 pixels, at most f^2 (e A / h)^2 / cos^3: least h, greatest texel angle. A mesh
// is measured by the same rule: each triangle counts as the texels of that greatest angle which its area would be at its nearest corner.
#include <algorithm>
#include <cmath>
#include <string>

#include "estimation/features.h"
#include "estimation/projection.h"
#include "render/base/error.h"

namespace standin {
namespace {

/// Where the view cell's nearest point to the layers lies along the frame's forward axis, from the reference viewpoint.
double nearest_along_forward_m(const Impostor& impostor) {
  const ImpostorFrame& frame = impostor.frame;
  if (const Box* box = std::get_if<Box>(&impostor.view_cell))
    return box->support(frame.forward) - glm::dot(frame.forward, frame.reference_viewpoint);
  const Shaft& shaft = std::get<Shaft>(impostor.view_cell);
  const Vec3 border_centre = shaft.apex + shaft.min_distance_m * shaft.axis;
  return glm::dot(border_centre - frame.reference_viewpoint, frame.forward);
}

double texel_area_m2(const ImpostorFrame& frame, const Layer& layer) {
  return frame.slope_step.x * frame.slope_step.y * layer.distance_m * layer.distance_m;
}

/// Everything but the pixels.
Features quad_features(double quads) {
  Features features;
  features[Term::kDraws] = quads > 0.0 ? 1.0 : 0.0;
  features[Term::kImpostorQuads] = quads;
  return features;
}

[[noreturn]] void reject(const char* what, double at_m, double border_m) {
  throw Failure(ErrorWord::kInternal, std::string("impostor ") + what + " at " + std::to_string(at_m) +
                                          " m reaches into its view cell, whose border is at " + std::to_string(border_m) + " m");
}

double greatest_texel_angle_rad(const Impostor& impostor, double nearest_m) {
  double texel_angle_rad = 0.0;
  for (const Layer& layer : impostor.layers) {
    const double height_m = layer.distance_m - nearest_m;
    if (!(height_m > 0.0)) reject("layer", layer.distance_m, nearest_m);
    texel_angle_rad = std::max(texel_angle_rad, std::sqrt(texel_area_m2(impostor.frame, layer)) / height_m);
  }
  return texel_angle_rad;
}

/// A triangle's corners from the reference viewpoint.
struct Corners {
  Vec3 a, b, c;
  [[nodiscard]] Vec3 centre() const { return (a + b + c) / 3.0; }
  [[nodiscard]] Vec3 vector_area_m2() const { return 0.5 * glm::cross(b - a, c - a); }
};

template <class Visit>
void for_each_triangle(const TexturedMesh& mesh, const Visit& visit) {
  for (const Chart& chart : mesh.charts)
    for (std::uint32_t i = chart.first_index; i < chart.first_index + chart.index_count; i += 3) {
      const auto corner = [&](std::uint32_t k) { return mesh.vertices[chart.first_vertex + mesh.indices[i + k]].offset; };
      visit(Corners{corner(0), corner(1), corner(2)});
    }
}

double drawn_texels(const Impostor& impostor, double nearest_m, double texel_angle_rad) {
  if (!is_mesh(impostor.technique)) return static_cast<double>(impostor.texel_count());
  double texels = 0.0;
  for_each_triangle(impostor.mesh, [&](const Corners& triangle) {
    const auto depth_m = [&](const Vec3& corner) { return glm::dot(corner, impostor.frame.forward); };
    const double height_m = std::min({depth_m(triangle.a), depth_m(triangle.b), depth_m(triangle.c)}) - nearest_m;
    if (!(height_m > 0.0)) reject("triangle", height_m + nearest_m, nearest_m);
    texels += glm::length(triangle.vector_area_m2()) / std::pow(height_m * texel_angle_rad, 2);
  });
  return std::ceil(texels);
}

}  // namespace

ImpostorCost impostor_cost(const Impostor& impostor) {
  const double nearest_m = nearest_along_forward_m(impostor);
  const double texel_angle_rad = greatest_texel_angle_rad(impostor, nearest_m);
  const double quads = !is_mesh(impostor.technique) ? static_cast<double>(impostor.quads.size())
                                                    : std::ceil(0.5 * static_cast<double>(impostor.mesh.triangle_count()));
  return {quads, drawn_texels(impostor, nearest_m, texel_angle_rad), texel_angle_rad};
}

Features impostor_features_bound(const ImpostorCost& cost, const Camera& camera) {
  Features features = quad_features(cost.quads);
  const double pixels_per_texel = cost.texel_angle_rad * cost.texel_angle_rad * greatest_pixels_per_m2_at_1m(camera);
  features[Term::kImpostorPixels] = (1.0 + 1e-9) * cost.texels * pixels_per_texel;
  return features;
}

Features impostor_features(const Impostor& impostor, const Box& objects_bounds, const View& view, const Camera& camera) {
  const PreparedView prepared(view, camera);
  if (!may_intersect(prepared.frustum, objects_bounds) || impostor.empty()) return {};
  const Projection projection(camera);
  const TexturedMesh mesh = textured_mesh(impostor);
  const Vec3 eye_from_viewpoint = impostor.frame.reference_viewpoint - prepared.position;
  Features features = quad_features(0.5 * static_cast<double>(mesh.triangle_count()));
  for_each_triangle(mesh, [&](const Corners& triangle) {
    const Vec3 eye_point = prepared.eye_from_world * (eye_from_viewpoint + triangle.centre());
    if (projection.sees(eye_point))
      features[Term::kImpostorPixels] += projection.pixels(eye_point, prepared.eye_from_world * triangle.vector_area_m2());
  });
  return features;
}

}  // namespace standin
