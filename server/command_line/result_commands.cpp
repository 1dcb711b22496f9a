// check, verify and report: what was placed, looked at again.
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "placement/check/check.h"
#include "render/base/error.h"
#include "render/base/json_text.h"
#include "render/base/sha256.h"
#include "render/base/staged_file.h"
#include "render/scene/hierarchy.h"
#include "render/scene/load.h"
#include "server/command_line/commands.h"
#include "server/files/placement_json.h"
#include "server/job/lods.h"
#include "server/job/metrics.h"
#include "server/job/target_device.h"
#include "server/job/world.h"
#include "server/pipeline.h"
#include "server/report/pictures.h"
#include "server/report/report.h"
#include "server/report/sweep_report.h"
#include "server/verify/shipped_impostors.h"
#include "server/verify/verify.h"
#include "server/verify/verify_json.h"

namespace standin {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json read_json(const fs::path& file) {
  return parse_json(read_file(file), file.string());
}

// A result folder with its inputs opened again; inputs that changed since are refused.
struct OpenedPlacement {
  PlacementFile file;
  Scene scene;
  Hierarchy hierarchy;
  Target target;
  std::uint64_t lods_bytes = 0;  // of the buffers of lods.glb
};

std::string input_path(const CommandContext& context, const std::string& given, const char* which) {
  if (!given.empty()) return given;
  const fs::path file = fs::path(context.arguments.folder) / kInputsFile;
  if (!fs::exists(file))
    throw Failure(ErrorWord::kBadUsage, context.arguments.folder + " does not say where its " + which + " is: give --" + which);
  return read_json(file).at(which).get<std::string>();
}

void require_same(const std::string& what, const std::string& path, const std::string& is, const std::string& was) {
  if (is != was) throw Failure(ErrorWord::kFileBroken, what + " " + path + " has SHA-256 " + is + ", the placement was made for " + was);
}

// Levels come from the file that ships: what is drawn, estimated and checked is what it holds.
void open_levels(const CommandContext& context, OpenedPlacement& opened) {
  if (opened.file.lods_sha256.empty()) return remove_all_levels(opened.scene);
  const fs::path file = fs::path(context.arguments.folder) / "lods.glb";
  const std::string glb = read_file(file);
  require_same("levels of detail", file.string(), sha256_hex(glb), opened.file.lods_sha256);
  opened.lods_bytes = read_levels(opened.file.lods, glb, opened.scene);
  for (const PlacementLevels& levels : opened.file.placement.levels)
    if (levels.world_from_object != level_transform(opened.scene, opened.scene.objects[levels.object]))
      throw Failure(ErrorWord::kFileBroken,
                    "placement.json: lods: world_from_object of object " + std::to_string(levels.object) + " differs from the scene's");
}

OpenedPlacement open_placement(const CommandContext& context) {
  const fs::path file = fs::path(context.arguments.folder) / "placement.json";
  OpenedPlacement opened{placement_from_json(read_json(file), file.string()), {}, {}, {}};
  const std::string scene_path = input_path(context, context.arguments.scenes.empty() ? "" : context.arguments.scenes.front(), "scene");
  JobSpec spec = opened.file.spec;
  spec.texture_folders = context.spec.texture_folders;
  spec.max_triangles = context.spec.max_triangles;
  spec.max_texels = context.spec.max_texels;
  opened.scene = load_scene(scene_path, load_options(spec));
  require_same("scene", scene_path, opened.scene.sha256, opened.file.scene_sha256);
  open_levels(context, opened);
  opened.hierarchy = build_hierarchy(opened.scene);
  const std::string target_path = input_path(context, context.arguments.target, "target");
  opened.target = read_target(target_path);
  require_same("target", target_path, opened.target.sha256, opened.file.target_sha256);
  return opened;
}

json check_json(const CheckReport& report, std::uint64_t lods_bytes) {
  json findings = json::array();
  for (const auto& finding : report.findings)
    findings.push_back({{"violation", violation_name(finding.violation)}, {"index", finding.index}, {"sentence", finding.sentence}});
  return {{"cpvs", report.cpvs},
          {"solved", report.solved},
          {"regions", report.regions},
          {"texture_bytes", report.texture_bytes},
          {"geometry_bytes", report.geometry_bytes},
          {"lods_bytes", lods_bytes},
          {"levels_s", report.levels_s},
          {"worst_bound_after_ms", report.worst_bound_after_ms},
          {"violations", report.findings.size()},
          {"findings", std::move(findings)}};
}

std::string sweep_report(const fs::path& folder) {
  return make_sweep_report(read_json(folder / "sweep.json"));
}

std::string placement_report(const fs::path& folder) {
  const json metrics = read_json(folder / "metrics.json");
  const bool has_placement = fs::exists(folder / "placement.json");
  const json placement = has_placement ? read_json(folder / "placement.json") : json();
  std::vector<ReportPicture> pictures;
  if (has_placement) {
    const PlacementFile file = placement_from_json(placement, (folder / "placement.json").string());
    pictures = report_pictures({}, read_shipped_impostors(read_file(folder / "impostors.glb"), file.placement));
  }
  return make_report(metrics, placement, pictures);
}

}  // namespace

