// A scene as the thesis' tables want it: loaded, and scaled to the size that they state.
#pragma once

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "render/scene/load.h"

namespace standin {

/// FILE[,up=z][,turn=DEGREES][,tilt=DEGREES][,scale=FACTOR | ,height=METRES | ,length=METRES]: turned about the vertical axis, then tilted
/// towards the viewer in +z (who so looks down on it); `length` is the longest extent; extents are those before turning.
inline Scene load_model(const std::string& argument) {
  std::istringstream fields(argument);
  std::string file;
  std::getline(fields, file, ',');
  LoadOptions options;
  double height_m = 0.0, length_m = 0.0, turn_deg = 0.0, tilt_deg = 0.0, scale = 1.0;
  for (std::string field; std::getline(fields, field, ',');) {
    if (field == "up=z") options.placing.up = UpAxis::kZ;
    if (field.starts_with("scale=")) scale = std::stod(field.substr(6));
    if (field.starts_with("turn=")) turn_deg = std::stod(field.substr(5));
    if (field.starts_with("tilt=")) tilt_deg = std::stod(field.substr(5));
    if (field.starts_with("height=")) height_m = std::stod(field.substr(7));
    if (field.starts_with("length=")) length_m = std::stod(field.substr(7));
  }
  Scene scene = load_scene(file, options);
  const Vec3 size = scene.bounds.size();
  if (height_m > 0.0) scale = height_m / size.y;
  if (length_m > 0.0) scale = length_m / std::max({size.x, size.y, size.z});
  const Mat4 tilted = glm::rotate(Mat4(Mat3(scale)), glm::radians(tilt_deg), Vec3(1.0, 0.0, 0.0));
  const Mat4 placed = glm::rotate(tilted, glm::radians(turn_deg), Vec3(0.0, 1.0, 0.0));
  for (Object& object : scene.objects) object.world_from_object = placed * object.world_from_object;
  update_derived(scene);
  return scene;
}

inline std::string model_name(const std::string& argument) {
  const std::string file = argument.substr(0, argument.find(','));
  return file.substr(file.rfind('/') + 1);
}

inline std::vector<std::uint32_t> all_objects(const Scene& scene) {
  std::vector<std::uint32_t> ids(scene.objects.size());
  std::iota(ids.begin(), ids.end(), 0U);
  return ids;
}

/// A cubic view cell that stands on the model's ground, before its +z face.
inline Box cell_before(const Box& model, double side_m, double distance_m) {
  const Vec3 centre = model.centre();
  const double near_z = model.max.z + distance_m;
  return {{centre.x - 0.5 * side_m, model.min.y, near_z}, {centre.x + 0.5 * side_m, model.min.y + side_m, near_z + side_m}};
}

}  // namespace standin
