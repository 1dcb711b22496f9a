// glTF 2.0: the node tree to objects, primitives to meshes.

#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <set>

#include "render/base/error.h"
#include "render/scene/gltf_file.h"
#include "render/scene/gltf_materials.h"
#include "render/scene/import.h"

namespace standin {
namespace {

using Kind = LoadNote::Kind;

const std::set<std::string> kExtensionsRead{
    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression", "EXT_texture_webp",      "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_unlit",     "KHR_mesh_quantization",   "KHR_texture_transform", "MSFT_lod"};

constexpr std::uint64_t kMostObjects = 4'000'000;  // some 2 GB

enum class Mode : std::uint64_t { kTriangles = 4, kStrip = 5, kFan = 6 };

// sum + count * of_each, or as much as there is.
std::uint64_t plus_times(std::uint64_t sum, std::uint64_t count, std::uint64_t of_each) {
  if (of_each > 0 && count > (UINT64_MAX - sum) / of_each) return UINT64_MAX;
  return sum + count * of_each;
}

// Strips and fans as separate triangles of the same orientation.
std::vector<std::uint32_t> separate(const std::vector<std::uint32_t>& in, Mode mode) {
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i + 2 < in.size(); ++i) {
    const std::size_t odd = i % 2;
    if (mode == Mode::kFan) {
      out.insert(out.end(), {in[i + 1], in[i + 2], in[0]});
    } else {
      out.insert(out.end(), {in[i], in[i + 1 + odd], in[i + 2 - odd]});
    }
  }
  return out;
}

Mat4 placed(const Vec3& translation, const glm::dquat& rotation, const Vec3& scale) {
  Mat4 matrix = glm::mat4_cast(rotation);
  for (int axis = 0; axis < 3; ++axis) matrix[axis] *= scale[axis];
  matrix[3] = Vec4(translation, 1.0);
  return matrix;
}

glm::dquat unit_quaternion(double x, double y, double z, double w) {
  const glm::dquat q(w, x, y, z);
  const double length = glm::length(q);
  return length > 0.0 ? q / length : glm::dquat(1.0, 0.0, 0.0, 0.0);
}

Mat4 parent_from_node(const Json& node, const std::string& place) {
  if (const auto matrix = real_numbers(node, "matrix", 16, place)) return glm::make_mat4(matrix->data());
  const auto t = real_numbers(node, "translation", 3, place).value_or(std::vector<double>{0, 0, 0});
  const auto r = real_numbers(node, "rotation", 4, place).value_or(std::vector<double>{0, 0, 0, 1});
  const auto s = real_numbers(node, "scale", 3, place).value_or(std::vector<double>{1, 1, 1});
  return placed({t[0], t[1], t[2]}, unit_quaternion(r[0], r[1], r[2], r[3]), {s[0], s[1], s[2]});
}

std::vector<std::uint64_t> index_list(const Json& json, const char* key, const std::string& place) {
  const Json* list = member(json, key);
  if (list == nullptr) return {};
  std::vector<std::uint64_t> indices;
  for (const Json& value : *list) {
    if (!value.is_number_unsigned()) throw Failure(ErrorWord::kFileBroken, place + "." + key + " holds something else than indices");
    indices.push_back(value.get<std::uint64_t>());
  }
  return indices;
}

class GltfReader {
 public:
  GltfReader(Import& import, std::span<const std::uint8_t> bytes)
      : import_(import), scene_(import.scene), file_(bytes, import.folder), materials_(file_, import) {}

  void read() {
    check_extensions();
    check_uris("buffers");
    check_uris("images");
    note_what_is_not_read();
    find_lower_levels();
    walk();
  }

 private:
  struct PartRange {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };

  void check_extensions() const {
    const Json* required = member(file_.json(), "extensionsRequired");
    if (required == nullptr) return;
    for (const Json& name : *required) {
      if (name.is_string() && kExtensionsRead.contains(name.get<std::string>())) continue;
      throw Failure(ErrorWord::kExtensionUnknown, "the scene requires the glTF extension " + name.dump() + ", which is not read");
    }
  }

  // Forbidden references are refused even where nothing uses them.
  void check_uris(const char* array) const {
    for (std::size_t i = 0; i < file_.count(array); ++i) {
      const std::string uri = text(file_.item(array, i, array), "uri");
      if (!uri.empty() && !is_data_uri(uri)) (void)file_.folder().resolve_uri(uri);
    }
  }

  void note_what_is_not_read() {
    add_note(scene_, Kind::kWarning, "skins", file_.count("skins"), "drawn in the pose of the file's vertices");
    add_note(scene_, Kind::kWarning, "animations", file_.count("animations"), "not played");
  }

