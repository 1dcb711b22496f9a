// The one description of a job: what the command line, configuration files, the service and tests all fill in.
//
// Defaults live here and nowhere else. Every setting has one row in spec_fields(): its key in a configuration file, its flag, its help, its
// range. The parser, --help,
// --print-config, the JSON Schema and the README's table are made from these rows (or checked against them by a test).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/geometry.h"
#include "render/impostor/impostor.h"

namespace standin {

struct JobSpec {
  double budget_ms = 0.0;  // > 0 where a command needs one

  std::string up = "auto";
  std::string unit = "auto";  // m, cm, mm, in or a factor
  std::uint64_t split_triangles = 100'000;
  double split_extent = 0.125;
  std::vector<std::string> texture_folders;
  std::uint64_t max_triangles = 200'000'000;  // drawn, in all; a scene with more is refused
  std::uint64_t max_texels = 1'000'000'000;   // of all its textures

  double fov_y_deg = 45.0;
  int width = 512;
  int height = 512;

  std::string view_space = "auto";  // auto, walk, orbit, path:FILE or boxes
  double path_radius_m = 2.0;
  std::vector<Box> boxes;  // for view_space = boxes; given in the configuration file
  double leaf_m = 23.0;
  int refine_levels = 3;
  double interval_deg = 11.25;
  double eye_height_m = 1.7;
  std::uint64_t max_leaves = 20'000;
  std::string region_bounds = "sample";

  std::string visibility = "auto";  // auto: where a probe finds occlusion; on; off
  double visibility_missed_share = 1e-4;
  std::uint64_t visibility_rays = 1'000'000;

  std::string lods = "auto";  // where they save enough; on; off
  double lods_error_px = 1.0;

  std::vector<double> apex_deg = {11.25, 22.5, 45.0, 90.0};
  double direction_step_deg = 11.25;
  std::string cell_shape = "shaft";

  double alpha_scale = 1.0;
  double texel_scale = 1.0;
  std::uint32_t max_layers = 0;  // 0: 200 for walk, 400 for orbit
  bool fuzzy = false;            // masked surfaces without outlines: no image promise where they are
  bool keep_picks = false;
  int guided_sweeps = 30;
  int exchange_rounds = 0;
  std::uint64_t recreate_trials = 0;
  std::uint64_t work_limit_gains = 0;  // 0: none
  double deadline_s = 0.0;             // 0: none
  int bound_iterations = 100;
  int bake_rounds = 10;
  std::uint32_t size_bakes = 48;

  std::string techniques = "layered";  // names with commas between, in the order of the enumeration; techniques_of() reads them
  std::string device = "osmesa";
  std::uint64_t survey_views = 20'000;
  std::uint32_t verify_views = 32;
  std::vector<double> sweep_budgets_ms;  // empty: those of a baseline or of criteria, or some that are chosen
  double sweep_tolerance = 0.02;         // relative
  std::uint64_t seed = 1;
  std::vector<std::string> force;  // stages that leave nothing out; "all": every one
  int threads = 0;                 // 0: one per processor; never part of a result
  std::string cache;               // folder of results that outlive the job; empty: none; never part of a result
  bool update = false;             // delete of it what this job does not use
};

struct SpecField {
  std::string key;   // "view_space.leaf_m"
  std::string flag;  // "--leaf-m"
  std::string help;
  nlohmann::json schema;  // JSON Schema of the value, with its range
  bool in_result = true;  // false: cannot change a result, so placement.json does not carry it
  std::function<void(JobSpec&, const nlohmann::json&)> set;
  std::function<nlohmann::json(const JobSpec&)> get;
};

[[nodiscard]] const std::vector<SpecField>& spec_fields();

/// What candidates may be made with, at least one, ascending.
[[nodiscard]] std::vector<Technique> techniques_of(const JobSpec& spec);

/// Whether the stage is to do also what cannot change the result.
[[nodiscard]] bool forced(const JobSpec& spec, std::string_view stage);

/// Sets one field from a JSON value. Throws Failure(kBadConfig) naming `place` (a path into a file, or a flag), the value and the
/// constraint.
void set_field(JobSpec& spec, const SpecField& field, const nlohmann::json& value, const std::string& place);
/// Sets one field from the text of a flag.
void set_field_from_text(JobSpec& spec, const SpecField& field, const std::string& text);
/// Where a value of a nested object stands: its field, if its key is known, and the way to it.
struct SettingPlace {
  const SpecField* field = nullptr;
  std::string key;                                                        // "view_space.leaf_m"
  nlohmann::json::json_pointer pointer = nlohmann::json::json_pointer();  // "/view_space/leaf_m"
};
/// Visits every value of a nested object of settings; of a section that is no object, the section's.
void for_each_setting(const nlohmann::json& object, const std::function<void(const SettingPlace&, const nlohmann::json&)>& visit);
/// Reads the keys of a nested object; `source` prefixes messages. Unknown keys are errors with their path.
void read_object_into(JobSpec& spec, const nlohmann::json& object, const std::string& source);
/// Reads a TOML file into `spec`. Unknown keys are errors with their path.
void read_config(JobSpec& spec, const std::filesystem::path& file);

/// Nested object of all keys; `result_only` leaves out what cannot change a result.
[[nodiscard]] nlohmann::json to_json(const JobSpec& spec, bool result_only);
/// Those that are not the defaults.
[[nodiscard]] nlohmann::json changed_settings(const JobSpec& spec);
[[nodiscard]] JobSpec spec_from_json(const nlohmann::json& object);
/// The job's JSON Schema (configs/job.schema.json is this text), without the settings that `left_out` names by their key.
[[nodiscard]] nlohmann::json spec_schema(bool (*left_out)(const std::string& key) = [](const std::string&) { return false; });

}  // namespace standin
