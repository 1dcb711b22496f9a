// What geometric levels of detail save, by distance, and how good their error bounds are for the time they take (lods.md holds results).
//
//     lods SCENE.glb... [--error-px 1] [--split-triangles 100000] [--texture-folder DIR] [--saved-only]
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "render/base/error.h"
#include "render/scene/load.h"
#include "render/scene/object_levels.h"
#include "render/scene/simplify_mesh.h"
#include "render/scene/textured_surface.h"
#include "render/view/camera.h"
#include "render/view/level_camera.h"

namespace {

using namespace standin;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The mean over all objects, as if each was seen from so far.
void print_saved(const Scene& scene) {
  std::printf("| distance in m | triangles drawn | share |\n|---|---|---|\n");
  for (double distance_m = 2.5; distance_m <= 640.0; distance_m *= 2.0) {
    std::uint64_t drawn = 0;
    for (const Object& object : scene.objects) drawn += parts_of(object, level_at(object, distance_m)).triangle_count;
    std::printf("| %g | %llu | %.3f |\n", distance_m, static_cast<unsigned long long>(drawn),
                static_cast<double>(drawn) / static_cast<double>(scene.triangle_count()));
  }
}

// By kind of object: the letters of its name before the first digit or #.
void print_kinds(const Scene& scene) {
  std::map<std::string, std::vector<const Object*>> kinds;
  for (const Object& object : scene.objects) kinds[object.name.substr(0, object.name.find_first_of("_0123456789#["))].push_back(&object);
  std::printf("| kind | objects | triangles | share drawn at 10 m | 20 m | 40 m | 80 m | 160 m |\n|---|---|---|---|---|---|---|---|\n");
  for (const auto& [name, objects] : kinds) {
    double all = 0.0;
    for (const Object* object : objects) all += static_cast<double>(object->triangle_count);
    std::printf("| %s | %zu | %.0f |", name.c_str(), objects.size(), all);
    for (const double distance_m : {10.0, 20.0, 40.0, 80.0, 160.0}) {
      double drawn = 0.0;
      for (const Object* object : objects) drawn += static_cast<double>(parts_of(*object, level_at(*object, distance_m)).triangle_count);
      std::printf(" %.3f |", drawn / all);
    }
    std::printf("\n");
  }
}

// Errors below this share of a mesh's diagonal are none.
constexpr double kNothing = 1e-4;

// Bound over what was found, by the work that a triangle may take.
void print_bounds(const Scene& scene, std::size_t mesh_count) {
  const std::vector<bool> textured = worn_with_texture(scene);
  std::printf("| pieces per triangle, at most | seconds | pieces | bound / found: median | 90 %% | most |\n|---|---|---|---|---|---|\n");
  for (const double work : {0.0, 1.0, 5.0, 20.0, 100.0}) {
    SimplifyOptions options;
    options.pieces_per_triangle = work;
    std::vector<double> ratios;
    std::uint64_t pieces = 0;
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t m = 0; m < mesh_count; ++m) {
      options.textured = textured[m];
      for (const SimplifiedMesh& level : simplified(scene.meshes[m], options)) {
        pieces += level.pieces;
        ratios.push_back(level.error_m / std::max(level.error_found_m, kNothing * scene.meshes[m].bounds.diagonal()));
      }
    }
    const double seconds = seconds_since(start);
    std::sort(ratios.begin(), ratios.end());
    const auto at = [&](double share) { return ratios.empty() ? 0.0 : ratios[static_cast<std::size_t>(share * (ratios.size() - 1))]; };
    std::printf("| %g | %.2f | %llu | %.3f | %.3f | %.3f |\n", work, seconds, static_cast<unsigned long long>(pieces), at(0.5), at(0.9),
                at(1.0));
  }
}

int run(const std::vector<std::string>& arguments) {
  double error_px = 1.0;
  bool with_bounds = true;
  LoadOptions load;
  std::vector<std::string> files;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--error-px")
      error_px = std::stod(arguments[++i]);
    else if (arguments[i] == "--split-triangles")
      load.split_triangles = std::stoull(arguments[++i]);
    else if (arguments[i] == "--texture-folder")
      load.texture_folders.emplace_back(arguments[++i]);
    else if (arguments[i] == "--saved-only")
      with_bounds = false;
    else
      files.push_back(arguments[i]);
  }
  for (const std::string& file : files) {
    Scene scene = load_scene(file, load);
    const std::size_t mesh_count = scene.meshes.size();
    const auto start = std::chrono::steady_clock::now();
    const LevelSummary summary =
        add_object_levels(scene, {error_m_per_m(Camera(), error_px), whole_image_distance(Camera()), 1}, WorkBudget());
    std::printf("\n%s: %zu objects, %llu triangles; %u with levels, %zu meshes more, %.2f s on one processor\n\n", scene.name.c_str(),
                scene.objects.size(), static_cast<unsigned long long>(scene.triangle_count()), summary.objects,
                scene.meshes.size() - mesh_count, seconds_since(start));
    print_saved(scene);
    std::printf("\n");
    print_kinds(scene);
    if (!with_bounds) continue;
    std::printf("\n");
    print_bounds(scene, mesh_count);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const standin::Failure& failure) {
    std::cerr << failure.what() << "\n";
    return 1;
  }
}
