// Quads against texels: what the grid cell of box growing trades (thesis table 3.1; grid_cells.md holds results).
//
//     grid_cells MODEL...      as model_argument.h says
//
// As in the thesis a model fills 677 texels on its longer side and has 6 layers: its view cell is a cube, three diagonals before it, whose
// side is searched until the plan has that many layers.
#include <algorithm>
#include <cstdio>
#include <iostream>

#include "render/base/error.h"
#include "render/impostor/atlas.h"
#include "render/impostor/recording.h"
#include "render/impostor/texture_pyramid.h"
#include "tests/bench/model_argument.h"

namespace standin {
namespace {

constexpr std::uint32_t kLongerSide = 677, kLayers = 6;
constexpr double kDiagonalsAway = 3.0;
const std::vector<std::uint32_t> kGrids{1, 2, 4, 8, 16, 32, 64, 128, 256, 700};

struct Setting {
  BakeRequest request;
  Camera camera;
  ImpostorPlan plan;
};

/// With a camera whose pixels give the longer side of the layers its number of texels.
Setting setting_for(const RequestPlanner& planner, const Scene& scene, double cell_side_m) {
  Setting setting{{all_objects(scene), cell_before(scene.bounds, cell_side_m, kDiagonalsAway * scene.bounds.diagonal())}, {}, {}};
  for (int i = 0; i < 8; ++i) {
    setting.plan = planner.plan(setting.request.view_cell, setting.camera, {});
    if (!setting.plan.possible) throw Failure(ErrorWord::kImpostorImpossible, setting.plan.why_not);
    const std::uint32_t longer = std::max(setting.plan.frame.width, setting.plan.frame.height);
    if (longer == kLongerSide) break;
    setting.camera.width = setting.camera.height = static_cast<int>(setting.camera.height * double{kLongerSide} / longer + 0.5);
  }
  return setting;
}

Setting six_layers(const Scene& scene) {
  const RequestPlanner planner(scene, {all_objects(scene), Box{}});
  double low_m = 0.0, high_m = scene.bounds.diagonal();
  for (int i = 0; i < 40; ++i) {
    const double side_m = 0.5 * (low_m + high_m);
    const Setting setting = setting_for(planner, scene, side_m);
    if (setting.plan.layers.size() == kLayers) return setting;
    (setting.plan.layers.size() < kLayers ? low_m : high_m) = side_m;
  }
  throw Failure(ErrorWord::kImpostorImpossible, "no view cell gives 6 layers");
}

double transparent_share(const Impostor& impostor) {
  std::uint64_t transparent = 0;
  for (std::size_t i = 3; i < impostor.texels.size(); i += 4) transparent += impostor.texels[i] == 0 ? 1 : 0;
  return static_cast<double>(transparent) / static_cast<double>(std::max<std::uint64_t>(1, impostor.texel_count()));
}

void print_rows(const std::string& model) {
  const Scene scene = load_model(model);
  const TexturePyramids textures(scene);
  const Setting setting = six_layers(scene);
  const ImpostorFrame& frame = setting.plan.frame;
  const auto triangles = static_cast<unsigned long long>(scene.triangle_count());
  std::printf("\n%s: %llu triangles, %u x %u texels, %zu layers; whole layers would take %.0f kB\n\n", model_name(model).c_str(), triangles,
              frame.width, frame.height, setting.plan.layers.size(), 4.0 * frame.width * frame.height * kLayers / 1024.0);
  std::printf("| grid cell, texels | quads | geometry kB | texture kB | overall kB | transparent texels |\n|---|---|---|---|---|---|\n");
  for (const std::uint32_t grid : kGrids) {
    BakeQuality quality;
    quality.grid_texels = grid;
    const Impostor impostor = bake_layered(scene, textures, setting.request, setting.camera, quality);
    const double geometry_kb = static_cast<double>(geometry_bytes(impostor)) / 1024.0;
    const double texture_kb = static_cast<double>(texture_bytes(impostor)) / 1024.0;
    std::printf("| %u | %zu | %.1f | %.0f | %.0f | %.0f %% |\n", grid, impostor.quads.size(), geometry_kb, texture_kb,
                geometry_kb + texture_kb, 100.0 * transparent_share(impostor));
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  try {
    for (int i = 1; i < argc; ++i) standin::print_rows(argv[i]);
  } catch (const standin::Failure& failure) {
    std::cerr << failure.what() << "\n";
    return 2;
  }
}
