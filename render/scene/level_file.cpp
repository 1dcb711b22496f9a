#include "render/scene/level_file.h"

#include <algorithm>
#include <cmath>

#include "render/base/error.h"
#include "render/scene/glb_container.h"
#include "render/scene/gltf_file.h"
#include "render/scene/gltf_materials.h"
#include "render/scene/simplify_mesh.h"

namespace standin {
namespace {

using Range = std::pair<std::uint32_t, std::uint32_t>;

std::uint32_t source_of(const Mesh& mesh, std::uint32_t vertex) {
  return mesh.source.empty() ? vertex : mesh.source[vertex];
}

/// Corners of a mesh of the scene, simplified or not, as vertices of the file's primitive.
std::vector<std::uint32_t> file_corners(const Scene& scene, const Mesh& mesh) {
  std::vector<std::uint32_t> corners;
  for (const std::uint32_t v : mesh.indices) {
    const std::uint32_t source = source_of(mesh, v);
    corners.push_back(mesh.simplified_from < 0 ? source : source_of(scene.meshes[static_cast<std::size_t>(mesh.simplified_from)], source));
  }
  return corners;
}

/// Whether the file's primitive is this mesh, triangle by triangle, so that nothing need be said of it.
bool is_whole(const Mesh& mesh) {
  return mesh.simplified_from < 0 && !mesh.is_piece;
}

class LevelWriter {
 public:
  explicit LevelWriter(const Scene& scene) : scene_(scene) {}

  LevelFile written() {
    const LevelNumbers numbers = number_levels(scene_);
    std::vector<Range> ranges(numbers.size());
    for (const auto& [range, number] : numbers) ranges[number] = range;
    for (const Range& range : ranges) add_node(range);
    const GlbContainer container(assembled(), binary_);
    return {container.joined(), binary_.size()};
  }

 private:
  /// Accessors of one kind lie one after the other in a buffer view.
  struct Section {
    std::size_t stride = 0;
    int target = 0;
    std::string bytes = {};
    std::vector<std::size_t> accessors = {};
  };

  void add_node(const Range& range) {
    OrderedJson primitives = OrderedJson::array();
    for (std::uint32_t p = range.first; p < range.first + range.second; ++p)
      primitives.push_back(scene_.parts[p].gltf_mesh >= 0 ? reference(scene_.parts[p]) : own_vertices(scene_.parts[p]));
    nodes_.push_back({{"name", "lod_" + std::to_string(nodes_.size())}, {"mesh", meshes_.size()}});
    meshes_.push_back({{"primitives", std::move(primitives)}});
  }

  OrderedJson reference(const Part& part) {
    const Mesh& mesh = scene_.meshes[part.mesh];
    const bool whole = is_whole(mesh);
    OrderedJson primitive{{"attributes", {{"POSITION", whole ? one_triangle() : all_vertices()}}}};
    if (!whole) primitive["indices"] = corners_of(part.mesh, file_corners(scene_, mesh));
    primitive["extras"] = {{"scene_mesh", part.gltf_mesh}, {"scene_primitive", part.gltf_primitive}};
    return primitive;
  }

  OrderedJson own_vertices(const Part& part) {
    const Mesh& mesh = scene_.meshes[part.mesh];
    const auto [known, fresh] = attributes_.try_emplace(part.mesh);
    if (fresh) known->second = attributes_of(mesh);
    return {{"attributes", known->second}, {"indices", corners_of(part.mesh, mesh.indices)}, {"material", material(part.material)}};
  }

  OrderedJson attributes_of(const Mesh& mesh) {
    OrderedJson attributes{{"POSITION", add_accessor(vec3s_, mesh.positions, gltf::kFloat, "VEC3")}};
    Box bounds;
    for (const glm::vec3& position : mesh.positions) bounds.extend(Vec3(position));
    accessors_.back()["min"] = {bounds.min.x, bounds.min.y, bounds.min.z};
    accessors_.back()["max"] = {bounds.max.x, bounds.max.y, bounds.max.z};
    attributes["NORMAL"] = add_accessor(vec3s_, mesh.normals, gltf::kFloat, "VEC3");
    if (!mesh.uvs.empty()) attributes["TEXCOORD_0"] = add_accessor(vec2s_, mesh.uvs, gltf::kFloat, "VEC2");
    return attributes;
  }

