// How many layers an impostor needs, by distance, resolution and size of the view cell (thesis Fig. 3.10, 3.11; layer_counts.md holds
// results).
//
//     layer_counts [--figure FILE.json] MODEL...      MODEL: as model_argument.h says
//
// The whole model as one impostor for a cubic view cell before it. Counted by the plan for the model's vertices, as bakes use it.
#include <cstdio>
#include <iostream>
#include <map>

#include "render/base/error.h"
#include "render/impostor/recording.h"
#include "tests/bench/figure.h"
#include "tests/bench/model_argument.h"

namespace standin {
namespace {

constexpr double kCellSide_m = 10.0;
const std::vector<double> kDistances_m{42, 59, 96, 142, 209, 563};
const std::map<double, int> kThesisLayers{{42, 120}, {59, 60}, {96, 30}, {142, 15}, {209, 7}, {563, 1}};  // Fig. 3.10: a dragon of 20 m
const std::vector<int> kResolutions{256, 512, 1024};
const std::vector<double> kCellSides_m{2.5, 5, 10, 20, 40};
const std::vector<double> kFixedDistances_m{59, 142, 563};

class LayerCounter {
 public:
  explicit LayerCounter(const Scene& scene) : bounds_(scene.bounds), planner_(scene, {all_objects(scene), Box{}}) {}

  [[nodiscard]] std::size_t layers(double distance_m, double side_m, int resolution) const {
    Camera camera;
    camera.width = camera.height = resolution;
    BakeQuality quality;
    quality.max_layers = 10000;
    quality.max_resolution = 1U << 20U;  // counting needs no memory
    const ImpostorPlan plan = planner_.plan(cell_before(bounds_, side_m, distance_m), camera, quality);
    if (!plan.possible) throw Failure(ErrorWord::kImpostorImpossible, plan.why_not);
    return plan.layers.size();
  }

 private:
  Box bounds_;
  RequestPlanner planner_;
};

FigurePanel by_distance(const std::string& model, const LayerCounter& counter, bool with_thesis) {
  FigurePanel panel{
      model + ", cell of 10 m", {"distance, m", true, false, kDistances_m}, {"layers", true, false, {1, 3, 10, 30, 100, 300}}, {}};
  for (const int resolution : kResolutions) {
    FigureSeries series{std::to_string(resolution) + " pixels", {}};
    for (const double d : kDistances_m) series.points.push_back({d, static_cast<double>(counter.layers(d, kCellSide_m, resolution))});
    panel.series.push_back(std::move(series));
  }
  if (!with_thesis) return panel;
  FigureSeries thesis{"thesis' dragon", {}};
  for (const auto& [distance_m, layers] : kThesisLayers) thesis.points.push_back({distance_m, static_cast<double>(layers)});
  panel.series.push_back(std::move(thesis));
  return panel;
}

FigurePanel by_cell_side(const std::string& model, const LayerCounter& counter) {
  FigurePanel panel{
      model + ", 512 pixels", {"side of the view cell, m", false, true, {0, 10, 20, 30, 40}}, {"layers", false, true, {}}, {}};
  for (const double d : kFixedDistances_m) {
    FigureSeries series{"from " + std::to_string(static_cast<int>(d)) + " m", {}};
    for (const double side_m : kCellSides_m) series.points.push_back({side_m, static_cast<double>(counter.layers(d, side_m, 512))});
    panel.series.push_back(std::move(series));
  }
  return panel;
}

void print_table(const FigurePanel& panel) {
  std::printf("\n%s:\n\n| %s |", panel.title.c_str(), panel.x.label.c_str());
  for (const auto& point : panel.series.front().points) std::printf(" %g |", point[0]);
  std::printf("\n|---|");
  for (std::size_t i = 0; i < panel.series.front().points.size(); ++i) std::printf("---|");
  for (const FigureSeries& series : panel.series) {
    std::printf("\n| %s |", series.name.c_str());
    for (const auto& point : series.points) std::printf(" %g |", point[1]);
  }
  std::printf("\n");
}

std::vector<FigurePanel> panels_of(const std::vector<std::string>& models) {
  std::vector<FigurePanel> panels;
  for (const std::string& model : models) {
    const Scene scene = load_model(model);
    const LayerCounter counter(scene);
    const Vec3 size = scene.bounds.size();
    char text[160];
    std::snprintf(text, sizeof text, "%s (%.0f x %.0f x %.0f m)", model_name(model).c_str(), size.x, size.y, size.z);
    panels.push_back(by_distance(text, counter, panels.empty()));
    panels.push_back(by_cell_side(text, counter));
  }
  return panels;
}

void run(int argc, char** argv) {
  std::vector<std::string> models;
  std::string figure;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--figure" && i + 1 < argc)
      figure = argv[++i];
    else
      models.emplace_back(argv[i]);
  }
  const std::vector<FigurePanel> panels = panels_of(models);
  for (const FigurePanel& panel : panels) print_table(panel);
  if (!figure.empty()) write_figure(figure, "Layers of an impostor", 2, panels);
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  try {
    standin::run(argc, argv);
  } catch (const standin::Failure& failure) {
    std::cerr << failure.what() << "\n";
    return 2;
  }
}
