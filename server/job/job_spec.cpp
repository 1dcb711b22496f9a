#include "server/job/job_spec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "render/base/error.h"
#include "server/job/value_check.h"

namespace standin {
namespace {

using nlohmann::json;

template <class T>
json type_schema() {
  if constexpr (std::is_same_v<T, std::string>)
    return {{"type", "string"}};
  else if constexpr (std::is_same_v<T, bool>)
    return {{"type", "boolean"}};
  else if constexpr (std::is_floating_point_v<T>)
    return {{"type", "number"}};
  else if constexpr (std::is_integral_v<T>)
    return {{"type", "integer"}};
  else if constexpr (std::is_same_v<T, std::vector<std::string>>)
    return {{"type", "array"}, {"items", {{"type", "string"}}}};
  else
    return {{"type", "array"}, {"items", {{"type", "number"}}}};
}

// A row for a plain member; `range` is merged into the value's schema, and checked by set_field.
template <class T>
SpecField field(std::string key, std::string flag, T JobSpec::*member, std::string help, json range = json::object(),
                bool in_result = true) {
  json schema = type_schema<T>();
  schema.update(range);
  return {std::move(key),
          std::move(flag),
          std::move(help),
          std::move(schema),
          in_result,
          [member](JobSpec& spec, const json& value) { spec.*member = value.get<T>(); },
          [member](const JobSpec& spec) { return json(spec.*member); }};
}

json at_least(double least) {
  return {{"minimum", least}};
}
json between(double least, double most) {
  return {{"minimum", least}, {"maximum", most}};
}
json above(double limit, double most = std::numeric_limits<double>::infinity()) {
  json range = {{"exclusiveMinimum", limit}};
  if (most < std::numeric_limits<double>::infinity()) range["maximum"] = most;
  return range;
}
json one_of(std::vector<std::string> words) {
  return {{"enum", std::move(words)}};
}

/// One or more, with commas between.
json names_of_techniques() {
  std::string any;
  for (const auto name : technique_names()) any += (any.empty() ? "" : "|") + std::string(name);
  return {{"pattern", "^(" + any + ")(,(" + any + "))*$"}, {"examples", {"layered,tdm"}}};
}

Box box_from_json(const json& value) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min[axis] = value.at("min").at(axis).get<double>();
    box.max[axis] = value.at("max").at(axis).get<double>();
  }
  return box;
}

json box_to_json(const Box& box) {
  return {{"min", {box.min.x, box.min.y, box.min.z}}, {"max", {box.max.x, box.max.y, box.max.z}}};
}

SpecField boxes_field() {
  const json corner = {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 3}, {"maxItems", 3}};
  const json box = {{"type", "object"},
                    {"required", {"min", "max"}},
                    {"properties", {{"min", corner}, {"max", corner}}},
                    {"additionalProperties", false}};
  return {"view_space.boxes",
          "",
          "boxes of positions, world coordinates in metres (for view_space.kind = boxes; configuration file only)",
          {{"type", "array"}, {"items", box}},
          true,
          [](JobSpec& spec, const json& value) {
            spec.boxes.clear();
            for (const auto& entry : value) {
              const Box parsed = box_from_json(entry);
              if (parsed.empty()) throw Failure(ErrorWord::kBadConfig, "a box with min > max: " + entry.dump());
              spec.boxes.push_back(parsed);
            }
          },
          [](const JobSpec& spec) {
            json list = json::array();
            for (const auto& entry : spec.boxes) list.push_back(box_to_json(entry));
            return list;
          }};
}

std::vector<SpecField> scene_fields() {
  return {
      field("budget_ms", "--budget-ms", &JobSpec::budget_ms, "frame-time budget in milliseconds", at_least(0.0)),
      field("scene.up", "--up", &JobSpec::up, "axis that points up in the scene file", one_of({"auto", "x", "y", "z"})),
      field("scene.unit", "--unit", &JobSpec::unit, "unit of the scene file: auto, m, cm, mm, in or metres per unit"),
      field("scene.split_triangles", "--split-triangles", &JobSpec::split_triangles, "split objects with more triangles; 0: never",
            at_least(0)),
      field("scene.split_extent", "--split-extent", &JobSpec::split_extent,
            "split objects longer than this share of the scene's diagonal; 0: never", between(0, 1)),
      field("scene.texture_folders", "--texture-folder", &JobSpec::texture_folders, "further folders to look for textures in",
            json::object(), false),
      field("scene.max_triangles", "--max-triangles", &JobSpec::max_triangles, "refuse scenes that draw more triangles", at_least(1),
            false),
      field("scene.max_texels", "--max-texels", &JobSpec::max_texels, "refuse scenes whose textures have more texels together", at_least(1),
            false),
      field("camera.fov_y_deg", "--fov-y-deg", &JobSpec::fov_y_deg, "vertical field of view in degrees", above(0.0, 150.0)),
      field("camera.width", "--width", &JobSpec::width, "image width in pixels", between(16, 8192)),
      field("camera.height", "--height", &JobSpec::height, "image height in pixels", between(16, 8192)),
  };
}