  std::size_t corners_of(std::uint32_t mesh, const std::vector<std::uint32_t>& corners) {
    const auto [known, fresh] = corners_.try_emplace(mesh, 0);
    if (!fresh) return known->second;
    const std::uint32_t highest = *std::ranges::max_element(corners);
    highest_ = std::max(highest_, highest);
    const std::vector<std::uint16_t> narrow(corners.begin(), corners.end());
    return known->second = highest <= gltf::kHighestShort ? add_accessor(shorts_, narrow, gltf::kUnsignedShort, "SCALAR")
                                                          : add_accessor(ints_, corners, gltf::kUnsignedInt, "SCALAR");
  }

  template <class Value>
  std::size_t add_accessor(Section& section, const std::vector<Value>& values, int component, const char* type) {
    section.accessors.push_back(accessors_.size());
    accessors_.push_back(
        {{"bufferView", 0}, {"byteOffset", section.bytes.size()}, {"componentType", component}, {"count", values.size()}, {"type", type}});
    section.bytes += bytes_of_values(values);
    return accessors_.size() - 1;
  }

  /// As many zeros as the scene's primitive with the most vertices may need: their number is set at the end.
  std::size_t all_vertices() {
    if (all_vertices_ < 0) all_vertices_ = static_cast<std::int64_t>(add_zeros(0));
    return static_cast<std::size_t>(all_vertices_);
  }
  std::size_t one_triangle() {
    if (one_triangle_ < 0) one_triangle_ = static_cast<std::int64_t>(add_zeros(3));
    return static_cast<std::size_t>(one_triangle_);
  }
  std::size_t add_zeros(std::size_t count) {
    accessors_.push_back({{"componentType", gltf::kFloat}, {"count", count}, {"type", "VEC3"}, {"min", {0, 0, 0}}, {"max", {0, 0, 0}}});
    return accessors_.size() - 1;
  }

  std::size_t material(std::uint32_t id) {
    const auto [known, fresh] = material_numbers_.try_emplace(id, materials_.size());
    if (!fresh) return known->second;
    const Material& material = scene_.materials[id];
    const auto linear = [&](int channel) { return srgb_decoded(static_cast<double>(material.base_colour[channel])); };
    OrderedJson json{{"name", material.name},
                     {"pbrMetallicRoughness",
                      {{"baseColorFactor", {linear(0), linear(1), linear(2), static_cast<double>(material.base_colour.a)}},
                       {"metallicFactor", 0.0},
                       {"roughnessFactor", 1.0}}},
                     {"doubleSided", material.double_sided}};
    if (material.texture >= 0) json["extras"] = {{"scene_texture", scene_.textures[static_cast<std::size_t>(material.texture)].name}};
    materials_.push_back(std::move(json));
    return known->second;
  }

  void close(Section& section, OrderedJson& views) {
    if (section.accessors.empty()) return;
    const std::size_t view = add_buffer_view(views, binary_, section.bytes, section.stride, section.target);
    for (const std::size_t accessor : section.accessors) accessors_[accessor]["bufferView"] = view;
  }

  OrderedJson assembled() {
    if (all_vertices_ >= 0) accessors_[static_cast<std::size_t>(all_vertices_)]["count"] = std::uint64_t{highest_} + 1;
    OrderedJson views = OrderedJson::array();
    for (Section* section : {&vec3s_, &vec2s_, &ints_, &shorts_}) close(*section, views);
    OrderedJson roots = OrderedJson::array();
    for (std::size_t i = 0; i < nodes_.size(); ++i) roots.push_back(i);
    OrderedJson json{{"asset", {{"version", "2.0"}, {"generator", "standin"}}}, {"scene", 0}};
    json["scenes"] = OrderedJson::array({{{"nodes", roots}}});
    add_unless_empty(json, "nodes", nodes_);
    add_unless_empty(json, "meshes", meshes_);
    add_unless_empty(json, "materials", materials_);
    add_unless_empty(json, "accessors", accessors_);
    add_unless_empty(json, "bufferViews", views);
    return json;
  }

