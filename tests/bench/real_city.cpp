// What a city file holds, kind by kind and model by model, and pictures of it: the tables of real_city.md.
//
//   real_city CITY.glb [PICTURES_FOLDER]
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <string>

#include "render/device/context.h"
#include "render/device/renderer.h"
#include "render/image/image_io.h"
#include "render/scene/load.h"

namespace {

using namespace standin;

struct Row {
  std::uint64_t objects = 0;
  std::uint64_t triangles = 0;
  std::uint64_t draws = 0;
  std::uint64_t most = 0;
  Vec3 size_m{0.0};
};

void add(Row& row, const Object& object) {
  ++row.objects;
  row.triangles += object.triangle_count;
  row.draws += object.part_count;
  row.most = std::max(row.most, object.triangle_count);
  row.size_m = glm::max(row.size_m, object.bounds.size());
}

void print(const char* title, const std::map<std::string, Row>& rows) {
  std::printf("\n| %s | objects | triangles drawn | heaviest object | draw calls | largest, m |\n|---|---|---|---|---|---|\n", title);
  for (const auto& [name, row] : rows) {
    std::printf("| %s | %llu | %llu | %llu | %llu | %.1f x %.1f x %.1f |\n", name.c_str(), static_cast<unsigned long long>(row.objects),
                static_cast<unsigned long long>(row.triangles), static_cast<unsigned long long>(row.most),
                static_cast<unsigned long long>(row.draws), row.size_m.x, row.size_m.y, row.size_m.z);
  }
}

void tabulate(const Scene& scene) {
  std::map<std::string, Row> kinds;
  std::map<std::string, Row> models;
  std::set<std::uint32_t> used;
  for (const Object& object : scene.objects) {
    const std::string kind = object.name.substr(0, object.name.find('_'));
    add(kinds[kind], object);
    add(kinds["~ all"], object);
    for (std::uint32_t p = 0; p < object.part_count; ++p) used.insert(scene.parts[object.first_part + p].mesh);
    const std::string& mesh = scene.meshes[scene.parts[object.first_part].mesh].name;
    if (kind != "ground" && kind != "building") add(models[mesh.substr(0, mesh.find('_'))], object);
  }
  std::uint64_t unique = 0;
  for (const std::uint32_t mesh : used) unique += scene.meshes[mesh].triangle_count();
  std::printf("%zu objects, %llu triangles drawn, %llu stored, %zu meshes, %zu materials, %zu textures\n", scene.objects.size(),
              static_cast<unsigned long long>(scene.triangle_count()), static_cast<unsigned long long>(unique), used.size(),
              scene.materials.size(), scene.textures.size());
  print("kind", kinds);
  print("model", models);
}

// From above at an angle, and round about at eye height in places spread over the city.
void draw(const Scene& scene, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  Camera camera;
  camera.width = 1024;
  camera.height = 640;
  const auto context = make_context(DeviceKind::kOsMesa, camera.width, camera.height);
  Renderer renderer(*context, scene, camera);
  DrawList everything;
  everything.objects.resize(scene.objects.size());
  std::iota(everything.objects.begin(), everything.objects.end(), 0U);
  const auto take = [&](const std::string& name, const View& view) {
    renderer.draw(view, everything);
    std::ofstream(folder / (name + ".png"), std::ios::binary) << encode_png(renderer.read_pixels());
  };
  const Vec3 middle = scene.bounds.centre();
  const Vec3 size = scene.bounds.size();
  take("above", {middle + Vec3(0.0, 0.5 * size.x, 0.75 * size.z), glm::normalize(Vec3(0.0, -0.62, -0.75))});
  take("roofs", {middle + Vec3(-0.2 * size.x, 90.0, 0.25 * size.z), glm::normalize(Vec3(0.7, -0.45, -0.6))});
  // Beside cars and trees there is always free sky to stand under.
  std::vector<const Object*> parked;
  for (const Object& object : scene.objects) {
    if (object.name.starts_with("car_") || object.name.starts_with("tree_")) parked.push_back(&object);
  }
  for (int i = 0; i < 6 && !parked.empty(); ++i) {
    const Object& object = *parked[parked.size() * static_cast<std::size_t>(2 * i + 1) / 12];
    const double angle = 2.0 * std::numbers::pi * i / 6.0;
    const Vec3 from = Vec3(std::cos(angle), 0.0, std::sin(angle)) * (6.0 + object.bounds.size().x);
    const Vec3 eye(object.bounds.centre().x + from.x, 2.0, object.bounds.centre().z + from.z);
    take("street_" + std::to_string(i), {eye, glm::normalize(Vec3(-from.x, 0.5, -from.z))});
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  LoadOptions whole;  // as it was made: trees in one piece
  whole.split_triangles = 0;
  whole.split_extent = 0.0;
  const Scene scene = load_scene(argv[1], whole);
  tabulate(scene);
  if (argc > 2) draw(scene, argv[2]);
}