  // Nodes that MSFT_lod names are drawn in place of others, never beside them, even where a file lists them among the roots.
  void find_lower_levels() {
    for (std::size_t i = 0; i < file_.count("nodes"); ++i)
      if (const Json* lod = extension(file_.item("nodes", i, "nodes"), "MSFT_lod"))
        for (const std::uint64_t id : index_list(*lod, "ids", "nodes[" + std::to_string(i) + "].MSFT_lod")) lower_levels_.insert(id);
    for (std::size_t i = 0; i < file_.count("materials"); ++i)
      if (extension(file_.item("materials", i, "materials"), "MSFT_lod") != nullptr)
        add_note(scene_, Kind::kWarning, "materials", 1, "their levels of detail are not used, only those of nodes");
  }

  [[nodiscard]] std::vector<std::uint64_t> roots() const {
    const std::uint64_t scene = whole_number(file_.json(), "scene", "the file").value_or(0);
    if (file_.count("scenes") > 0) return index_list(file_.item("scenes", scene, "the file"), "nodes", "scenes");
    std::vector<bool> is_child(file_.count("nodes"), false);
    for (std::size_t i = 0; i < is_child.size(); ++i) {
      for (const std::uint64_t child : index_list(file_.item("nodes", i, "nodes"), "children", "nodes")) {
        if (child < is_child.size()) is_child[static_cast<std::size_t>(child)] = true;
      }
    }
    std::vector<std::uint64_t> result;
    for (std::size_t i = 0; i < is_child.size(); ++i) {
      if (!is_child[i]) result.push_back(i);
    }
    return result;
  }

  // Depth first, parents before children. A node has one place in the tree: a second visit would be a cycle or a copy.
  void walk() {
    std::vector<bool> seen(file_.count("nodes"), false);
    std::vector<std::pair<std::uint64_t, Mat4>> stack;
    const auto push = [&](const std::vector<std::uint64_t>& nodes, const Mat4& file_from_parent) {
      for (auto node = nodes.rbegin(); node != nodes.rend(); ++node)
        if (!lower_levels_.contains(*node)) stack.emplace_back(*node, file_from_parent);
    };
    push(roots(), Mat4(1.0));
    while (!stack.empty()) {
      const auto [index, file_from_parent] = stack.back();
      stack.pop_back();
      const std::string place = "nodes[" + std::to_string(index) + "]";
      const Json& node = file_.item("nodes", index, "the node tree");
      if (seen[static_cast<std::size_t>(index)]) throw Failure(ErrorWord::kFileBroken, place + " occurs twice in the node tree");
      seen[static_cast<std::size_t>(index)] = true;
      const Mat4 file_from_node = file_from_parent * parent_from_node(node, place);
      if (const auto mesh = whole_number(node, "mesh", place)) add_objects(node, index, *mesh, file_from_node);
      push(index_list(node, "children", place), file_from_node);
    }
  }

  void add_objects(const Json& node, std::uint64_t index, std::uint64_t mesh, const Mat4& file_from_node) {
    const std::string place = "nodes[" + std::to_string(index) + "]";
    const PartRange range = parts_of(mesh);
    if (range.count == 0) return;
    const std::string name = text(node, "name", text(file_.item("meshes", mesh, place), "name", "node_" + std::to_string(index)));
    const std::vector<ObjectLevel> levels = levels_of(node, place);
    const Json* instancing = extension(node, "EXT_mesh_gpu_instancing");
    if (instancing == nullptr) {
      count_objects(1, range, levels.size(), place);
      add_object(name, text(node, "name"), range, levels, file_from_node);
      return;
    }
    const InstanceAttributes attributes = instance_attributes(*instancing, place);
    count_objects(attributes.count, range, levels.size(), place);
    const std::vector<Mat4> instances = node_from_instances(attributes);
    for (std::size_t i = 0; i < instances.size(); ++i) {
      add_object(name + "[" + std::to_string(i) + "]", text(node, "name"), range, levels, file_from_node * instances[i]);
    }
  }

  // MSFT_lod: coverages are those down to which the node itself, then each lower level, is shown; what is to vanish is drawn all the same.
  std::vector<ObjectLevel> levels_of(const Json& node, const std::string& place) {
    const Json* lod = extension(node, "MSFT_lod");
    if (lod == nullptr) return {};
    const Json* extras = member(node, "extras");
    const Json* coverages = extras == nullptr ? nullptr : member(*extras, "MSFT_screencoverage");
    std::vector<ObjectLevel> levels;
    const std::vector<std::uint64_t> ids = index_list(*lod, "ids", place + ".MSFT_lod");
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const Json& lower = file_.item("nodes", ids[i], place + ".MSFT_lod");
      const auto mesh = whole_number(lower, "mesh", place + ".MSFT_lod");
      const PartRange range = mesh ? parts_of(*mesh) : PartRange{};
      const bool elsewhere = parent_from_node(lower, place) != parent_from_node(node, place) && parent_from_node(lower, place) != Mat4(1.0);
      if (range.count == 0 || elsewhere || member(lower, "children") != nullptr) {
        add_note(scene_, Kind::kDropped, "levels of detail", 1, "a lower level's node has no mesh of its own, children or another place");
        continue;
      }
      ObjectLevel level{range.first, range.count};
      const bool stated = coverages != nullptr && coverages->is_array() && i < coverages->size() && (*coverages)[i].is_number();
      if (stated) level.screen_coverage = std::max(0.0, (*coverages)[i].get<double>());
      levels.push_back(level);
    }
    return levels;
  }