  const Scene& scene_;
  OrderedJson nodes_ = OrderedJson::array(), meshes_ = OrderedJson::array(), materials_ = OrderedJson::array(),
              accessors_ = OrderedJson::array();
  Section vec3s_{sizeof(glm::vec3), gltf::kArrayBuffer}, vec2s_{sizeof(glm::vec2), gltf::kArrayBuffer}, ints_{0, gltf::kElementArrayBuffer},
      shorts_{0, gltf::kElementArrayBuffer};
  std::string binary_;
  std::map<std::uint32_t, std::size_t> corners_;           // accessor, by mesh of the scene
  std::map<std::uint32_t, OrderedJson> attributes_;        // by mesh of the scene
  std::map<std::uint32_t, std::size_t> material_numbers_;  // by material of the scene
  std::int64_t all_vertices_ = -1, one_triangle_ = -1;     // accessors, once there are any
  std::uint32_t highest_ = 0;                              // corner of any
};

[[noreturn]] void broken(const std::string& sentence) {
  throw Failure(ErrorWord::kFileBroken, "lods.glb: " + sentence);
}

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

template <class Vector>
void require_finite(const std::vector<Vector>& values, std::uint64_t accessor) {
  for (std::size_t i = 0; i < values.size(); ++i)
    for (int axis = 0; axis < Vector::length(); ++axis)
      if (!std::isfinite(values[i][axis]))
        broken("accessors[" + std::to_string(accessor) + "]: element " + std::to_string(i) + " is no finite number");
}

/// Where a part of a level lies in the file, and which mesh of the scene it stands for.
struct Form {
  std::uint32_t mesh = 0;
  std::uint64_t indices = 0;  // accessor
  const Json* primitive = nullptr;
  bool own_vertices = false;  // of the file; else the scene's
  std::uint64_t triangles = 0;
};

class LevelReader {
 public:
  LevelReader(std::span<const StatedLevel> stated, const std::string& glb, Scene& scene)
      : stated_(stated), scene_(scene), file_(bytes_of(glb), SceneFolder("lods.glb")) {
    for (std::size_t n = 0; n < file_.count("nodes"); ++n) nodes_.emplace(text(file_.item("nodes", n, "nodes"), "name"), n);
  }

  std::uint64_t run() {
    for (const StatedLevel& level : stated_)
      if (level.object >= scene_.objects.size()) broken("object " + std::to_string(level.object) + " is not in the scene");
    add_meshes();
    std::vector<std::vector<ObjectLevel>> levels(scene_.objects.size());
    for (const StatedLevel& level : stated_) levels[level.object].push_back(level_of(level));
    for (std::size_t id = 0; id < levels.size(); ++id) scene_.objects[id].levels = std::move(levels[id]);
    return file_.count("buffers") == 0 ? 0 : required_number(file_.item("buffers", 0, "buffers"), "byteLength", "buffers[0]");
  }

 private:
  [[nodiscard]] const Json& primitives_of(const StatedLevel& level) const {
    const auto node = nodes_.find(level.gltf_node);
    if (node == nodes_.end()) broken("there is no node " + level.gltf_node);
    const std::uint64_t mesh = required_number(file_.item("nodes", node->second, level.gltf_node), "mesh", level.gltf_node);
    const Json* primitives = member(file_.item("meshes", mesh, level.gltf_node), "primitives");
    if (primitives == nullptr || !primitives->is_array()) broken(level.gltf_node + " has no primitives");
    return *primitives;
  }

  static bool refers_to(const Json& primitive, const Part& part, const std::string& place) {
    const Json* extras = member(primitive, "extras");
    if (part.gltf_mesh < 0) return true;  // nothing to name: the order tells
    return extras != nullptr && whole_number(*extras, "scene_mesh", place) == static_cast<std::uint64_t>(part.gltf_mesh) &&
           whole_number(*extras, "scene_primitive", place) == part.gltf_primitive;
  }

  [[nodiscard]] bool refer_to(const Json& primitives, const Range& range, const std::string& place) const {
    if (primitives.size() != range.second) return false;
    for (std::uint32_t p = 0; p < range.second; ++p)
      if (!refers_to(primitives[p], scene_.parts[range.first + p], place)) return false;
    return true;
  }

  /// The level of the scene's file that is meant, where the object came with levels; else the object itself.
  [[nodiscard]] ObjectLevel meant(const StatedLevel& level) const {
    const Object& object = scene_.objects[level.object];
    const Json& primitives = primitives_of(level);
    for (const ObjectLevel& own : object.levels)
      if (refer_to(primitives, {own.first_part, own.part_count}, level.gltf_node)) return own;
    if (!object.levels.empty() || !refer_to(primitives, {object.first_part, object.part_count}, level.gltf_node))
      broken(level.gltf_node + " is no form of object " + std::to_string(level.object));
    return {object.first_part, object.part_count};
  }