std::vector<SpecField> view_space_fields() {
  const json positive = above(0.0);
  return {
      field("view_space.kind", "--view-space", &JobSpec::view_space, "auto, walk, orbit, path:FILE or boxes",
            {{"pattern", "^(auto|walk|orbit|boxes|path:.+)$"}}),
      field("view_space.path_radius_m", "--path-radius-m", &JobSpec::path_radius_m, "half side of the boxes around a path's points",
            positive),
      boxes_field(),
      field("view_space.leaf_m", "--leaf-m", &JobSpec::leaf_m, "side of a 3D leaf cell in metres", positive),
      field("view_space.refine_levels", "--refine-levels", &JobSpec::refine_levels,
            "how often hot leaves are halved in position; their direction intervals are halved with every other halving", between(0, 6)),
      field("view_space.interval_deg", "--interval-deg", &JobSpec::interval_deg,
            "width of a view direction interval in degrees, in leaves that are not halved", between(1.0, 90.0)),
      field("view_space.eye_height_m", "--eye-height-m", &JobSpec::eye_height_m, "eye height above the ground, walk only", positive),
      field("view_space.max_leaves", "--max-leaves", &JobSpec::max_leaves, "leaves grow until there are fewer", between(1, 10'000'000)),
      field(
          "view_space.bounds", "--region-bounds", &JobSpec::region_bounds,
          "what a region's bound looks at: sample (the surface samples that its views may see), object (all of each such object), or view "
          "(single views that are sampled, with a margin of 5 %: no bound, nothing is promised)",
          one_of({"sample", "object", "view"})),
  };
}

std::vector<SpecField> visibility_fields() {
  return {
      field("visibility.mode", "--visibility", &JobSpec::visibility, "auto (where a probe finds occlusion), on or off",
            one_of({"auto", "on", "off"})),
      field("visibility.missed_share", "--visibility-missed-share", &JobSpec::visibility_missed_share,
            "share of a 3D leaf's uniform rays that may see an object outside its visible set, certified at 99 %", between(1e-7, 0.5)),
      field("visibility.rays", "--visibility-rays", &JobSpec::visibility_rays,
            "rays per 3D leaf, at most: where they do not suffice, a higher share is certified", between(1, 1e9)),
      field("lods.mode", "--lods", &JobSpec::lods,
            "geometric levels of detail: auto (where they save enough), on (wherever they save more than their bytes are worth) or off",
            one_of({"auto", "on", "off"})),
      field("lods.error_px", "--lods-error-px", &JobSpec::lods_error_px, "pixels by which a level of detail may move a point of the image",
            between(0.01, 64.0)),
  };
}