int check_command(const CommandContext& context) {
  const OpenedPlacement opened = open_placement(context);
  const PlacementFile& file = opened.file;
  const ViewSpaceOptions options = view_space_options(file.spec);
  const LevelOptions levels = level_options(file.spec, file.camera, thread_count(context.spec));
  const CheckInput input{opened.scene, opened.hierarchy.rank, opened.target.model, file.camera, file.view_space,
                         options,      file.spec.budget_ms,   file.atlas_pages,    levels};
  const CheckReport report = check_placement(input, file.placement, thread_count(context.spec), context.budget);
  if (context.arguments.json) {
    std::cout << check_json(report, opened.lods_bytes).dump(2) << "\n";
  } else {
    std::printf("%u CPVs, %u solved; %llu regions bounded; %.3f MB of texture; highest bound of a CPV %.3f ms, budget %.3f ms\n",
                report.cpvs, report.solved, static_cast<unsigned long long>(report.regions),
                static_cast<double>(report.texture_bytes) / 1e6, report.worst_bound_after_ms, file.spec.budget_ms);
    if (opened.lods_bytes > 0)
      std::printf("%.3f MB of levels of detail, their errors bounded anew in %.1f s\n", static_cast<double>(opened.lods_bytes) / 1e6,
                  report.levels_s);
    for (const auto& finding : report.findings) std::printf("%s: %s\n", violation_name(finding.violation), finding.sentence.c_str());
  }
  return report.findings.empty() && report.solved == report.cpvs ? 0 : 1;
}

int verify_command(const CommandContext& context) {
  const OpenedPlacement opened = open_placement(context);
  const PlacementFile& file = opened.file;
  const std::string glb = read_file(fs::path(context.arguments.folder) / "impostors.glb");
  const double alpha_rad = file.spec.alpha_scale * file.camera.pixel_angle_rad();
  const json survey = read_json(fs::path(context.arguments.folder) / "metrics.json").at("survey");
  const VerifyInput input{opened.scene,
                          opened.target,
                          file.placement,
                          file.view_space,
                          file.camera,
                          glb,
                          file.spec.budget_ms,
                          alpha_rad,
                          survey.at("worst_frame_ms"),
                          slow_views_from_json(survey.value("worst_views", json::array()))};
  VerifyOptions options;
  options.views = context.spec.verify_views;
  options.judged_views = context.arguments.judged_views;
  options.seed = context.spec.seed + 1;
  options.threads = thread_count(context.spec);
  options.pictures = 0;
  const VerifyResult result = verify_placement(input, device_kind(opened.target), device_matches(opened.target), options, context.budget);
  const json object = {{"verify", verify_json(result)}, {"image", image_json(result)}};
  write_file(fs::path(context.arguments.folder) / "verify.json", object.dump(1));
  json summary = object;
  summary["verify"].erase("frames");
  std::cout << summary.dump(2) << "\n";
  const bool kept = result.over_budget_measured * 100 <= result.views.size() && result.gap_pixels == 0 && result.max_parallax_ratio <= 1.0;
  return kept ? 0 : 1;
}

int report_command(const CommandContext& context) {
  const fs::path folder = context.arguments.folder;
  const bool swept = fs::exists(folder / "sweep.json");
  write_file(folder / "report.html", swept ? sweep_report(folder) : placement_report(folder));
  std::printf("%s\n", (folder / "report.html").c_str());
  return 0;
}

}  // namespace standin