  [[nodiscard]] std::vector<Form> forms_of(const StatedLevel& level) {
    const ObjectLevel own = meant(level);
    const Json& primitives = primitives_of(level);
    std::vector<Form> forms;
    for (std::uint32_t p = 0; p < own.part_count; ++p) {
      const Part& part = scene_.parts[own.first_part + p];
      const auto indices = whole_number(primitives[p], "indices", level.gltf_node);
      if (indices) forms.push_back({part.mesh, *indices, &primitives[p], part.gltf_mesh < 0});
    }
    return forms;
  }

  /// Forms of one mesh follow each other in the scene, from fine to coarse.
  void add_meshes() {
    std::map<Range, Form> forms;
    for (const StatedLevel& level : stated_)
      for (const Form& form : forms_of(level)) forms.try_emplace({form.mesh, static_cast<std::uint32_t>(form.indices)}, form);
    std::vector<Form> ordered;
    for (auto& [key, form] : forms) {
      form.triangles = file_.indices(form.indices).size() / 3;
      ordered.push_back(form);
    }
    std::ranges::stable_sort(ordered,
                             [](const Form& a, const Form& b) { return a.mesh != b.mesh ? a.mesh < b.mesh : a.triangles > b.triangles; });
    for (const Form& form : ordered) {
      if (is_itself(form)) continue;
      Mesh mesh = mesh_of(form);
      mesh.simplified_from = static_cast<std::int32_t>(form.mesh);
      meshes_[{form.mesh, static_cast<std::uint32_t>(form.indices)}] = static_cast<std::uint32_t>(scene_.meshes.size());
      scene_.meshes.push_back(std::move(mesh));
    }
  }

  /// A piece of a split object, named by its corners.
  bool is_itself(const Form& form) {
    const Mesh& own = scene_.meshes[form.mesh];
    if (!own.is_piece || form.own_vertices || file_.indices(form.indices) != file_corners(scene_, own)) return false;
    meshes_[{form.mesh, static_cast<std::uint32_t>(form.indices)}] = form.mesh;
    return true;
  }

  Mesh mesh_of(const Form& form) {
    const std::string place = "accessors[" + std::to_string(form.indices) + "]";
    const std::vector<std::uint32_t> corners = file_.indices(form.indices);
    if (corners.empty() || corners.size() % 3 != 0) broken(place + " is no list of triangles");
    if (form.own_vertices) return mesh_of_own_vertices(form, corners, place);
    return mesh_over_file(scene_.meshes[form.mesh], corners, place);
  }

  static Mesh mesh_over_file(const Mesh& original, const std::vector<std::uint32_t>& corners, const std::string& place) {
    std::map<std::uint32_t, std::vector<std::uint32_t>> by_source;
    for (std::uint32_t v = 0; v < original.positions.size(); ++v) by_source[source_of(original, v)].push_back(v);
    std::vector<std::vector<std::uint32_t>> members;
    std::map<std::uint32_t, std::uint32_t> numbers;
    std::vector<std::uint32_t> numbered;
    for (const std::uint32_t corner : corners) {
      const auto [number, fresh] = numbers.try_emplace(corner, static_cast<std::uint32_t>(members.size()));
      const auto known = by_source.find(corner);
      if (known == by_source.end()) broken(place + ": vertex " + std::to_string(corner) + " is none of the scene's");
      if (fresh) members.push_back(known->second);
      numbered.push_back(number->second);
    }
    return mesh_over(original, members, numbered);
  }

  Mesh mesh_of_own_vertices(const Form& form, const std::vector<std::uint32_t>& corners, const std::string& place) {
    const Json* attributes = member(*form.primitive, "attributes");
    const auto read = [&](const char* name, auto& values) {
      const auto accessor = attributes == nullptr ? std::nullopt : whole_number(*attributes, name, place);
      if (!accessor) return;
      values = file_.vectors<typename std::remove_reference_t<decltype(values)>::value_type>(*accessor);
      require_finite(values, *accessor);
    };
    Mesh mesh;
    mesh.name = scene_.meshes[form.mesh].name;
    read("POSITION", mesh.positions);
    read("NORMAL", mesh.normals);
    read("TEXCOORD_0", mesh.uvs);
    mesh.indices = corners;
    const bool in_range = *std::ranges::max_element(corners) < mesh.positions.size();
    const bool complete = mesh.normals.size() == mesh.positions.size() && (mesh.uvs.empty() || mesh.uvs.size() == mesh.positions.size());
    if (!in_range || !complete) broken(place + " and its vertices do not fit");
    update_derived(mesh);
    return mesh;
  }