  void add_object(const std::string& name, const std::string& node, const PartRange& range, const std::vector<ObjectLevel>& levels,
                  const Mat4& file_from_object) {
    Object object;
    object.name = name;
    object.gltf_node = node;
    object.world_from_object = file_from_object;
    object.first_part = range.first;
    object.part_count = range.count;
    object.levels = levels;
    scene_.objects.push_back(std::move(object));
  }

  struct InstanceAttributes {
    std::vector<glm::vec3> translations;
    std::vector<glm::vec4> rotations;
    std::vector<glm::vec3> scales;
    std::size_t count = 0;
  };

  InstanceAttributes instance_attributes(const Json& instancing, const std::string& place) {
    const Json* attributes = member(instancing, "attributes");
    if (attributes == nullptr) throw Failure(ErrorWord::kFileBroken, place + " has instances without attributes");
    const auto accessor = [&](const char* name) { return whole_number(*attributes, name, place); };
    InstanceAttributes read;
    if (const auto t = accessor("TRANSLATION")) read.translations = file_.vectors<glm::vec3>(*t);
    if (const auto r = accessor("ROTATION")) read.rotations = file_.vectors<glm::vec4>(*r);
    if (const auto s = accessor("SCALE")) read.scales = file_.vectors<glm::vec3>(*s);
    read.count = std::max({read.translations.size(), read.rotations.size(), read.scales.size()});
    const auto complete = [&](std::size_t size) { return size == 0 || size == read.count; };
    if (!complete(read.translations.size()) || !complete(read.rotations.size()) || !complete(read.scales.size())) {
      throw Failure(ErrorWord::kFileBroken, place + " has instance attributes of different lengths");
    }
    return read;
  }

  static std::vector<Mat4> node_from_instances(const InstanceAttributes& read) {
    std::vector<Mat4> result;
    for (std::size_t i = 0; i < read.count; ++i) {
      const glm::vec4 r = read.rotations.empty() ? glm::vec4(0, 0, 0, 1) : read.rotations[i];
      result.push_back(placed(read.translations.empty() ? Vec3(0.0) : Vec3(read.translations[i]), unit_quaternion(r.x, r.y, r.z, r.w),
                              read.scales.empty() ? Vec3(1.0) : Vec3(read.scales[i])));
    }
    return result;
  }

  // Before they are made: an instance may cost a file nothing.
  void count_objects(std::uint64_t count, const PartRange& range, std::size_t levels, const std::string& place) {
    std::uint64_t triangles = 0;
    for (std::uint32_t p = 0; p < range.count; ++p) triangles += scene_.meshes[scene_.parts[range.first + p].mesh].triangle_count();
    const auto add = [&](std::uint64_t& sum, std::uint64_t of_each, std::uint64_t most, const std::string& what) {
      sum = plus_times(sum, count, of_each);
      if (sum > most)
        throw Failure(ErrorWord::kTooLarge, place + " brings the scene to " + std::to_string(sum) + " " + what + ", more than the " +
                                                std::to_string(most) + " allowed");
    };
    add(drawn_triangles_, triangles, import_.options.max_triangles, "triangles");
    add(objects_, 1, kMostObjects, "objects");
    add(levels_, levels, kMostObjects, "levels of detail");
  }

  // A glTF mesh's primitives as one range of parts, read once.
  PartRange parts_of(std::uint64_t mesh) {
    const auto known = part_ranges_.find(mesh);
    if (known != part_ranges_.end()) return known->second;
    const std::string place = "meshes[" + std::to_string(mesh) + "]";
    const Json& json = file_.item("meshes", mesh, place);
    const Json* primitives = member(json, "primitives");
    const std::size_t count = primitives != nullptr && primitives->is_array() ? primitives->size() : 0;
    PartRange range{static_cast<std::uint32_t>(scene_.parts.size()), 0};
    const std::string name = text(json, "name", "mesh_" + std::to_string(mesh));
    for (std::size_t p = 0; p < count; ++p) {
      add_part((*primitives)[p], name, {mesh, p}, place + ".primitives[" + std::to_string(p) + "]");
    }
    range.count = static_cast<std::uint32_t>(scene_.parts.size()) - range.first;
    part_ranges_.emplace(mesh, range);
    return range;
  }

