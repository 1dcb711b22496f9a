// Textured depth meshes against layered impostors, after thesis tables 4.1 and 4.2 (depth_mesh_table.md holds results).
//
//     depth_mesh_table MODEL [--enlargement 1.4] [--ring 2] [--margin 0.5] [--alpha 1] [--cell 100] [--distances 90,110,...]
//
// The whole model (model_argument.h) as one impostor, for a cubic view cell before it in +z, at several distances. Whole bakes in
// seconds of the processor, the mesh's steps in shares of the sum of their times.
#include <cstdio>
#include <ctime>
#include <functional>
#include <iostream>
#include <sstream>
#include <string>

#include "render/base/error.h"
#include "render/impostor/atlas.h"
#include "render/impostor/bake_depth_mesh.h"
#include "render/impostor/texture_pyramid.h"
#include "tests/bench/model_argument.h"

namespace standin {
namespace {

struct Arguments {
  std::string model;
  BakeQuality quality;
  DepthMeshQuality mesh;
  double cell_m = 100.0;
  std::vector<double> distances_m{90, 110, 140, 180, 250, 500, 1000};
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string flag = argv[i];
    if (!flag.starts_with("--")) {
      arguments.model = flag;
      continue;
    }
    if (i + 1 == argc) throw Failure(ErrorWord::kBadUsage, flag + " needs a value");
    const std::string value = argv[++i];
    if (flag == "--enlargement") arguments.mesh.enlargement = std::stod(value);
    if (flag == "--margin") arguments.mesh.margin = std::stod(value);
    if (flag == "--ring") arguments.mesh.ring = std::stoi(value);
    if (flag == "--alpha") arguments.quality.alpha_scale = std::stod(value);
    if (flag == "--cell") arguments.cell_m = std::stod(value);
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

double processor_seconds(const std::function<void()>& step) {
  const std::clock_t start = std::clock();
  step();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

double kilobytes(std::uint64_t bytes) {
  return static_cast<double>(bytes) / 1024.0;
}

void print_row(const Scene& scene, const TexturePyramids& textures, const Arguments& arguments, double distance_m) {
  const BakeRequest request{all_objects(scene), cell_before(scene.bounds, arguments.cell_m, distance_m)};
  const Camera camera;
  DepthMeshImpostor tdm;
  Impostor layered;
  BakeQuality quality = arguments.quality;
  quality.max_layers = 1000;
  const double tdm_s = processor_seconds([&] { tdm = bake_depth_mesh(scene, textures, request, camera, quality, arguments.mesh); });
  const double layered_s = processor_seconds([&] { layered = bake_layered(scene, textures, request, camera, {.max_layers = 1000}); });
  const DepthMeshSummary& s = tdm.summary;
  const double steps_s = s.record_s + s.mesh_s + s.simplify_s + s.texture_s;
  const auto percent = [&](double step_s) { return steps_s > 0.0 ? 100.0 * step_s / steps_s : 0.0; };
  std::printf("| %.0f | %u | %u | %llu | %llu | %zu | %.1f | %.1f | %.3f | %.0f %.0f %.0f %.0f | %zu | %.1f | %.4f |\n", distance_m,
              s.layers, s.meshes, static_cast<unsigned long long>(s.initial_polygons), static_cast<unsigned long long>(s.triangles),
              tdm.mesh.charts.size(), kilobytes(bytes_with_gutters(tdm.mesh)),
              kilobytes(20 * tdm.mesh.vertices.size() + 4 * tdm.mesh.indices.size()), tdm_s, percent(s.record_s), percent(s.mesh_s),
              percent(s.simplify_s), percent(s.texture_s), layered.quads.size(), kilobytes(texture_bytes(layered)), layered_s);
  std::fflush(stdout);
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  try {
    const auto arguments = standin::parse(argc, argv);
    const standin::Scene scene = standin::load_model(arguments.model);
    const standin::TexturePyramids textures(scene);
    const auto size = scene.bounds.size();
    std::printf("%zu objects, %llu triangles, %.1f x %.1f x %.1f m\n\n", scene.objects.size(),
                static_cast<unsigned long long>(scene.triangle_count()), size.x, size.y, size.z);
    std::printf(
        "| m | layers | meshes | initial polygons | triangles | charts | texture kB | geometry kB | processor s | record, mesh, simplify, "
        "texture, %% | layered quads | layered kB | layered, processor s |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const double distance_m : arguments.distances_m) standin::print_row(scene, textures, arguments, distance_m);
  } catch (const standin::Failure& failure) {
    std::cerr << failure.what() << "\n";
    return 2;
  }
}
