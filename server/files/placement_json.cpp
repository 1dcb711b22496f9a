#include "server/files/placement_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <glm/trigonometric.hpp>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include "render/base/error.h"

namespace standin {
namespace {

using nlohmann::json;

// A number of the file as an integer: whole, and within the integer's range, since a cast of any other means nothing.
class Whole {
 public:
  explicit Whole(const json& value) : value_(value) {}
  template <std::integral Integer>
  operator Integer() const {
    constexpr double kExact = 9007199254740992.0;  // up to here doubles count
    const double least = static_cast<double>(std::numeric_limits<Integer>::min());
    const double most = std::min(static_cast<double>(std::numeric_limits<Integer>::max()), kExact);
    const double number = value_.get<double>();
    if (number != std::floor(number) || number < least || number > most)
      throw Failure(ErrorWord::kFileBroken, value_.dump() + " is not a whole number that may stand there");
    return value_.get<Integer>();
  }

 private:
  const json& value_;
};

std::vector<std::uint32_t> to_ids(const json& list) {
  std::vector<std::uint32_t> ids;
  if (!list.is_array()) throw Failure(ErrorWord::kFileBroken, list.dump() + " is not a list of ids");
  for (const json& id : list) ids.push_back(Whole(id));
  return ids;
}

json to_json_array(const Vec3& v) {
  return {v.x, v.y, v.z};
}
json to_json_array(const Vec2& v) {
  return {v.x, v.y};
}
Vec3 to_vec3(const json& value) {
  return {value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>()};
}
Vec2 to_vec2(const json& value) {
  return {value.at(0).get<double>(), value.at(1).get<double>()};
}
json box_json(const Box& box) {
  return {{"min", to_json_array(box.min)}, {"max", to_json_array(box.max)}};
}
Box to_box(const json& value) {
  return {to_vec3(value.at("min")), to_vec3(value.at("max"))};
}

json boxes_json(const std::vector<Box>& boxes) {
  json list = json::array();
  for (const auto& box : boxes) list.push_back(box_json(box));
  return list;
}

const char* kind_name(ViewSpaceKind kind) {
  switch (kind) {
    case ViewSpaceKind::kWalk:
      return "walk";
    case ViewSpaceKind::kOrbit:
      return "orbit";
    case ViewSpaceKind::kPath:
      return "path";
    case ViewSpaceKind::kBoxes:
      break;
  }
  return "boxes";
}

ViewSpaceKind kind_of(const std::string& name) {
  for (const auto kind : {ViewSpaceKind::kWalk, ViewSpaceKind::kOrbit, ViewSpaceKind::kPath, ViewSpaceKind::kBoxes})
    if (name == kind_name(kind)) return kind;
  throw Failure(ErrorWord::kFileBroken, "view_space.kind = \"" + name + "\" is not walk, orbit, path or boxes");
}

json scene_json(const PlacementFile& file, const Scene& scene) {
  json objects = json::array();
  for (std::size_t id = 0; id < scene.objects.size(); ++id) {
    const Object& object = scene.objects[id];
    objects.push_back({{"id", id}, {"name", object.name}, {"gltf_node", object.gltf_node}, {"bounds", box_json(object.bounds)}});
  }
  return {{"name", file.scene_name}, {"sha256", file.scene_sha256}, {"objects", std::move(objects)}};
}

json faces_json() {
  json faces = json::object();
  for (int i = 0; i < kFaceCount; ++i) {
    const FaceFrame& frame = face_frame(static_cast<Face>(i));
    faces[std::string(frame.name)] = {{"n", to_json_array(frame.n)}, {"u", to_json_array(frame.u)}, {"v", to_json_array(frame.v)}};
  }
  return faces;
}

json view_space_json(const ViewSpace& space) {
  return {{"kind", kind_name(space.kind)},
          {"why", space.why},
          {"root",
           {{"min", to_json_array(space.root_min)},
            {"side", space.root_side_m},
            {"leaf_level", space.leaf_level},
            {"finest_level", space.finest_level}}},
          {"boxes", boxes_json(space.boxes)}};
}

ViewSpace to_view_space(const json& value) {
  ViewSpace space;
  space.kind = kind_of(value.at("kind"));
  space.why = value.at("why");
  for (const auto& box : value.at("boxes")) space.boxes.push_back(to_box(box));
  space.volume_sum = volume_sums(space.boxes);
  const json& root = value.at("root");
  space.root_min = to_vec3(root.at("min"));
  space.root_side_m = root.at("side");
  space.leaf_level = Whole(root.at("leaf_level"));
  space.finest_level = Whole(root.at("finest_level"));
  return space;
}

json cells_json(const Placement& placement) {
  json cells = json::array();
  for (const auto& cell : placement.cells) {
    json entry = box_json(cell.box);
    entry["level"] = cell.key.level;
    entry["index"] = cell.key.index;
    entry["visible_objects"] = cell.visible_set < 0 ? json() : json(placement.visible_sets[static_cast<std::size_t>(cell.visible_set)]);
    cells.push_back(std::move(entry));
  }
  return cells;
}

// Cells that share a visible set are written with it each, and find each other again here.
void read_cells(const json& cells, Placement& placement) {
  std::map<std::vector<std::uint32_t>, std::int32_t> known;
  for (const auto& entry : cells) {
    const json& index = entry.at("index");
    PlacementCell cell{{Whole(entry.at("level")), {Whole(index.at(0)), Whole(index.at(1)), Whole(index.at(2))}}, to_box(entry), -1};
    if (!entry.at("visible_objects").is_null()) {
      auto objects = to_ids(entry.at("visible_objects"));
      const auto [position, is_new] = known.try_emplace(objects, static_cast<std::int32_t>(placement.visible_sets.size()));
      if (is_new) placement.visible_sets.push_back(std::move(objects));
      cell.visible_set = position->second;
    }
    placement.cells.push_back(cell);
  }
}

json intervals_json(const std::vector<DirectionInterval>& intervals) {
  json list = json::array();
  for (const auto& interval : intervals) {
    const auto angles = interval.angles_rad();
    list.push_back({{"face", face_frame(interval.face).name},
                    {"u_deg", {glm::degrees(angles[0]), glm::degrees(angles[1])}},
                    {"v_deg", {glm::degrees(angles[2]), glm::degrees(angles[3])}},
                    {"level", interval.level},
                    {"index", {interval.i, interval.j}}});
  }
  return list;
}

DirectionInterval to_interval(const json& value) {
  const std::string name = value.at("face");
  for (int i = 0; i < kFaceCount; ++i) {
    const auto face = static_cast<Face>(i);
    if (face_frame(face).name == name)
      return {face, Whole(value.at("level")), Whole(value.at("index").at(0)), Whole(value.at("index").at(1))};
  }
  throw Failure(ErrorWord::kFileBroken, "interval face \"" + name + "\" is not one of +x -x +y -y +z -z");
}

json cpvs_json(const std::vector<PlacementCpv>& cpvs) {
  json list = json::array();
  for (const auto& cpv : cpvs)
    list.push_back({{"cell", cpv.cell},
                    {"interval", cpv.interval},
                    {"bound_before_ms", cpv.bound_before_ms},
                    {"bound_after_ms", cpv.bound_after_ms},
                    {"solved", cpv.solved},
                    {"impostors", cpv.impostors}});
  return list;
}

PlacementCpv to_cpv(const json& value) {
  return {Whole(value.at("cell")),    Whole(value.at("interval")), value.at("bound_before_ms"),
          value.at("bound_after_ms"), value.at("solved"),          to_ids(value.at("impostors"))};
}

json view_cell_json(const ViewCell& cell) {
  if (const auto* box = std::get_if<Box>(&cell)) {
    json entry = box_json(*box);
    entry["kind"] = "box";
    return entry;
  }
  const auto& shaft = std::get<Shaft>(cell);
  const auto& [a, r, u] = std::tie(shaft.axis, shaft.right, shaft.up);
  return {{"kind", "shaft"},
          {"apex", to_json_array(shaft.apex)},
          {"frame", {a.x, a.y, a.z, r.x, r.y, r.z, u.x, u.y, u.z}},
          {"tan_half", to_json_array(shaft.tan_half)},
          {"min_distance", shaft.min_distance_m}};
}

ViewCell to_view_cell(const json& value) {
  if (value.at("kind") == "box") return to_box(value);
  const auto f = value.at("frame").get<std::array<double, 9>>();
  return Shaft{to_vec3(value.at("apex")),     {f[0], f[1], f[2]},      {f[3], f[4], f[5]}, {f[6], f[7], f[8]},
               to_vec2(value.at("tan_half")), value.at("min_distance")};
}

json impostor_json(std::size_t id, const PlacementImpostor& impostor) {
  json layers = json::array();
  for (const auto& layer : impostor.layers)
    layers.push_back({{"distance", layer.distance_m}, {"near", layer.near_m}, {"far", layer.far_m}});
  const ImpostorFrame& frame = impostor.frame;
  return {{"id", id},
          {"technique", impostor.technique},
          {"guarantee", impostor.guarantee},
          {"objects", impostor.objects},
          {"view_cell", view_cell_json(impostor.view_cell)},
          {"reference_viewpoint", to_json_array(frame.reference_viewpoint)},
          {"image_plane",
           {{"forward", to_json_array(frame.forward)},
            {"right", to_json_array(frame.right)},
            {"up", to_json_array(frame.up)},
            {"slope_min", to_json_array(frame.slope_min)},
            {"slope_step", to_json_array(frame.slope_step)}}},
          {"resolution", {frame.width, frame.height}},
          {"layers", std::move(layers)},
          {"quads", impostor.quads},
          {"texels", impostor.texels},
          {"texture_bytes", impostor.texture_bytes},
          {"geometry_bytes", impostor.geometry_bytes},
          {"time_bound_ms", impostor.time_bound_ms},
          {"gltf_node", "imp_" + std::to_string(id)},
          {"shares_texture_of", nullptr}};
}

PlacementImpostor to_impostor(const json& value) {
  PlacementImpostor impostor;
  impostor.technique = value.at("technique");
  impostor.guarantee = value.at("guarantee");
  impostor.objects = to_ids(value.at("objects"));
  impostor.view_cell = to_view_cell(value.at("view_cell"));
  const json& plane = value.at("image_plane");
  impostor.frame = {to_vec3(value.at("reference_viewpoint")),
                    to_vec3(plane.at("forward")),
                    to_vec3(plane.at("right")),
                    to_vec3(plane.at("up")),
                    to_vec2(plane.at("slope_min")),
                    to_vec2(plane.at("slope_step")),
                    Whole(value.at("resolution").at(0)),
                    Whole(value.at("resolution").at(1))};
  for (const auto& layer : value.at("layers")) impostor.layers.push_back({layer.at("distance"), layer.at("near"), layer.at("far")});
  impostor.quads = Whole(value.at("quads"));
  impostor.texels = Whole(value.at("texels"));
  impostor.texture_bytes = Whole(value.at("texture_bytes"));
  impostor.geometry_bytes = Whole(value.at("geometry_bytes"));
  impostor.time_bound_ms = value.at("time_bound_ms");
  return impostor;
}

json matrix_json(const Mat4& matrix) {
  json list = json::array();
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) list.push_back(matrix[column][row]);
  return list;
}

json optional_matrix_json(const std::optional<Mat4>& matrix) {
  return matrix ? matrix_json(*matrix) : json();
}

std::optional<Mat4> to_matrix(const json& value) {
  if (value.is_null()) return std::nullopt;
  const auto numbers = value.get<std::array<double, 16>>();
  Mat4 matrix(1.0);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) matrix[column][row] = numbers.at(static_cast<std::size_t>(4 * column + row));
  return matrix;
}