  ObjectLevel level_of(const StatedLevel& stated) {
    ObjectLevel level = meant(stated);
    const Range own{level.first_part, level.part_count};
    const auto [known, fresh] = first_parts_.try_emplace({stated.gltf_node, own}, level.first_part);
    if (fresh && !forms_of(stated).empty()) known->second = add_parts(stated, own);
    level.first_part = known->second;
    level.triangle_count = 0;
    for (std::uint32_t p = 0; p < level.part_count; ++p)
      level.triangle_count += scene_.meshes[scene_.parts[level.first_part + p].mesh].triangle_count();
    if (level.triangle_count != stated.triangle_count)
      broken(stated.gltf_node + " has " + std::to_string(level.triangle_count) + " triangles, stated are " +
             std::to_string(stated.triangle_count));
    level.error_m = stated.error_m;
    level.least_distance_m = stated.least_distance_m;
    return level;
  }

  std::uint32_t add_parts(const StatedLevel& level, const Range& own) {
    const Json& primitives = primitives_of(level);
    const auto first = static_cast<std::uint32_t>(scene_.parts.size());
    for (std::uint32_t p = 0; p < own.second; ++p) {
      Part part = scene_.parts[own.first + p];
      if (const auto indices = whole_number(primitives[p], "indices", level.gltf_node))
        part.mesh = meshes_.at({part.mesh, static_cast<std::uint32_t>(*indices)});
      scene_.parts.push_back(part);
    }
    return first;
  }

  std::span<const StatedLevel> stated_;
  Scene& scene_;
  GltfFile file_;
  std::map<std::string, std::size_t> nodes_;                            // by name
  std::map<Range, std::uint32_t> meshes_;                               // of the scene, by (mesh that they stand for, accessor)
  std::map<std::pair<std::string, Range>, std::uint32_t> first_parts_;  // by node and the parts that it stands for
};

}  // namespace

LevelNumbers number_levels(const Scene& scene) {
  LevelNumbers numbers;
  for (const Object& object : scene.objects)
    for (const ObjectLevel& level : object.levels)
      numbers.try_emplace({level.first_part, level.part_count}, static_cast<std::uint32_t>(numbers.size()));
  return numbers;
}

LevelFile write_levels(const Scene& scene) {
  return LevelWriter(scene).written();
}

double level_bytes(const Scene& scene, const Part& part) {
  const Mesh& mesh = scene.meshes[part.mesh];
  const bool refers = part.gltf_mesh >= 0;
  if (refers && is_whole(mesh)) return 0.0;
  const Mesh& vertices = refers && mesh.simplified_from >= 0 ? scene.meshes[static_cast<std::size_t>(mesh.simplified_from)] : mesh;
  const double index_bytes = vertices.positions.size() <= gltf::kHighestShort ? 2.0 : 4.0;
  const double vertex_bytes = refers ? 0.0 : 2.0 * sizeof(glm::vec3) + (mesh.uvs.empty() ? 0.0 : sizeof(glm::vec2));
  return index_bytes * static_cast<double>(mesh.indices.size()) + vertex_bytes * static_cast<double>(mesh.positions.size());
}

std::optional<Mat4> level_transform(const Scene& scene, const Object& object) {
  if (object.part_count > 0 && scene.parts[object.first_part].gltf_mesh >= 0) return std::nullopt;
  return object.world_from_object;
}

std::vector<StatedLevel> stated_levels(const Scene& scene) {
  const LevelNumbers numbers = number_levels(scene);
  std::vector<StatedLevel> stated;
  for (std::uint32_t id = 0; id < scene.objects.size(); ++id)
    for (const ObjectLevel& level : scene.objects[id].levels)
      stated.push_back({id, "lod_" + std::to_string(numbers.at({level.first_part, level.part_count})), level.least_distance_m,
                        level.error_m, level.triangle_count});
  return stated;
}

std::uint64_t read_levels(std::span<const StatedLevel> stated, const std::string& glb, Scene& scene) {
  return LevelReader(stated, glb, scene).run();
}

}  // namespace standin
