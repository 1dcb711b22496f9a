// How much a leafy tree grows in its impostor, with its outlines and without (fuzzy.md holds results; thesis 3.7.1, figure 3.19).
//
//     fuzzy [TREES]
//
// Trees of the built-in city, seen in shafts of 45 degrees from 15 m to 120 m. Growth is the number of columns of texels (all layers seen
// from the reference viewpoint) that show something, over the rays through texel centres that hit the tree. Gap share is that of the pixels
// which the tree covers with all pixels around them.
#include <cstdio>
#include <cstdlib>

#include "render/image/image_io.h"
#include "render/impostor/atlas.h"
#include "render/impostor/bake.h"
#include "render/impostor/impostor_glb.h"
#include "render/scene/city.h"
#include "render/visibility/raytracer.h"
#include "server/verify/impostor_rays.h"

namespace standin {
namespace {

ViewCell shaft_over(const Box& tree, double distance_m) {
  Shaft shaft = shaft_frame(tree.centre(), glm::normalize(Vec3(1.0, 0.1, 0.35)));
  shaft.tan_half = Vec2(std::tan(0.125 * 3.141592653589793));
  shaft.min_distance_m = distance_m;
  return shaft;
}

std::vector<bool> columns_of(const Impostor& impostor) {
  std::vector<bool> shown(std::size_t{impostor.frame.width} * impostor.frame.height, false);
  std::size_t next = 0;
  for (const Quad& quad : impostor.quads)
    for (std::uint32_t y = quad.y; y < quad.y + quad.height; ++y)
      for (std::uint32_t x = quad.x; x < quad.x + quad.width; ++x, next += 4)
        if (impostor.texels[next + 3] != 0) shown[std::size_t{y} * impostor.frame.width + x] = true;
  return shown;
}

std::uint64_t hit_columns(const Raytracer& rays, const ImpostorFrame& frame) {
  std::uint64_t hits = 0;
  for (std::uint32_t y = 0; y < frame.height; ++y)
    for (std::uint32_t x = 0; x < frame.width; ++x) {
      const Vec3 direction = glm::normalize(layer_point(frame, 1.0, x + 0.5, y + 0.5) - frame.reference_viewpoint);
      hits += rays.nearest(frame.reference_viewpoint, direction) ? 1 : 0;
    }
  return hits;
}

struct Sums {
  double layers = 0.0, texture_bytes = 0.0, quads = 0.0, shown = 0.0, hit = 0.0;
  ImpostorJudgement judgement;
};

void measure(const Scene& scene, std::uint32_t tree, double distance_m, bool fuzzy, Sums& sums) {
  const Camera camera;
  const ViewCell cell = shaft_over(scene.objects[tree].bounds, distance_m);
  Impostor impostor = bake_layered(scene, {{tree}, cell}, camera, {.max_layers = 400, .fuzzy = fuzzy});
  sums.layers += static_cast<double>(impostor.layers.size());
  sums.quads += static_cast<double>(impostor.quads.size());
  sums.texture_bytes += static_cast<double>(texture_bytes(impostor));
  for (const bool shown : columns_of(impostor)) sums.shown += shown ? 1.0 : 0.0;
  sums.hit += static_cast<double>(hit_columns(Raytracer(scene, {tree}, {}), impostor.frame));

  const JudgedImpostor judged{
      "imp_0", {tree}, impostor.layers, impostor.frame.reference_viewpoint, impostor.frame.forward, cell, camera.pixel_angle_rad()};
  std::vector<Impostor> impostors;
  impostors.push_back(std::move(impostor));
  const GlbQuads glb = read_glb_quads(encode_impostor_glb(pack_atlas(std::move(impostors))));
  const auto views = sample_cell_views(cell, scene.objects[tree].bounds, 8, 1);
  const ImpostorJudgement found = judge_impostor(scene, glb, judged, camera, views, 1, {});
  sums.judgement.pixels += found.pixels;
  sums.judgement.gap_pixels += found.gap_pixels;
}

void print(double distance_m, bool fuzzy, const Sums& sums, double trees) {
  const auto pixels = static_cast<double>(sums.judgement.pixels), gaps = static_cast<double>(sums.judgement.gap_pixels);
  std::printf("| %.0f m | %s | %.1f | %.0f | %.0f | %.2f | %.2f %% of %.0f |\n", distance_m, fuzzy ? "fuzzy" : "strict",
              sums.layers / trees, sums.texture_bytes / trees / 1e3, sums.quads / trees, sums.shown / sums.hit,
              pixels > 0.0 ? 100.0 * gaps / pixels : 0.0, pixels);
}

int run(std::size_t count) {
  const Scene scene = make_city({.objects = 240, .triangles = 1'200'000, .seed = 1});
  std::vector<std::uint32_t> trees;
  for (std::uint32_t id = 0; id < scene.objects.size() && trees.size() < count; ++id)
    if (scene.objects[id].name.starts_with("tree")) trees.push_back(id);
  std::puts("| from | outlines | layers | texture kB | quads | growth | gap share |\n|---|---|---|---|---|---|---|");
  for (const double distance_m : {15.0, 30.0, 60.0, 120.0})
    for (const bool fuzzy : {false, true}) {
      Sums sums;
      for (const std::uint32_t tree : trees) measure(scene, tree, distance_m, fuzzy, sums);
      print(distance_m, fuzzy, sums, static_cast<double>(trees.size()));
    }
  return trees.empty() ? 1 : 0;
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  return standin::run(argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 4);
}
