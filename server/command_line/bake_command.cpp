// bake: one impostor for a given view cell, with its files, its cost and its quality.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/trigonometric.hpp>
#include <iostream>
#include <numeric>
#include <sstream>

#include "render/base/error.h"
#include "render/impostor/atlas.h"
#include "render/impostor/impostor_glb.h"
#include "render/impostor/technique.h"
#include "render/impostor/texture_pyramid.h"
#include "render/scene/load.h"
#include "render/scene/object_bounds.h"
#include "server/command_line/commands.h"
#include "server/files/output_folder.h"
#include "server/job/gpu_memory.h"
#include "server/job/world.h"
#include "server/verify/impostor_quality.h"

namespace standin {
namespace {

using nlohmann::json;

[[noreturn]] void reject(const std::string& flag, const std::string& text, const std::string& constraint) {
  throw Failure(ErrorWord::kBadUsage, flag + " " + text + " violates: " + constraint);
}

// "1,2,5-9" -> ids; all objects where the text is empty.
std::vector<std::uint32_t> parse_objects(const std::string& text, std::size_t count) {
  std::vector<std::uint32_t> ids;
  if (text.empty()) {
    ids.resize(count);
    std::iota(ids.begin(), ids.end(), 0U);
    return ids;
  }
  std::istringstream stream(text);
  for (std::string item; std::getline(stream, item, ',');) {
    unsigned long first = 0, last = 0;
    char extra = 0;
    const int fields = std::sscanf(item.c_str(), "%lu-%lu%c", &first, &last, &extra);
    const bool single = fields == 1 && item.find_first_not_of("0123456789") == std::string::npos;
    if (single) last = first;
    if ((!single && fields != 2) || first > last || last >= count)
      reject("--objects", text, "ids below " + std::to_string(count) + ", as 1,2,5-9; got \"" + item + "\"");
    for (auto id = first; id <= last; ++id) ids.push_back(static_cast<std::uint32_t>(id));
  }
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

std::vector<double> parse_numbers(const std::string& text, std::size_t from, std::size_t count, const std::string& constraint) {
  std::vector<double> numbers;
  std::istringstream stream(text.substr(from));
  for (std::string item; std::getline(stream, item, ',');) {
    char* end = nullptr;
    numbers.push_back(std::strtod(item.c_str(), &end));
    if (end == item.c_str() || *end != '\0' || !std::isfinite(numbers.back())) reject("--view-cell", text, constraint);
  }
  if (numbers.size() != count) reject("--view-cell", text, constraint);
  return numbers;
}

ViewCell parse_view_cell(const std::string& text, const Vec3& apex) {
  if (text.starts_with("box:")) {
    const auto n = parse_numbers(text, 4, 6, "box:X0,Y0,Z0,X1,Y1,Z1");
    const Box box{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    if (box.empty()) reject("--view-cell", text, "lower corner <= upper corner");
    return box;
  }
  const std::string form = "shaft:DX,DY,DZ,APEX_DEG,MIN_DISTANCE with a direction, an apex angle in (0, 120] and a distance > 0";
  if (!text.starts_with("shaft:")) reject("--view-cell", text, form + ", or box:X0,Y0,Z0,X1,Y1,Z1");
  const auto n = parse_numbers(text, 6, 5, form);
  const Vec3 direction(n[0], n[1], n[2]);
  if (!(glm::length(direction) > 0.0) || !(n[3] > 0.0) || n[3] > 120.0 || !(n[4] > 0.0)) reject("--view-cell", text, form);
  Shaft shaft = shaft_frame(apex, glm::normalize(direction));
  shaft.tan_half = Vec2(std::tan(glm::radians(n[3]) / 2.0));
  shaft.min_distance_m = n[4];
  return shaft;
}

Impostor bake(const Scene& scene, const BakeRequest& request, const CommandContext& context) {
  return bake_impostor(scene, TexturePyramids(scene), technique_named(context.arguments.technique).value(), request,
                       camera_of(context.spec), quality_of(context.spec, ViewSpaceKind::kWalk), context.budget);
}

json cost_json(const Impostor& impostor) {
  return {{"technique", technique_name(impostor.technique)},
          {"layers", impostor.layers.size()},
          {"quads", impostor.quads.size()},
          {"triangles", textured_mesh(impostor).triangle_count()},
          {"resolution", {impostor.frame.width, impostor.frame.height}},
          {"texels", impostor.texel_count()},
          {"texture_bytes", texture_bytes(impostor)},
          {"geometry_bytes", geometry_bytes(impostor)}};
}

json image_json(const CommandContext& context, const Scene& scene, const Impostor& impostor, const std::string& glb) {
  const Camera camera = camera_of(context.spec);
  const QualityOptions options{context.arguments.quality_views, context.spec.seed, thread_count(context.spec),
                               context.spec.device == "egl" ? DeviceKind::kEgl : DeviceKind::kOsMesa};
  return quality_json(
      judge_quality(scene, impostor, glb, camera, context.spec.alpha_scale * camera.pixel_angle_rad(), options, context.budget));
}

}  // namespace

int bake_command(const CommandContext& context) {
  const auto& arguments = context.arguments;
  const Scene scene = load_scene(arguments.scenes.front(), load_options(context.spec));
  BakeRequest request{parse_objects(arguments.objects, scene.objects.size()), {}};
  request.view_cell = parse_view_cell(arguments.view_cell, bounds_of(scene, request.objects).centre());
  const json job = {{"kind", "bake"},
                    {"scene", scene.sha256},
                    {"objects", arguments.objects},
                    {"view_cell", arguments.view_cell},
                    {"technique", arguments.technique},
                    {"spec", to_json(context.spec, true)}};
  OutputFolder folder(arguments.output, job.dump());
  const Impostor impostor = bake(scene, request, context);
  const ImpostorSet set = pack_atlas({impostor});
  const std::string glb = encode_impostor_glb(set);
  json metrics = cost_json(impostor);
  metrics["guarantee"] = guarantee_name(impostor);
  metrics["gpu_bytes"] = gpu_bytes_json(set.pages);
  metrics["gpu_compression"] = gpu_compression_json(set.pages, thread_count(context.spec), context.budget);
  metrics["image"] = arguments.quality_views > 0 ? image_json(context, scene, impostor, glb) : json();
  folder.write("impostors.glb", glb);
  folder.write("metrics.json", metrics.dump(2));
  folder.commit();
  std::cout << metrics.dump(arguments.json ? 2 : -1) << "\n";
  return 0;
}

}  // namespace standin