json level_json(const StatedLevel& level) {
  return {{"least_distance", level.least_distance_m},
          {"error", level.error_m < 0.0 ? json() : json(level.error_m)},
          {"triangles", level.triangle_count},
          {"gltf_node", level.gltf_node}};
}

// Null where all objects always show what the scene holds.
json lods_json(const PlacementFile& file, const Scene& scene) {
  if (file.lods_sha256.empty()) return nullptr;
  json objects = json::array();
  for (const StatedLevel& level : stated_levels(scene)) {
    if (objects.empty() || objects.back()["object"] != level.object)
      objects.push_back({{"object", level.object},
                         {"world_from_object", optional_matrix_json(level_transform(scene, scene.objects[level.object]))},
                         {"levels", json::array()}});
    objects.back()["levels"].push_back(level_json(level));
  }
  return {{"asset", {{"file", "lods.glb"}, {"sha256", file.lods_sha256}}}, {"objects", std::move(objects)}};
}

void read_lods(const json& lods, const json& objects, PlacementFile& file) {
  if (lods.is_null()) return;
  file.lods_sha256 = lods.at("asset").at("sha256");
  for (const auto& entry : lods.at("objects")) {
    PlacementLevels levels{Whole(entry.at("object")), {}, {}, to_matrix(entry.at("world_from_object"))};
    if (levels.object >= objects.size()) throw Failure(ErrorWord::kFileBroken, "lods.objects names an object that does not exist");
    levels.bounds = to_box(objects.at(levels.object).at("bounds"));
    for (const auto& level : entry.at("levels")) {
      const json& error = level.at("error");
      file.lods.push_back({levels.object, level.at("gltf_node"), level.at("least_distance"), error.is_null() ? -1.0 : error.get<double>(),
                           Whole(level.at("triangles"))});
      levels.least_distance_m.push_back(level.at("least_distance"));
    }
    const bool in_order = file.placement.levels.empty() || file.placement.levels.back().object < levels.object;
    if (!in_order || !std::ranges::is_sorted(levels.least_distance_m) || levels.least_distance_m.size() > 255)
      throw Failure(ErrorWord::kFileBroken, "lods.objects: object " + std::to_string(levels.object) + " or its levels are out of order");
    file.placement.levels.push_back(std::move(levels));
  }
}