std::vector<SpecField> candidate_fields() {
  return {
      field("candidates.apex_deg", "--apex-deg", &JobSpec::apex_deg, "apex angles of shafts in degrees", {{"minItems", 1}}),
      field("candidates.direction_step_deg", "--direction-step-deg", &JobSpec::direction_step_deg, "step of shaft directions in degrees",
            between(1.0, 90.0)),
      field("candidates.cell_shape", "--cell-shape", &JobSpec::cell_shape,
            "shape of view cells: shaft (tight around the leaves served), pyramid (not tightened), box (nodes of the view space's grid) or "
            "cell (one 3D leaf)",
            one_of({"shaft", "pyramid", "box", "cell"})),
      field("impostors.techniques", "--techniques", &JobSpec::techniques,
            "techniques that impostors may be made with: one or more of layered, tdm, planar, lod-sprite, with commas between",
            names_of_techniques()),
      field("impostors.alpha_scale", "--alpha-scale", &JobSpec::alpha_scale, "parallax limit in centre pixels", between(0.1, 16.0)),
      field("impostors.texel_scale", "--texel-scale", &JobSpec::texel_scale, "texel size in centre pixels", between(0.1, 16.0)),
      field("impostors.max_layers", "--max-layers", &JobSpec::max_layers, "layers an impostor may have; 0: 200 for walk, 400 for orbit",
            between(0, 10'000)),
      field("impostors.fuzzy", "--fuzzy", &JobSpec::fuzzy,
            "masked surfaces (leaves) without their outlines: trees stay as airy as they are, but impostors that hold them may show gaps"),
  };
}

std::vector<SpecField> select_fields() {
  return {
      field("select.keep_picks", "--keep-picks", &JobSpec::keep_picks, "keep all that the greedy picked: no reverse-delete"),
      field("select.guided_sweeps", "--guided-sweeps", &JobSpec::guided_sweeps,
            "most sweeps and steps of the lower bound's search, each time constraints are added, before a second greedy at its prices; 0: "
            "no second greedy",
            between(0, 1000)),
      field("select.exchange_rounds", "--exchange-rounds", &JobSpec::exchange_rounds, "rounds of exchange after reverse-delete",
            between(0, 100)),
      field("select.recreate_trials", "--recreate-trials", &JobSpec::recreate_trials,
            "trials of taking part of the first selection down and building it again", between(0, 1e9)),
      field("select.work_limit_gains", "--work", &JobSpec::work_limit_gains,
            "gains that all selections may look at; what is then unfinished is named; 0: no limit", at_least(0)),
      field("select.deadline_s", "--deadline", &JobSpec::deadline_s,
            "wall seconds that selections may take; what is then unfinished is named, and another run may end elsewhere; 0: no deadline",
            at_least(0.0)),
      field("select.bound_iterations", "--bound-iterations", &JobSpec::bound_iterations,
            "most sweeps and subgradient steps of the lower bound, each time constraints are added; it ends when they gain next to "
            "nothing; 0: no bound",
            between(0, 100'000)),
      field("select.bake_rounds", "--bake-rounds", &JobSpec::bake_rounds, "rounds of baking and repair", between(1, 20)),
      field("select.size_bakes", "--size-bakes", &JobSpec::size_bakes, "impostors baked to fit the size model; 0: default model",
            between(0, 10'000)),
  };
}

std::vector<SpecField> run_fields() {
  return {
      field("device", "--device", &JobSpec::device, "off-screen device", one_of({"osmesa", "egl"}), false),
      field("survey.views", "--survey-views", &JobSpec::survey_views, "sampled single views", between(1, 1e8)),
      field("verify.views", "--verify-views", &JobSpec::verify_views, "views that place renders for verification", between(0, 100'000),
            false),
      field("sweep.budgets_ms", "--budgets-ms", &JobSpec::sweep_budgets_ms,
            "budgets of a sweep in milliseconds, with commas between; none: those of the baseline, or 10 between reachable and needless",
            {{"items", {{"type", "number"}, {"exclusiveMinimum", 0.0}}}, {"maxItems", 1000}}, false),
      field("sweep.tolerance", "--tolerance", &JobSpec::sweep_tolerance,
            "growth of memory at a budget, relative to the baseline's, that a sweep lets pass", between(0.0, 1000.0), false),
      field("seed", "--seed", &JobSpec::seed, "seed of everything random", at_least(0)),
      field("force", "--force", &JobSpec::force, "stages that leave nothing out, also where that cannot change the result",
            {{"items", {{"type", "string"}, {"enum", {"all", "visibility", "lods", "candidates", "bake"}}}}}, false),
      field("threads", "--threads", &JobSpec::threads, "threads; 0: one per processor", between(0, 1024), false),
      field("cache.folder", "--cache", &JobSpec::cache,
            "folder of stages' results, each named by all that it depends on: what is there is not done again, what is not is added; "
            "empty: none",
            json::object(), false),
      field("cache.update", "--update", &JobSpec::update, "delete what the job did not use from the cache's folder", json::object(), false),
  };
}

std::vector<SpecField> make_fields() {
  std::vector<SpecField> all;
  for (const auto& section : {scene_fields(), view_space_fields(), visibility_fields(), candidate_fields(), select_fields(), run_fields()})
    all.insert(all.end(), section.begin(), section.end());
  return all;
}

json::json_pointer pointer_of(const std::string& key) {
  std::string path = "/" + key;
  for (auto& c : path)
    if (c == '.') c = '/';
  return json::json_pointer(path);
}

/// Ascending, each once. Nothing where some name is unknown, or there is none.
std::optional<std::vector<Technique>> parse_techniques(const std::string& text) {
  std::array<bool, kTechniqueCount> named{};
  std::istringstream stream(text + ",");
  for (std::string name; std::getline(stream, name, ',');) {
    const auto technique = technique_named(name);
    if (!technique) return std::nullopt;
    named.at(static_cast<std::size_t>(*technique)) = true;
  }
  std::vector<Technique> techniques;
  for (std::size_t t = 0; t < kTechniqueCount; ++t)
    if (named.at(t)) techniques.push_back(static_cast<Technique>(t));
  return techniques;
}

/// The same techniques are the same job, in whatever order they are named.
std::string in_order(const json& value, const std::string& place) {
  const auto techniques = parse_techniques(value);
  if (!techniques) reject_value(place, value, "one or more of layered, tdm, planar, lod-sprite, with commas between");
  std::string text;
  for (const Technique technique : *techniques) text += (text.empty() ? "" : ",") + std::string(technique_name(technique));
  return text;
}

const SpecField* find_field(const std::string& key) {
  for (const auto& field : spec_fields())
    if (field.key == key) return &field;
  return nullptr;
}

bool is_section(const std::string& key) {
  for (const auto& field : spec_fields())
    if (field.key.starts_with(key + ".")) return true;
  return false;
}

void visit_settings(const json& object, const SettingPlace& section, const std::function<void(const SettingPlace&, const json&)>& visit) {
  for (const auto& [name, value] : object.items()) {
    SettingPlace place{nullptr, section.key.empty() ? name : section.key + "." + name, section.pointer / name};
    place.field = find_field(place.key);
    if (place.field == nullptr && value.is_object() && is_section(place.key))
      visit_settings(value, place, visit);
    else
      visit(place, value);
  }
}

}  // namespace

const std::vector<SpecField>& spec_fields() {
  static const std::vector<SpecField> fields = make_fields();
  return fields;
}

std::vector<Technique> techniques_of(const JobSpec& spec) {
  return parse_techniques(spec.techniques).value();
}

bool forced(const JobSpec& spec, std::string_view stage) {
  return std::ranges::any_of(spec.force, [&](const std::string& word) { return word == stage || word == "all"; });
}

void set_field(JobSpec& spec, const SpecField& field, const json& value, const std::string& place) {
  check_value(field.schema, value, place);
  if (field.key == "view_space.kind") {
    const std::string kind = value;
    const bool known =
        kind == "auto" || kind == "walk" || kind == "orbit" || kind == "boxes" || (kind.starts_with("path:") && kind.size() > 5);
    if (!known) reject_value(place, value, "auto, walk, orbit, boxes or path:FILE");
  }
  field.set(spec, field.key == "impostors.techniques" ? json(in_order(value, place)) : value);
}

void set_field_from_text(JobSpec& spec, const SpecField& field, const std::string& text) {
  const std::string type = field.schema.at("type");
  json value = text;
  if (type != "string") {
    const bool string_items = type == "array" && field.schema.at("items").at("type") == "string";
    if (string_items) {
      value = field.get(spec);
      value.push_back(text);
    } else {
      value = json::parse(type == "array" ? "[" + text + "]" : text, nullptr, false);
      if (value.is_discarded()) reject_value(field.flag, text, "a value of type " + type);
    }
  }
  set_field(spec, field, value, field.flag);
}

void for_each_setting(const json& object, const std::function<void(const SettingPlace&, const json&)>& visit) {
  visit_settings(object, SettingPlace{nullptr, "", json::json_pointer()}, visit);
}

void read_object_into(JobSpec& spec, const json& object, const std::string& source) {
  for_each_setting(object, [&](const SettingPlace& place, const json& value) {
    if (place.field == nullptr) throw Failure(ErrorWord::kBadConfig, source + place.key + " = " + value.dump() + " is not a known setting");
    set_field(spec, *place.field, value, source + place.key);
  });
}

json to_json(const JobSpec& spec, bool result_only) {
  json object = json::object();
  for (const auto& field : spec_fields())
    if (field.in_result || !result_only) object[pointer_of(field.key)] = field.get(spec);
  return object;
}

json changed_settings(const JobSpec& spec) {
  const JobSpec defaults;
  json changed = json::object();
  for (const auto& field : spec_fields())
    if (json value = field.get(spec); value != field.get(defaults)) changed[pointer_of(field.key)] = std::move(value);
  return changed;
}

JobSpec spec_from_json(const json& object) {
  JobSpec spec;
  read_object_into(spec, object, "");
  return spec;
}

json spec_schema(bool (*left_out)(const std::string& key)) {
  json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Standin job"}, {"type", "object"}};
  schema["additionalProperties"] = false;
  const json defaults = to_json(JobSpec{}, false);
  for (const auto& field : spec_fields()) {
    if (left_out(field.key)) continue;
    json entry = field.schema;
    entry["description"] = field.help;
    entry["default"] = defaults.at(pointer_of(field.key));
    const auto dot = field.key.find('.');
    if (dot == std::string::npos) {
      schema["properties"][field.key] = entry;
    } else {
      json& section = schema["properties"][field.key.substr(0, dot)];
      section["type"] = "object";
      section["additionalProperties"] = false;
      section["properties"][field.key.substr(dot + 1)] = entry;
    }
  }
  return schema;
}

}  // namespace standin
