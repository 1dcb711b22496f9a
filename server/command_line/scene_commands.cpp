// make-city and info.
#include <algorithm>
#include <cstdio>
#include <iostream>

#include "render/base/error.h"
#include "render/scene/city.h"
#include "render/scene/load.h"
#include "render/scene/real_city.h"
#include "server/command_line/commands.h"
#include "server/job/world.h"

namespace standin {
namespace {

using nlohmann::json;

const char* note_kind(LoadNote::Kind kind) {
  switch (kind) {
    case LoadNote::Kind::kRepaired:
      return "repaired";
    case LoadNote::Kind::kDropped:
      return "dropped";
    case LoadNote::Kind::kChosen:
      return "chosen";
    case LoadNote::Kind::kWarning:
      break;
  }
  return "warning";
}

json notes_json(const Scene& scene) {
  json notes = json::array();
  for (const auto& note : scene.notes)
    notes.push_back({{"kind", note_kind(note.kind)}, {"what", note.what}, {"count", note.count}, {"why", note.why}});
  return notes;
}

std::uint64_t texture_bytes_of(const Scene& scene) {
  std::uint64_t bytes = 0;
  for (const auto& texture : scene.textures) bytes += texture.rgba.size();
  return bytes;
}

json info_json(const Scene& scene) {
  std::string why;
  const bool orbit = default_view_space(scene, why) == ViewSpaceKind::kOrbit;
  const Vec3 size = scene.bounds.size();
  return {{"name", scene.name},
          {"sha256", scene.sha256},
          {"objects", scene.objects.size()},
          {"triangles", scene.triangle_count()},
          {"meshes", scene.meshes.size()},
          {"draws", scene.parts.size()},
          {"materials", scene.materials.size()},
          {"textures", {{"count", scene.textures.size()}, {"rgba8_bytes", texture_bytes_of(scene)}}},
          {"bounds_m", {{"min", {scene.bounds.min.x, scene.bounds.min.y, scene.bounds.min.z}}, {"size", {size.x, size.y, size.z}}}},
          {"default_view_space", {{"kind", orbit ? "orbit" : "walk"}, {"why", why}}},
          {"notes", notes_json(scene)}};
}

void print_info(const json& info) {
  const auto& size = info["bounds_m"]["size"];
  std::printf("%s\n  %s objects, %s triangles drawn, %s meshes, %s materials, %s textures\n", info["name"].get<std::string>().c_str(),
              info["objects"].dump().c_str(), info["triangles"].dump().c_str(), info["meshes"].dump().c_str(),
              info["materials"].dump().c_str(), info["textures"]["count"].dump().c_str());
  std::printf("  %.4g x %.4g x %.4g m, y up\n", size[0].get<double>(), size[1].get<double>(), size[2].get<double>());
  std::printf("  view space: %s (%s)\n", info["default_view_space"]["kind"].get<std::string>().c_str(),
              info["default_view_space"]["why"].get<std::string>().c_str());
  for (const auto& note : info["notes"])
    std::printf("  %s: %s (%s): %s\n", note["kind"].get<std::string>().c_str(), note["what"].get<std::string>().c_str(),
                note["count"].dump().c_str(), note["why"].get<std::string>().c_str());
}

}  // namespace

int make_city_command(const CommandContext& context) {
  const auto& arguments = context.arguments;
  const Scene city =
      arguments.osm.empty()
          ? make_city({arguments.city_objects, arguments.city_triangles, context.spec.seed})
          : make_real_city({arguments.osm, arguments.furniture, arguments.city_objects, arguments.city_triangles, context.spec.seed});
  write_scene_glb(city, arguments.output);
  std::printf("%s: %zu objects, %llu triangles drawn\n", arguments.output.c_str(), city.objects.size(),
              static_cast<unsigned long long>(city.triangle_count()));
  return 0;
}

int info_command(const CommandContext& context) {
  const Scene scene = load_scene(context.arguments.scenes.front(), load_options(context.spec));
  const json info = info_json(scene);
  if (context.arguments.json)
    std::cout << info.dump(2) << "\n";
  else
    print_info(info);
  return 0;
}

}  // namespace standin