// Indices must be in range before anything follows them.
void check_references(const Placement& placement, std::size_t object_count) {
  const auto require = [](bool ok, const std::string& what) {
    if (!ok) throw Failure(ErrorWord::kFileBroken, what + " is out of range");
  };
  for (std::size_t p = 0; p < placement.cpvs.size(); ++p) {
    const auto& cpv = placement.cpvs[p];
    const std::string place = "cpvs[" + std::to_string(p) + "]";
    require(cpv.cell < placement.cells.size(), place + ".cell");
    require(cpv.interval < placement.intervals.size(), place + ".interval");
    for (const auto id : cpv.impostors) require(id < placement.impostors.size(), place + ".impostors");
  }
  for (std::size_t i = 0; i < placement.impostors.size(); ++i)
    for (const auto object : placement.impostors[i].objects) require(object < object_count, "impostors[" + std::to_string(i) + "].objects");
  for (const auto& set : placement.visible_sets)
    for (const auto object : set) require(object < object_count, "visible_objects");
}

PlacementFile parse(const json& object) {
  if (object.at("format") != "standin.placement" || object.at("version") != 1)
    throw Failure(ErrorWord::kFileBroken, "format " + object.at("format").dump() + " version " + object.at("version").dump() +
                                              " is not standin.placement version 1");
  PlacementFile file;
  file.spec = spec_from_json(object.at("spec"));
  file.scene_name = object.at("scene").at("name");
  file.scene_sha256 = object.at("scene").at("sha256");
  file.target_id = object.at("target").at("id");
  file.target_sha256 = object.at("target").at("sha256");
  file.coverage = object.at("target").at("coverage");
  const json& camera = object.at("camera");
  file.camera.fov_y_rad = glm::radians(camera.at("fov_y_deg").get<double>());
  file.camera.width = Whole(camera.at("width"));
  file.camera.height = Whole(camera.at("height"));
  file.view_space = to_view_space(object.at("view_space"));
  file.atlas_pages = Whole(object.at("atlas_pages"));
  Placement& placement = file.placement;
  read_cells(object.at("cells"), placement);
  for (const auto& entry : object.at("intervals")) placement.intervals.push_back(to_interval(entry));
  for (const auto& entry : object.at("cpvs")) placement.cpvs.push_back(to_cpv(entry));
  for (const auto& entry : object.at("impostors")) placement.impostors.push_back(to_impostor(entry));
  read_lods(object.at("lods"), object.at("scene").at("objects"), file);
  placement.root_min = file.view_space.root_min;
  placement.root_side_m = file.view_space.root_side_m;
  check_references(placement, object.at("scene").at("objects").size());
  return file;
}

}  // namespace

