// Features of impostors: quads of known texels, so pixels follow from texel sizes and distances (thesis Fig. 5.6).
//
// A texel of slope step e on the layer at distance A from the reference viewpoint is e A metres wide. Seen by an eye whose distance from
// the layer's plane is h <= r, it covers f^2 (e A)^2 h / z^3 pixels, at most f^2 (e A / h)^2 / cos^3: least h, greatest texel angle.
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

}  // namespace

ImpostorCost impostor_cost(const Impostor& impostor) {
  const double nearest_m = nearest_along_forward_m(impostor);
  double texel_angle_rad = 0.0;
  for (const Layer& layer : impostor.layers) {
    const double height_m = layer.distance_m - nearest_m;
    if (!(height_m > 0.0))
      throw Failure(ErrorWord::kInternal, "impostor layer at " + std::to_string(layer.distance_m) +
                                              " m reaches into its view cell, whose border is at " + std::to_string(nearest_m) + " m");
    texel_angle_rad = std::max(texel_angle_rad, std::sqrt(texel_area_m2(impostor.frame, layer)) / height_m);
  }
  return {static_cast<double>(impostor.quads.size()), static_cast<double>(impostor.texel_count()), texel_angle_rad};
}

Features impostor_features_bound(const ImpostorCost& cost, const Camera& camera) {
  Features features = quad_features(cost.quads);
  const double pixels_per_texel = cost.texel_angle_rad * cost.texel_angle_rad * greatest_pixels_per_m2_at_1m(camera);
  features[Term::kImpostorPixels] = (1.0 + 1e-9) * cost.texels * pixels_per_texel;
  return features;
}

Features impostor_features(const Impostor& impostor, const Box& objects_bounds, const View& view, const Camera& camera) {
  const PreparedView prepared(view, camera);
  if (!may_intersect(prepared.frustum, objects_bounds) || impostor.quads.empty()) return {};
  const Projection projection(camera);
  Features features = quad_features(static_cast<double>(impostor.quads.size()));
  for (const Quad& quad : impostor.quads) {
    const Layer& layer = impostor.layers[quad.layer];
    const Vec3 centre = layer_point(impostor.frame, layer.distance_m, quad.x + 0.5 * quad.width, quad.y + 0.5 * quad.height);
    const Vec3 eye_point = prepared.eye_from_world * (centre - prepared.position);
    if (!projection.sees(eye_point)) continue;
    const double area_m2 = texel_area_m2(impostor.frame, layer) * quad.width * quad.height;
    features[Term::kImpostorPixels] += projection.pixels(eye_point, area_m2 * (prepared.eye_from_world * impostor.frame.forward));
  }
  return features;
}

}  // namespace standin
