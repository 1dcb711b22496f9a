#include "render/scene/street_models.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

#include "render/base/error.h"
#include "render/scene/file_access.h"
#include "render/scene/load.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCatalogue = "PluginFurnitureCatalog.properties";
constexpr double kFootShare = 0.02;  // of the height: what touches the ground

struct Entry {
  fs::path file;
  Vec3 size_m{0.0};
};

double number_in(const std::map<std::string, std::string>& properties, const std::string& key, const fs::path& catalogue) {
  const auto found = properties.find(key);
  const std::string text = found == properties.end() ? "" : found->second;
  double number = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  if (number > 0.0 && std::isfinite(number)) return number;
  throw Failure(ErrorWord::kFileBroken, catalogue.string() + ": " + key + "=" + text + " is not a length");
}

std::map<std::string, std::string> read_properties(const fs::path& file) {
  const std::vector<std::uint8_t> bytes = read_bytes(file);
  std::istringstream text(std::string(bytes.begin(), bytes.end()));
  std::map<std::string, std::string> properties;
  for (std::string line; std::getline(text, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    const std::size_t equals = line.find('=');
    if (equals != std::string::npos && line.front() != '#') properties[line.substr(0, equals)] = line.substr(equals + 1);
  }
  return properties;
}

// The entries of one catalogue that the city takes: "model#12=/scopia/van/van.obj" with "width#12=240.5", depth and height.
void read_catalogue(const fs::path& file, std::map<std::string, Entry>& entries) {
  const std::map<std::string, std::string> properties = read_properties(file);
  for (const auto& property : properties) {
    const std::string& key = property.first;
    const std::string& path = property.second;
    const bool wanted = std::any_of(kStreetModels.begin(), kStreetModels.end(), [&](const StreetModelName& m) { return m.path == path; });
    if (!wanted || !key.starts_with("model#")) continue;
    const auto size_m = [&](const char* side) { return 0.01 * number_in(properties, side + key.substr(5), file); };
    entries[path] = {file.parent_path() / path.substr(1), {size_m("width"), size_m("height"), size_m("depth")}};
  }
}

std::map<std::string, Entry> read_catalogues(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().filename() == kCatalogue) files.push_back(entry->path());
  }
  if (error) throw Failure(ErrorWord::kFileMissing, folder.string() + ": " + error.message());
  if (files.empty())
    throw Failure(ErrorWord::kFileMissing, folder.string() + " holds no " + kCatalogue + " (unpack the .sh3f files there)");
  std::sort(files.begin(), files.end());
  std::map<std::string, Entry> entries;
  for (const fs::path& file : files) read_catalogue(file, entries);
  return entries;
}

// Positions of the file to metres, standing on its foot; normals by the inverse transpose.
class Scaling {
 public:
  Scaling(const Scene& model, const Vec3& size_m) : factor_(size_m / glm::max(model.bounds.size(), Vec3(1e-9))), foot_(foot_of(model)) {}

  [[nodiscard]] Vec3 point(const Vec3& world) const { return (world - foot_) * factor_; }
  [[nodiscard]] glm::vec3 normal(const Vec3& world) const { return glm::vec3(glm::normalize(world / factor_)); }

 private:
  static Vec3 foot_of(const Scene& model) {
    const double ground = model.bounds.min.y;
    const double reach = ground + kFootShare * model.bounds.size().y;
    Box foot;
    for (const Object& object : model.objects) {
      for (std::uint32_t p = 0; p < object.part_count; ++p) {
        for (const glm::vec3& position : model.meshes[model.parts[object.first_part + p].mesh].positions) {
          const Vec3 world(object.world_from_object * Vec4(Vec3(position), 1.0));
          if (world.y <= reach) foot.extend(world);
        }
      }
    }
    return {foot.centre().x, ground, foot.centre().z};
  }

  Vec3 factor_;
  Vec3 foot_;
};

void append(Mesh& to, const Mesh& from, const Object& object, const Scaling& scaling) {
  const auto first = static_cast<std::uint32_t>(to.positions.size());
  const Mat3 world_normal = glm::transpose(glm::inverse(Mat3(object.world_from_object)));
  for (std::size_t v = 0; v < from.positions.size(); ++v) {
    to.positions.emplace_back(scaling.point(Vec3(object.world_from_object * Vec4(Vec3(from.positions[v]), 1.0))));
    to.normals.push_back(scaling.normal(world_normal * Vec3(from.normals[v])));
    to.uvs.push_back(from.uvs.empty() ? glm::vec2(0.0F) : from.uvs[v]);
  }
  for (const std::uint32_t index : from.indices) to.indices.push_back(first + index);
}

// One mesh per material of the file, in the order of the materials.
std::map<std::uint32_t, Mesh> merged(const Scene& model, const Scaling& scaling) {
  std::map<std::uint32_t, Mesh> meshes;
  for (const Object& object : model.objects) {
    for (std::uint32_t p = 0; p < object.part_count; ++p) {
      const Part& part = model.parts[object.first_part + p];
      append(meshes[part.material], model.meshes[part.mesh], object, scaling);
    }
  }
  return meshes;
}

StreetModel add_model(Scene& scene, const StreetModelName& name, const Entry& entry) {
  LoadOptions whole;
  whole.split_triangles = 0;
  whole.split_extent = 0.0;
  Scene model = load_scene(entry.file, whole);
  const std::string stem = entry.file.stem().string();
  const auto first_texture = static_cast<std::int32_t>(scene.textures.size());
  const auto first_material = static_cast<std::uint32_t>(scene.materials.size());
  StreetModel result{name, model.triangle_count(), entry.size_m, static_cast<std::uint32_t>(scene.parts.size()), 0};
  for (auto& [material, mesh] : merged(model, Scaling(model, entry.size_m))) {
    mesh.name = stem + "_" + model.materials[material].name;
    scene.parts.push_back({static_cast<std::uint32_t>(scene.meshes.size()), first_material + material});
    scene.meshes.push_back(std::move(mesh));
    ++result.part_count;
  }
  for (Material& material : model.materials) {
    if (material.texture >= 0) material.texture += first_texture;
    material.name = stem + "_" + material.name;
    scene.materials.push_back(std::move(material));
  }
  for (Texture& texture : model.textures) scene.textures.push_back(std::move(texture));
  return result;
}

}  // namespace

std::vector<StreetModel> add_street_models(Scene& scene, const fs::path& folder) {
  const std::map<std::string, Entry> entries = read_catalogues(folder);
  std::vector<StreetModel> models;
  for (const StreetModelName& name : kStreetModels) {
    const auto found = entries.find(std::string(name.path));
    if (found == entries.end())
      throw Failure(ErrorWord::kFileMissing,
                    folder.string() + ": no catalogue offers " + std::string(name.path) + " (Debian: sweethome3d-furniture)");
    models.push_back(add_model(scene, name, found->second));
  }
  return models;
}

}  // namespace standin
