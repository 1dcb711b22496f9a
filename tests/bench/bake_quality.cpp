// Error against memory and time of one bake: texel size and parallax limit over a grid (bake_quality.md holds results).
//
//     bake_quality MODEL DX,DY,DZ,APEX_DEG,MIN_DISTANCE [--views 12] [--repeats 5] [--figure FILE.json]      MODEL: as model_argument.h
//     says
//
// The whole model for one shaft, as `standin bake` does it. Seconds are medians of bake_layered alone, the settings taking turns. Errors
// are over covered pixels of views all over the view cell, from the written file.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <glm/trigonometric.hpp>
#include <iostream>

#include "render/base/error.h"
#include "render/impostor/atlas.h"
#include "render/impostor/bake.h"
#include "render/impostor/impostor_glb.h"
#include "render/impostor/texture_pyramid.h"
#include "server/verify/impostor_quality.h"
#include "tests/bench/figure.h"
#include "tests/bench/model_argument.h"

namespace standin {
namespace {

constexpr std::array kTexelScales{0.5, 1.0, 2.0};
constexpr std::array kAlphaScales{0.5, 1.0, 2.0, 4.0};

struct Arguments {
  std::string model, shaft, figure;
  std::uint32_t views = 12;
  int repeats = 5;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  std::vector<std::string> positional;
  for (int i = 1; i < argc; ++i) {
    const std::string flag = argv[i];
    if (!flag.starts_with("--")) {
      positional.push_back(flag);
      continue;
    }
    if (i + 1 == argc) throw Failure(ErrorWord::kBadUsage, flag + " needs a value");
    const std::string value = argv[++i];
    if (flag == "--views") arguments.views = static_cast<std::uint32_t>(std::stoul(value));
    if (flag == "--repeats") arguments.repeats = std::stoi(value);
    if (flag == "--figure") arguments.figure = value;
  }
  if (positional.size() != 2) throw Failure(ErrorWord::kBadUsage, "bake_quality MODEL DX,DY,DZ,APEX_DEG,MIN_DISTANCE");
  arguments.model = positional[0];
  arguments.shaft = positional[1];
  return arguments;
}

Shaft shaft_towards(const Vec3& apex, const std::string& text) {
  Vec3 direction(0.0);
  double apex_deg = 0.0, min_distance_m = 0.0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf,%lf", &direction.x, &direction.y, &direction.z, &apex_deg, &min_distance_m) != 5)
    throw Failure(ErrorWord::kBadUsage, text + " is not DX,DY,DZ,APEX_DEG,MIN_DISTANCE");
  Shaft shaft = shaft_frame(apex, glm::normalize(direction));
  shaft.tan_half = Vec2(std::tan(glm::radians(apex_deg) / 2.0));
  shaft.min_distance_m = min_distance_m;
  return shaft;
}

struct Setting {
  BakeQuality quality;
  std::vector<double> processor_s;
  Impostor impostor;
  ImpostorQuality judged;

  [[nodiscard]] double kilobytes() const { return static_cast<double>(texture_bytes(impostor)) / 1000.0; }
  [[nodiscard]] double median_ms() const {
    std::vector<double> sorted = processor_s;
    std::ranges::sort(sorted);
    return 1000.0 * sorted[sorted.size() / 2];
  }
};

std::vector<Setting> grid() {
  std::vector<Setting> settings;
  for (const double texel_scale : kTexelScales)
    for (const double alpha_scale : kAlphaScales)
      settings.push_back({{.alpha_scale = alpha_scale, .texel_scale = texel_scale}, {}, {}, {}});
  return settings;
}

void bake(const Scene& scene, const BakeRequest& request, const Camera& camera, Setting& setting, const TexturePyramids& textures) {
  const std::clock_t start = std::clock();
  setting.impostor = bake_layered(scene, textures, request, camera, setting.quality);
  setting.processor_s.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
}

void judge(const Scene& scene, const Camera& camera, std::uint32_t views, Setting& setting) {
  const std::string glb = encode_impostor_glb(pack_atlas({setting.impostor}));
  const double alpha_rad = setting.quality.alpha_scale * camera.pixel_angle_rad();
  setting.judged = judge_quality(scene, setting.impostor, glb, camera, alpha_rad, {.views = views}, {});
}

void print(const std::vector<Setting>& settings) {
  std::printf(
      "| texel scale | alpha scale | layers | quads | texture kB | bake, ms | mean error | FLIP | gap pixels | worst ratio |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Setting& s : settings) {
    const CoveredError error = s.judged.over_views.value();
    const ImpostorJudgement& nearest = s.judged.by_sampling.front();
    std::printf("| %g | %g | %zu | %zu | %.0f | %.0f | %.4f | %.3f | %llu | %.2f |\n", s.quality.texel_scale, s.quality.alpha_scale,
                s.impostor.layers.size(), s.impostor.quads.size(), s.kilobytes(), s.median_ms(), error.mean_error, error.mean_flip,
                static_cast<unsigned long long>(nearest.gap_pixels), nearest.max_parallax_ratio);
  }
}

struct Quantity {
  FigureAxis axis;
  double (*of)(const Setting&);
};

/// A series for each texel scale, whose points are the parallax limits.
FigurePanel panel(const std::string& title, const Quantity& x, const Quantity& y, const std::vector<Setting>& settings, bool joined) {
  FigurePanel result{title, x.axis, y.axis, {}};
  for (const double texel_scale : kTexelScales) {
    char name[32];
    std::snprintf(name, sizeof name, "texel scale %g", texel_scale);
    result.series.push_back({name, {}, joined});
    for (const Setting& s : settings)
      if (s.quality.texel_scale == texel_scale) result.series.back().points.push_back({x.of(s), y.of(s)});
  }
  return result;
}

std::vector<FigurePanel> panels(const std::vector<Setting>& settings) {
  const Quantity alpha{{"parallax limit, centre pixels", true, false, {kAlphaScales.begin(), kAlphaScales.end()}},
                       [](const Setting& s) { return s.quality.alpha_scale; }};
  const Quantity memory{{"texture, kB", true, false, {30, 100, 300, 1000}}, [](const Setting& s) { return s.kilobytes(); }};
  const Quantity time{{"bake, ms", false, true, {}}, [](const Setting& s) { return s.median_ms(); }};
  const Quantity error{{"FLIP", false, false, {}}, [](const Setting& s) { return s.judged.over_views.value().mean_flip; }};
  return {panel("Memory", alpha, memory, settings, true), panel("Bake time", alpha, time, settings, true),
          panel("Image error", alpha, error, settings, true), panel("Error against bake time", time, error, settings, false),
          panel("Error against memory", memory, error, settings, false)};
}

void run(const Arguments& arguments) {
  const Scene scene = load_model(arguments.model);
  const TexturePyramids textures(scene);
  const Camera camera;
  const BakeRequest request{all_objects(scene), shaft_towards(scene.bounds.centre(), arguments.shaft)};
  std::vector<Setting> settings = grid();
  for (int turn = 0; turn < arguments.repeats; ++turn)
    for (Setting& setting : settings) bake(scene, request, camera, setting, textures);
  for (Setting& setting : settings) judge(scene, camera, arguments.views, setting);
  print(settings);
  if (!arguments.figure.empty())
    write_figure(arguments.figure, "One layered impostor of " + model_name(arguments.model) + ": texel size and parallax limit", 3,
                 panels(settings));
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  try {
    standin::run(standin::parse(argc, argv));
  } catch (const standin::Failure& failure) {
    std::cerr << failure.what() << "\n";
    return 2;
  }
}
