// What a bench measured, as the file that draw.mjs draws: panels of named series of points.
#pragma once

#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace standin {

struct FigureAxis {
  std::string label;
  bool log = false;
  bool zero = false;          // begins at 0
  std::vector<double> ticks;  // none: chosen by the drawing
};

struct FigureSeries {
  std::string name;
  std::vector<std::array<double, 2>> points;
  bool line = true;  // joins the points, in their order
};

struct FigurePanel {
  std::string title;
  FigureAxis x, y;
  std::vector<FigureSeries> series;
};

inline nlohmann::json axis_json(const FigureAxis& axis) {
  nlohmann::json object = {{"label", axis.label}, {"log", axis.log}, {"zero", axis.zero}};
  if (!axis.ticks.empty()) object["ticks"] = axis.ticks;
  return object;
}

inline void write_figure(const std::filesystem::path& file, const std::string& title, int columns, const std::vector<FigurePanel>& panels) {
  nlohmann::json object = {{"title", title}, {"columns", columns}, {"panels", nlohmann::json::array()}};
  for (const FigurePanel& panel : panels) {
    nlohmann::json series = nlohmann::json::array();
    for (const FigureSeries& one : panel.series) series.push_back({{"name", one.name}, {"points", one.points}, {"line", one.line}});
    object["panels"].push_back({{"title", panel.title}, {"x", axis_json(panel.x)}, {"y", axis_json(panel.y)}, {"series", series}});
  }
  std::ofstream(file) << object.dump(1) << "\n";
}

}  // namespace standin