  void add_part(const Json& primitive, const std::string& name, const std::pair<std::uint64_t, std::size_t>& number,
                const std::string& place) {
    const auto mode = static_cast<Mode>(whole_number(primitive, "mode", place).value_or(4));
    if (mode != Mode::kTriangles && mode != Mode::kStrip && mode != Mode::kFan) {
      add_note(scene_, Kind::kDropped, "primitives", 1, "points and lines are not drawn");
      return;
    }
    const Json* attributes = member(primitive, "attributes");
    const auto positions = attributes == nullptr ? std::nullopt : whole_number(*attributes, "POSITION", place);
    if (!positions) {
      add_note(scene_, Kind::kDropped, "primitives", 1, "no positions");
      return;
    }
    add_note(scene_, Kind::kWarning, "primitives", member(primitive, "targets") != nullptr ? 1 : 0, "morph targets are not applied");
    const GltfMaterial& material = materials_.material(whole_number(primitive, "material", place));
    if (const auto mesh = mesh_of(primitive, *attributes, mode, material, name, place))
      scene_.parts.push_back({*mesh, material.index, static_cast<std::int32_t>(number.first), static_cast<std::uint32_t>(number.second)});
  }

  // Primitives that differ in their material only share a mesh.
  std::optional<std::uint32_t> mesh_of(const Json& primitive, const Json& attributes, Mode mode, const GltfMaterial& material,
                                       const std::string& name, const std::string& place) {
    const std::string uv_name = "TEXCOORD_" + std::to_string(material.uv_set);
    const Json* indices = member(primitive, "indices");
    const bool transformed = material.textured && !material.uv_transform.identity();
    std::string key = attributes.dump() + uv_name + (indices == nullptr ? "-" : indices->dump()) + std::to_string(static_cast<int>(mode));
    if (transformed) key += "/" + std::to_string(material.index);
    const auto [found, fresh] = meshes_.try_emplace(key, std::nullopt);
    if (!fresh) return found->second;
    Mesh mesh = read_mesh(primitive, attributes, mode, uv_name, place);
    mesh.name = name;
    if (transformed) {
      for (glm::vec2& uv : mesh.uvs) uv = material.uv_transform.apply(uv);
    }
    if (!clean(mesh, scene_)) return std::nullopt;
    found->second = static_cast<std::uint32_t>(scene_.meshes.size());
    scene_.meshes.push_back(std::move(mesh));
    return found->second;
  }

  Mesh read_mesh(const Json& primitive, const Json& attributes, Mode mode, const std::string& uv_name, const std::string& place) {
    Mesh mesh;
    const auto accessor = [&](const std::string& attribute) { return whole_number(attributes, attribute.c_str(), place); };
    if (const auto positions = accessor("POSITION")) mesh.positions = file_.vectors<glm::vec3>(*positions);
    if (const auto normals = accessor("NORMAL")) mesh.normals = file_.vectors<glm::vec3>(*normals);
    if (const auto uvs = accessor(uv_name)) mesh.uvs = file_.vectors<glm::vec2>(*uvs);
    if (const auto indices = whole_number(primitive, "indices", place)) {
      mesh.indices = file_.indices(*indices);
    } else {
      mesh.indices.resize(mesh.positions.size());
      for (std::uint32_t i = 0; i < mesh.indices.size(); ++i) mesh.indices[i] = i;
    }
    if (mode != Mode::kTriangles) mesh.indices = separate(mesh.indices, mode);
    read_triangles_ += mesh.triangle_count();
    if (read_triangles_ > import_.options.max_triangles) {
      throw Failure(ErrorWord::kTooLarge, place + " brings the scene to " + std::to_string(read_triangles_) + " triangles, more than the " +
                                              std::to_string(import_.options.max_triangles) + " allowed");
    }
    return mesh;
  }

  Import& import_;
  Scene& scene_;
  GltfFile file_;
  GltfMaterials materials_;
  std::set<std::uint64_t> lower_levels_;                        // nodes
  std::map<std::uint64_t, PartRange> part_ranges_;              // by glTF mesh
  std::map<std::string, std::optional<std::uint32_t>> meshes_;  // by accessors; nothing where no triangle is left
  std::uint64_t read_triangles_ = 0;
  std::uint64_t drawn_triangles_ = 0, objects_ = 0, levels_ = 0;
};

}  // namespace

void read_gltf(Import& import, std::span<const std::uint8_t> bytes) {
  import.statement = {UpAxis::kY, 1.0, "glTF 2.0"};
  GltfReader(import, bytes).read();
}

}  // namespace standin
