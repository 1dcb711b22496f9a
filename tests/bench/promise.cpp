// Does the promise hold, and can the check fail? Impostors over random view cells, judged by rays on the written file.
//
//     promise SCENE [impostors] [views of each] [layered|tdm] [strict|thesis|centre] [up: y|z|auto] [diagonals away, at least]
//
// Impostors are of random nodes of the object hierarchy, in shafts of 11.25, 22.5 or 45 degrees or
// boxes, 1 to 8 diagonals away, in any direction a viewer may stand. Views are stratified over the view cell (impostor_rays.h:
// corners, near border, sides, deep points), and every pixel in the objects' bounds is judged. "thesis" takes the layer set-up of thesis
// 3.3 as printed, "centre" samples texels at their centres: both are known to break the promise.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>

#include "render/base/error.h"
#include "render/base/rng.h"
#include "render/impostor/atlas.h"
#include "render/impostor/impostor_glb.h"
#include "render/impostor/technique.h"
#include "render/impostor/texture_pyramid.h"
#include "render/scene/hierarchy.h"
#include "render/scene/load.h"
#include "render/scene/object_bounds.h"
#include "server/verify/impostor_rays.h"

namespace standin {
namespace {

struct Arguments {
  std::string scene;
  std::uint32_t impostors = 20, views = 100;
  Technique technique = Technique::kLayered;
  BakeQuality quality;
  LoadOptions load;
  double nearest_diagonals = 1.0;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  const auto text = [&](int i) { return argc > i ? std::string(argv[i]) : std::string(); };
  arguments.scene = text(1);
  if (argc > 2) arguments.impostors = static_cast<std::uint32_t>(std::atoi(argv[2]));
  if (argc > 3) arguments.views = static_cast<std::uint32_t>(std::atoi(argv[3]));
  if (argc > 4) arguments.technique = technique_named(text(4)).value();
  arguments.quality.strict = text(5) != "thesis";
  arguments.quality.supercover = text(5) != "centre";
  arguments.quality.max_layers = 400;
  if (argc > 6) arguments.load.placing.up = text(6) == "z" ? UpAxis::kZ : text(6) == "y" ? UpAxis::kY : UpAxis::kAuto;
  if (argc > 7) arguments.nearest_diagonals = std::atof(argv[7]);
  return arguments;
}

Vec3 viewer_direction(Rng& rng) {
  const double azimuth = rng.uniform(0.0, 2.0 * M_PI), sine = rng.uniform(-0.1, 0.7), cosine = std::sqrt(1.0 - sine * sine);
  return {cosine * std::cos(azimuth), sine, cosine * std::sin(azimuth)};
}

ViewCell random_cell(const Box& bounds, double nearest_diagonals, Rng& rng) {
  const double diagonal_m = std::max(bounds.diagonal(), 1e-6);
  const double distance_m = diagonal_m * nearest_diagonals * std::pow(8.0, rng.uniform());
  const Vec3 direction = viewer_direction(rng);
  if (rng.below(3) == 0) {
    const Vec3 half = 0.5 * diagonal_m * Vec3(rng.uniform(0.02, 0.5), rng.uniform(0.0, 0.2), rng.uniform(0.02, 0.5));
    const Vec3 centre = bounds.centre() + distance_m * direction;
    return Box{centre - half, centre + half};
  }
  Shaft shaft = shaft_frame(bounds.centre(), direction);
  shaft.tan_half = Vec2(std::tan(0.5 * std::array{0.19634954, 0.39269908, 0.78539816}[rng.below(3)]));
  shaft.min_distance_m = distance_m;
  return shaft;
}

struct Sum {
  std::uint32_t impostors = 0, layers = 0, refused = 0;
  ImpostorJudgement judged;
};

class Bench {
 public:
  explicit Bench(const Arguments& arguments)
      : arguments_(arguments),
        scene_(load_scene(arguments.scene, arguments.load)),
        hierarchy_(build_hierarchy(scene_)),
        textures_(scene_) {}

  Sum run() {
    Sum sum;
    for (std::uint64_t attempt = 0; sum.impostors < arguments_.impostors && attempt < 20ULL * arguments_.impostors; ++attempt) {
      Rng rng(7, attempt);
      const HierarchyNode& node = random_node(rng);
      BakeRequest request{objects_of(hierarchy_, node), random_cell(node.bounds, arguments_.nearest_diagonals, rng)};
      try {
        add(bake_impostor(scene_, textures_, arguments_.technique, request, camera_, arguments_.quality), attempt, sum);
      } catch (const Failure& failure) {
        if (failure.word() != ErrorWord::kImpostorImpossible) throw;
        ++sum.refused;
      }
    }
    return sum;
  }

 private:
  /// Of about log-uniformly many objects.
  [[nodiscard]] const HierarchyNode& random_node(Rng& rng) const {
    const double wanted = std::pow(static_cast<double>(scene_.objects.size()), rng.uniform());
    const HierarchyNode* node = &hierarchy_.nodes[hierarchy_.leaf[rng.below(scene_.objects.size())]];
    while (node->parent >= 0 && node->count < wanted) node = &hierarchy_.nodes[static_cast<std::size_t>(node->parent)];
    return *node;
  }

  void add(const Impostor& impostor, std::uint64_t seed, Sum& sum) {
    if (impostor.empty()) return;
    const GlbQuads written = read_glb_quads(encode_impostor_glb(pack_atlas({impostor})));
    const JudgedImpostor judged{"imp_0",
                                impostor.objects,
                                impostor.layers,
                                impostor.frame.reference_viewpoint,
                                impostor.frame.forward,
                                impostor.view_cell,
                                camera_.pixel_angle_rad(),
                                impostor.technique,
                                impostor.frame.slope_step};
    const auto views = sample_cell_views(impostor.view_cell, bounds_of(scene_, impostor.objects), arguments_.views, seed);
    const ImpostorJudgement one = judge_impostor(scene_, written, judged, camera_, views, 2, {});
    if (one.gap_pixels > 0 || one.max_parallax_ratio > 1.0)
      std::fprintf(stderr, "  seed %llu: %zu objects, %zu layers, %llu gaps, ratio %.3f\n", static_cast<unsigned long long>(seed),
                   impostor.objects.size(), impostor.layers.size(), static_cast<unsigned long long>(one.gap_pixels),
                   one.max_parallax_ratio);
    ++sum.impostors;
    sum.layers += static_cast<std::uint32_t>(impostor.layers.size());
    sum.judged.add(one);
  }

  const Arguments& arguments_;
  Scene scene_;
  Hierarchy hierarchy_;
  TexturePyramids textures_;
  Camera camera_;
};

void print(const Arguments& arguments, const Sum& sum) {
  const auto share = [](std::uint64_t part, std::uint64_t whole) {
    return whole > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0.0;
  };
  std::printf(
      "| %s | %u | %.1f | %u | %llu | %llu | %.3f | %.1f %% | %.2f |\n", arguments.scene.substr(arguments.scene.rfind('/') + 1).c_str(),
      sum.impostors, static_cast<double>(sum.layers) / std::max(1U, sum.impostors), sum.judged.views,
      static_cast<unsigned long long>(sum.judged.pixels), static_cast<unsigned long long>(sum.judged.gap_pixels),
      sum.judged.max_parallax_ratio, share(sum.judged.baseless_pixels, sum.judged.shown_pixels), sum.judged.bloat_px().value_or(0.0));
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  try {
    const auto arguments = standin::parse(argc, argv);
    standin::print(arguments, standin::Bench(arguments).run());
  } catch (const standin::Failure& failure) {
    std::cerr << failure.what() << "\n";
    return 2;
  }
}
