// Textured depth meshes against layered impostors, after thesis table 4.1 (depth_mesh_table.md holds results).
//
//     depth_mesh_table SCENE [--enlargement 1.4] [--ring 2] [--margin 0.5] [--alpha 1] [--scale 1] [--distances 90,110,...]
//
// The whole scene as one impostor, for a cubic view cell of 100 m before it in +z, at several distances.
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <numeric>
#include <sstream>
#include <string>

#include "render/base/error.h"
#include "render/impostor/atlas.h"
#include "render/impostor/bake_depth_mesh.h"
#include "render/impostor/texture_pyramid.h"
#include "render/scene/load.h"

namespace standin {
namespace {

struct Arguments {
  std::string scene;
  BakeQuality quality;
  DepthMeshQuality mesh;
  double scale = 1.0;  // of the scene about its origin
  std::vector<double> distances_m{90, 110, 140, 180, 250, 500, 1000};
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string flag = argv[i];
    if (!flag.starts_with("--")) {
      arguments.scene = flag;
      continue;
    }
    if (i + 1 == argc) throw Failure(ErrorWord::kBadUsage, flag + " needs a value");
    const std::string value = argv[++i];
    if (flag == "--enlargement") arguments.mesh.enlargement = std::stod(value);
    if (flag == "--margin") arguments.mesh.margin = std::stod(value);
    if (flag == "--ring") arguments.mesh.ring = std::stoi(value);
    if (flag == "--alpha") arguments.quality.alpha_scale = std::stod(value);
    if (flag == "--scale") arguments.scale = std::stod(value);
    if (flag == "--distances") {
      arguments.distances_m.clear();
      std::istringstream list(value);
      for (std::string item; std::getline(list, item, ',');) arguments.distances_m.push_back(std::stod(item));
    }
  }
  return arguments;
}

std::uint64_t bytes_with_gutters(const TexturedMesh& mesh) {
  std::uint64_t texels = 0;
  for (const Chart& chart : mesh.charts) texels += std::uint64_t{chart.width + 2} * (chart.height + 2);
  return 4 * texels;
}

void print_row(const Scene& scene, const TexturePyramids& textures, const Arguments& arguments, double distance_m) {
  const Vec3 centre = scene.bounds.centre();
  const double near_z = scene.bounds.max.z + distance_m;
  BakeRequest request;
  request.objects.resize(scene.objects.size());
  std::iota(request.objects.begin(), request.objects.end(), 0U);
  request.view_cell = Box{{centre.x - 50.0, scene.bounds.min.y, near_z}, {centre.x + 50.0, scene.bounds.min.y + 100.0, near_z + 100.0}};
  const Camera camera;
  const DepthMeshImpostor tdm = bake_depth_mesh(scene, textures, request, camera, arguments.quality, arguments.mesh);
  const Impostor layered = bake_layered(scene, textures, request, camera, {});
  const DepthMeshSummary& s = tdm.summary;
  std::printf("| %4.0f | %3u | %4u | %6llu | %5llu | %4zu | %6.1f | %6.1f | %5.2f %5.2f %5.2f %5.2f | %zu | %5zu | %6.1f |\n", distance_m,
              s.layers, s.meshes, static_cast<unsigned long long>(s.initial_polygons), static_cast<unsigned long long>(s.triangles),
              tdm.mesh.charts.size(), static_cast<double>(bytes_with_gutters(tdm.mesh)) / 1024.0,
              static_cast<double>(20 * tdm.mesh.vertices.size() + 4 * tdm.mesh.indices.size()) / 1024.0, s.record_s, s.mesh_s, s.simplify_s,
              s.texture_s, layered.layers.size(), layered.quads.size(), static_cast<double>(texture_bytes(layered)) / 1024.0);
  std::fflush(stdout);
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  try {
    const auto arguments = standin::parse(argc, argv);
    standin::Scene scene = standin::load_scene(arguments.scene);
    for (standin::Object& object : scene.objects)
      object.world_from_object = glm::dmat4(glm::dmat3(arguments.scale)) * object.world_from_object;
    update_derived(scene);
    const standin::TexturePyramids textures(scene);
    const auto size = scene.bounds.size();
    std::printf("%zu objects, %llu triangles, %.1f x %.1f x %.1f m\n", scene.objects.size(),
                static_cast<unsigned long long>(scene.triangle_count()), size.x, size.y, size.z);
    std::printf(
        "| m | layers | meshes | initial polygons | triangles | charts | texture kB | geometry kB | record mesh simplify texture, s |"
        " layers | layered quads | texture kB |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const double distance_m : arguments.distances_m) standin::print_row(scene, textures, arguments, distance_m);
  } catch (const standin::Failure& failure) {
    std::cerr << failure.what() << "\n";
    return 2;
  }
}
