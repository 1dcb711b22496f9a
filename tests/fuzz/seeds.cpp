// Seeds for the fuzzers, made by the program's own writers and the tests' makers: fuzz_seeds FOLDER writes FOLDER/FUZZER/NAME.
#include <archive.h>
#include <archive_entry.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "estimation/samples_file.h"
#include "estimation/time_model.h"
#include "render/base/staged_file.h"
#include "render/scene/level_file.h"
#include "server/files/placement_json.h"
#include "server/job/job_spec.h"
#include "server/sweep/curve.h"
#include "tests/fuzz/scene_seeds.h"
#include "tests/server/verify/hand_made_glb.h"
#include "tests/server/verify_views/small_placement.h"

namespace standin::fuzz {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Corpora {
 public:
  explicit Corpora(fs::path folder) : folder_(std::move(folder)) {}
  void add(const std::string& fuzzer, const std::string& name, const std::string& bytes) const {
    fs::create_directories(folder_ / fuzzer);
    write_file(folder_ / fuzzer / name, bytes);
  }
  [[nodiscard]] fs::path scratch(const std::string& name) const { return folder_ / name; }

 private:
  fs::path folder_;
};

void add_scenes(const Corpora& corpora) {
  for (const auto& [name, bytes] : scene_seeds()) corpora.add("fuzz_scene", name, bytes);
  static constexpr std::array kEndings = {".obj", ".ply", ".stl", ".ac", ".acc", ".dae"};  // as in fuzz_assimp_scene
  const auto others = other_scene_seeds();
  for (std::size_t i = 0; i < kEndings.size(); ++i)
    corpora.add("fuzz_assimp_scene", "scene" + std::string(kEndings.at(i)), static_cast<char>(i) + others.at(kEndings.at(i)));
}

std::vector<json> bodies() {
  JobSpec spec;
  spec.budget_ms = 16.0;
  json settings = to_json(spec, false);
  for (const char* own : {"cache", "threads", "device"}) settings.erase(own);
  settings["scene"].erase("texture_folders");
  settings["view_space"]["boxes"] = {{{"min", {0, 0, 0}}, {"max", {1, 2, 1}}}};
  settings["sweep"]["budgets_ms"] = {10, 20.5};
  settings["force"] = {"lods"};
  const json scene = {{"upload", "UPLOAD"}}, target = {{"job", "DONE"}};
  return {{{"kind", "place"}, {"label", "night"}, {"scene", scene}, {"target", target}, {"spec", settings}, {"dry_run", true}},
          {{"kind", "survey"}, {"scene", scene}, {"target", target}},
          {{"kind", "sweep"},
           {"scene", scene},
           {"target", target},
           {"baseline", {{"upload", "UPLOAD"}}},
           {"spec", {{"sweep", {{"tolerance", 0.1}}}}}},
          {{"kind", "calibrate"}, {"arguments", {{"seconds", 30}, {"target_error", 0.1}, {"coverage", 0.99}}}},
          {{"kind", "verify"}, {"job", "DONE"}, {"arguments", {{"judged_views", 10}}}},
          {{"kind", "bake"},
           {"scene", scene},
           {"arguments", {{"objects", "1,2,5-9"}, {"view_cell", "shaft:1,0,0,45,30"}, {"technique", "tdm"}, {"views", 5}}}}};
}

void add_requests(const Corpora& corpora) {
  int number = 0;
  for (const json& body : bodies()) {
    corpora.add("fuzz_job_request", "body_" + std::to_string(number), body.dump());
    corpora.add("fuzz_request", "submit_" + std::to_string(number++),
                "POST /v1/jobs\ncontent-type: application/json\nidempotency-key: night\n\n" + body.dump());
  }
  corpora.add(
      "fuzz_job_request", "settings.toml",
      "budget_ms = 16.5\nforce = [\"lods\"]\n[view_space]\nkind = \"boxes\"\nboxes = [{min = [0, 0, 0], max = [1, 2, 1]}]\nleaf_m = 1e1\n"
      "[select]\nkeep_picks = true\n[impostors]\ntechniques = 'planar,layered'\n");
  const std::vector<std::string> requests = {"GET /\nhost: localhost\norigin: http://localhost",
                                             "GET /v1/jobs?state=queued&kind=place&limit=3&after=9",
                                             "GET /v1/jobs/WAITING",
                                             "DELETE /v1/jobs/DONE",
                                             "POST /v1/jobs/WAITING/cancel",
                                             "GET /v1/jobs/WAITING/events\nlast-event-id: 1",
                                             "HEAD /v1/jobs/DONE/events",
                                             "GET /v1/jobs/DONE/artifacts",
                                             "GET /v1/jobs/DONE/artifacts/report.html\nrange: bytes=2-5\nif-range: \"x\"",
                                             "GET /v1/jobs/DONE/scene\nrange: bytes=-4",
                                             "GET /v1/jobs/DONE/artifacts/target.json\nrange: bytes=3-\nif-none-match: \"x\", *",
                                             "POST /v1/uploads?name=a.glb\ncontent-type: model/gltf-binary\ncontent-length: 4\n\nglTF",
                                             "GET /v1/uploads",
                                             "GET /v1/uploads/UPLOAD/content\nrange: bytes=0-0",
                                             "DELETE /v1/uploads/UPLOAD",
                                             "GET /v1/scenes",
                                             "GET /v1/schema",
                                             "GET /v1/presets",
                                             "GET /readyz\nhost: [::1]:8080",
                                             "GET /metrics\nauthorization: Bearer secret",
                                             "GET /openapi.json",
                                             "OPTIONS /v1/jobs"};
  for (const std::string& request : requests) corpora.add("fuzz_request", "request_" + std::to_string(number++), request);
}

std::string zip(const std::vector<std::pair<std::string, std::string>>& files, const char* compression) {
  std::string bytes(1 << 20, '\0');
  std::size_t used = 0;
  archive* writer = archive_write_new();
  archive_write_set_format_zip(writer);
  archive_write_set_options(writer, compression);
  archive_write_open_memory(writer, bytes.data(), bytes.size(), &used);
  for (const auto& [path, content] : files) {
    archive_entry* entry = archive_entry_new();
    archive_entry_set_pathname(entry, path.c_str());
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_entry_set_perm(entry, 0644);
    archive_entry_set_size(entry, static_cast<la_int64_t>(content.size()));
    archive_write_header(writer, entry);
    archive_write_data(writer, content.data(), content.size());
    archive_entry_free(entry);
  }
  archive_write_close(writer);
  archive_write_free(writer);
  bytes.resize(used);
  return bytes;
}

void add_bundles(const Corpora& corpora) {
  for (const char* compression : {"zip:compression=store", "zip:compression=deflate"}) {
    const std::string kind = std::string(compression).substr(16);
    corpora.add("fuzz_bundle", kind, zip({{"a/city.gltf", std::string(300, 'x')}, {"a/textures/wall.png", "y"}}, compression));
    corpora.add("fuzz_bundle", kind + "_leaves", zip({{"a/../../b.glb", "x"}, {"/b", "y"}, {"c\\d.glb", "z"}}, compression));
  }
}

PlacementFile placement_file(const test::SmallPlacement& small) {
  PlacementFile file;
  file.spec.budget_ms = 12.5;
  file.scene_name = "walls.glb";
  file.coverage = 0.99;
  file.camera = small.camera;
  file.view_space = small.view_space;
  file.atlas_pages = 1;
  file.placement = small.placement;
  file.placement.visible_sets = {{0, 1}};
  file.placement.cells[1].visible_set = 0;
  return file;
}

// Walls as of a glTF, the near one with a simpler form.
Scene with_levels(Scene scene, bool is_gltf) {
  Mesh simple = scene.meshes[0];
  simple.indices.resize(6);
  simple.simplified_from = 0;
  const auto first = static_cast<std::uint32_t>(scene.parts.size());
  scene.parts.push_back(scene.parts[0]);
  scene.parts.back().mesh = static_cast<std::uint32_t>(scene.meshes.size());
  scene.meshes.push_back(simple);
  for (Part& part : scene.parts) part.gltf_mesh = is_gltf ? 0 : -1;
  scene.objects[0].levels = {{first, 1, 2, 0.1, -1.0, 50.0}};
  return scene;
}

void add_files(const Corpora& corpora) {
  const test::SmallPlacement small;
  corpora.add("fuzz_files", "placement", 'p' + placement_to_json(placement_file(small), small.scene).dump());
  PlacementFile with_lods = placement_file(small);
  with_lods.lods_sha256 = "ab";
  corpora.add("fuzz_files", "placement_levels", 'p' + placement_to_json(with_lods, with_levels(small.scene, false)).dump());
  corpora.add("fuzz_files", "impostors", 'i' + small.glb);
  test::HandMadeGlb quads;
  quads.quads.emplace_back();
  corpora.add("fuzz_files", "impostors_of_tinygltf", 'i' + test::write_glb(quads));
  for (const bool is_gltf : {true, false})
    corpora.add("fuzz_files", is_gltf ? "levels" : "levels_own", 'l' + write_levels(with_levels(small.scene, is_gltf)).glb);
  Target target;
  target.id = "a machine";
  target.machine.reference_ms = 1.0;
  target.machine.clock = "wall";
  target.model.coverage = 0.99;
  target.model.bound_steps = {{5.0, 1.5}, {std::numeric_limits<double>::infinity(), 1.25}};
  target.left_out = {"city"};
  target.learning_curve.resize(1);
  write_target(target, corpora.scratch("scratch"));
  corpora.add("fuzz_files", "target", 't' + read_file(corpora.scratch("scratch")));
  CalibrationSamples samples;
  samples.machine = target.machine;
  samples.frames.resize(2);
  write_samples(samples, corpora.scratch("scratch"));
  corpora.add("fuzz_files", "samples", 's' + read_file(corpora.scratch("scratch")));
  fs::remove(corpora.scratch("scratch"));
  json curve = to_json(CurveSubject{"walls.glb", "a machine", 45.0, 512, 512});
  curve["points"] = {to_json(CurvePoint{})};
  corpora.add("fuzz_files", "baseline", 'b' + curve.dump());
  corpora.add("fuzz_files", "acceptance",
              R"(a[{"target": "a machine", "budget_ms": 16, "max_total_bytes": 5e6, "max_texture_bytes": 4e6, "max_unsolved": 0}])");
}

}  // namespace
}  // namespace standin::fuzz

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "fuzz_seeds FOLDER\n");
    return 2;
  }
  const standin::fuzz::Corpora corpora(arguments[1]);
  standin::fuzz::add_scenes(corpora);
  standin::fuzz::add_requests(corpora);
  standin::fuzz::add_bundles(corpora);
  standin::fuzz::add_files(corpora);
  return 0;
}
