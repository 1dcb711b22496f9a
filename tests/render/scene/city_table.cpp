#include "tests/render/scene/city_table.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <map>
#include <vector>

#include "render/scene/city.h"

namespace standin::test {
namespace {

using Quantity = double (*)(const Object&);

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, value < 100.0 ? "%.1f" : "%.0f", value);
  return text;
}

// Nearest-rank percentile.
double percentile(const std::vector<double>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1) + 0.5);
  return sorted[rank];
}

std::string distribution_row(const std::string& kind, const std::vector<const Object*>& objects, Quantity quantity) {
  std::vector<double> values;
  for (const Object* object : objects) values.push_back(quantity(*object));
  std::sort(values.begin(), values.end());
  std::string row = "| " + kind + " | " + std::to_string(values.size());
  for (const double share : {0.0, 0.1, 0.5, 0.9, 1.0}) row += " | " + number(percentile(values, share));
  double sum = 0.0;
  for (const double value : values) sum += value;
  return row + " | " + number(sum) + " |\n";
}

std::string distribution(const Scene& city, const std::string& title, Quantity quantity) {
  std::map<std::string, std::vector<const Object*>> kinds;
  for (const Object& object : city.objects) kinds[object.name.substr(0, object.name.find('_'))].push_back(&object);
  std::string table = "| " + title + " | objects | least | 10 % | median | 90 % | most | sum |\n|---|---|---|---|---|---|---|---|\n";
  for (const auto& [kind, objects] : kinds) table += distribution_row(kind, objects, quantity);
  std::vector<const Object*> all;
  for (const Object& object : city.objects) all.push_back(&object);
  return table + distribution_row("all", all, quantity) + "\n";
}

std::string sizes() {
  std::string table =
      "| asked: objects | triangles | seed | got: objects | triangles | extent, m | textures | meshes | vertices stored |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  for (const CityOptions& options :
       {CityOptions{16, 3'200, 1}, {200, 200'000, 1}, {1000, 1'000'000, 1}, {5287, 10'400'000, 1}, {5287, 10'400'000, 2}}) {
    const Scene city = make_city(options);
    std::size_t vertices = 0;
    for (const Mesh& mesh : city.meshes) vertices += mesh.positions.size();
    const Vec3 size = city.bounds.size();
    for (const std::uint64_t value :
         {std::uint64_t{options.objects}, options.triangles, options.seed, std::uint64_t{city.objects.size()}, city.triangle_count()}) {
      table += "| " + std::to_string(value) + " ";
    }
    table += "| " + number(size.x) + " x " + number(size.y) + " x " + number(size.z) + " | " + std::to_string(city.textures.size()) +
             " | " + std::to_string(city.meshes.size()) + " | " + std::to_string(vertices) + " |\n";
  }
  return table + "\n";
}

}  // namespace

std::string city_tables() {
  const Scene city = make_city({});
  return "# The generated city\n\n"
         "Made by `make_city` (render/scene/city.h); this file by `city_table`, and a test holds the two together.\n\n"
         "## Sizes\n\n" +
         sizes() + "## Distributions at 5,287 objects and 10.4 M triangles, seed 1\n\n" +
         distribution(city, "triangles", [](const Object& o) { return static_cast<double>(o.triangle_count); }) +
         distribution(city, "diagonal, m", [](const Object& o) { return o.bounds.diagonal(); }) +
         distribution(city, "height, m", [](const Object& o) { return o.bounds.size().y; }) +
         distribution(city, "draw calls", [](const Object& o) { return static_cast<double>(o.part_count); }) +
         "Extents and sums are of the world bounds; percentiles by nearest rank.\n";
}

}  // namespace standin::test