json placement_to_json(const PlacementFile& file, const Scene& scene) {
  const Placement& placement = file.placement;
  json impostors = json::array();
  for (std::size_t id = 0; id < placement.impostors.size(); ++id) impostors.push_back(impostor_json(id, placement.impostors[id]));
  json spec = to_json(file.spec, true);
  return {{"format", "standin.placement"},
          {"version", 1},
          {"spec", std::move(spec)},
          {"seed", file.spec.seed},
          {"units",
           {{"metres_per_unit", 1}, {"world_from_gltf", matrix_json(Mat4(1.0))}, {"world_from_file", matrix_json(scene.world_from_file)}}},
          {"scene", scene_json(file, scene)},
          {"target", {{"id", file.target_id}, {"sha256", file.target_sha256}, {"coverage", file.coverage}}},
          {"budget_ms", file.spec.budget_ms},
          {"camera", {{"fov_y_deg", file.spec.fov_y_deg}, {"width", file.camera.width}, {"height", file.camera.height}, {"up", {0, 1, 0}}}},
          {"view_space", view_space_json(file.view_space)},
          {"atlas_pages", file.atlas_pages},
          {"lods", lods_json(file, scene)},
          {"cells", cells_json(placement)},
          {"faces", faces_json()},
          {"intervals", intervals_json(placement.intervals)},
          {"cpvs", cpvs_json(placement.cpvs)},
          {"impostors", std::move(impostors)}};
}

PlacementFile placement_from_json(const json& object, const std::string& name) {
  try {
    return parse(object);
  } catch (const json::exception& error) {
    throw Failure(ErrorWord::kFileBroken, name + ": " + error.what());
  } catch (const Failure& failure) {
    throw Failure(failure.word(), name + ": " + failure.what());
  }
}

}  // namespace standin
