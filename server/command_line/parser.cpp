#include "server/command_line/parser.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <map>

#include "render/impostor/impostor.h"
#include "server/service/job_request.h"

namespace standin {
namespace {

// Which spec sections a command takes: it offers no flag that cannot matter to it.
const std::vector<std::string> kSceneSections = {"scene"};
const std::vector<std::string> kPlanSections = {"budget_ms",  "scene",     "camera",  "view_space", "visibility", "lods",
                                                "candidates", "impostors", "select",  "device",     "survey",     "verify",
                                                "seed",       "force",     "threads", "cache"};
// Each budget is the command's own, and nothing is rendered.
const std::vector<std::string> kSweepSections = {"scene",  "camera", "view_space", "visibility", "lods",  "candidates", "impostors",
                                                 "select", "survey", "sweep",      "seed",       "force", "threads",    "cache"};
// What any kind of job takes; the service knows which.
const std::vector<std::string> kSubmitSections = {"budget_ms", "scene",  "camera", "view_space", "visibility", "lods", "candidates",
                                                  "impostors", "select", "survey", "sweep",      "verify",     "seed", "force"};
const std::vector<std::string> kBakeSections = {"scene", "camera", "impostors", "device", "seed", "threads"};
const std::vector<std::string> kTimingSections = {"scene", "camera", "device", "seed", "threads"};

bool in_sections(const std::string& key, const std::vector<std::string>& sections) {
  return std::ranges::any_of(sections, [&](const auto& section) { return key == section || key.starts_with(section + "."); });
}

// One subcommand under construction: its flags write into `flags`, applied after a configuration file was read.
struct Builder {
  CLI::App& app;
  ParsedCommand& parsed;
  std::vector<std::pair<const SpecField*, std::string>>& flags;
  std::string& config;
  bool& print_config;
  bool& print_schema;

  using LeftOut = bool (*)(const std::string& key);
  void spec_flags(
      const std::vector<std::string>& sections, LeftOut left_out = [](const std::string&) { return false; }) {
    for (const auto& field : spec_fields()) {
      if (field.flag.empty() || !in_sections(field.key, sections) || left_out(field.key)) continue;
      const auto* row = &field;
      const auto apply = [given = &flags, row](const CLI::results_t& texts) {
        for (const auto& text : texts) given->emplace_back(row, text);
        return true;
      };
      const std::string help = field.help + "  [" + field.key + ", default " + field.get(JobSpec{}).dump() + "]";
      if (field.schema.at("type") == "boolean") {
        yes_or_no(field, help);
        continue;
      }
      app.add_option(field.flag, apply, help)->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    }
    app.add_option("--config", config, "TOML file with settings; flags win over it");
    print_and_exit("--print-config", print_config, "print the complete effective settings as JSON and exit");
    print_and_exit("--print-schema", print_schema, "print the JSON Schema of a configuration and exit");
  }
  // What kinds of jobs take beside their settings; the service knows which takes what.
  void argument_flags() {
    for (const ArgumentField& field : argument_fields()) {
      std::string flag = "--" + field.key;
      std::ranges::replace(flag, '_', '-');
      const auto apply = [given = &arguments().client.arguments, key = field.key](const std::string& text) { (*given)[key] = text; };
      app.add_option_function<std::string>(flag, apply, std::string(kind_name(field.kind)) + ": " + field.help);
    }
  }
  // "--flag" or "--flag=true", and "--flag=false" against a configuration file.
  void yes_or_no(const SpecField& field, const std::string& help) {
    const auto apply = [given = &flags, row = &field](std::int64_t count) { given->emplace_back(row, count > 0 ? "true" : "false"); };
    app.add_flag_function(field.flag, apply, help);
  }
  // As with --help, arguments may be missing: CLI11 asks for them after its callbacks have run, in the order of definition.
  void print_and_exit(const std::string& flag, bool& print, const std::string& help) {
    const auto apply = [wanted = &print] {
      *wanted = true;
      throw CLI::Success();
    };
    app.add_flag_callback(flag, apply, help);
  }
  void json() { app.add_flag("--json", arguments().json, "machine-readable output"); }
  void scene(bool required) {
    auto* option = app.add_option("SCENE", arguments().scenes, "scene file (glTF, GLB, OBJ, PLY, STL, AC3D ...)");
    if (required) option->required();
  }
  void one_scene() {
    scene(true);
    app.get_option("SCENE")->expected(1);
  }
  void folder() { app.add_option("DIR", arguments().folder, "folder that `standin place` wrote")->required(); }
  void output(const std::string& help, bool required = true) {
    auto* option = app.add_option("-o,--output", arguments().output, help);
    if (required) option->required();
  }
  void target() { app.add_option("--target", arguments().target, "target file of `standin calibrate`")->required(); }
  void run(std::function<int(const CommandContext&)> command) {
    app.callback([this_parsed = &parsed, command] { this_parsed->run = command; });
  }
  CommandArguments& arguments() { return parsed.context.arguments; }
};

struct Grammar {
  CLI::App app{"Standin: impostors so that every view of a scene meets its frame-time budget", "standin"};
  ParsedCommand parsed;
  std::vector<std::pair<const SpecField*, std::string>> flags;
  std::string config;
  bool print_config = false;
  bool print_schema = false;

  Builder command(const std::string& name, const std::string& help) {
    CLI::App* sub = app.add_subcommand(name, help);
    sub->fallthrough();
    return {*sub, parsed, flags, config, print_config, print_schema};
  }
};

void add_input_commands(Grammar& grammar) {
  auto city = grammar.command("make-city", "write a test city: a generated one, or a real one from a map");
  city.app.add_option("--objects", city.arguments().city_objects, "objects, exactly (>= 16); of a real city, as many as have room")
      ->capture_default_str();
  city.app.add_option("--triangles", city.arguments().city_triangles, "drawn triangles, within 1 %; of a real city, at least")
      ->capture_default_str();
  auto* osm = city.app.add_option("--osm", city.arguments().osm,
                                  "folder of OpenStreetMap vector tiles, ZOOM-COLUMN-ROW.mvt (npm @mapbox/mvt-fixtures, "
                                  "real-world/osm-qa-astana): its densest 1.5 x 1.0 km (c) OpenStreetMap contributors, ODbL");
  auto* furniture = city.app.add_option("--furniture", city.arguments().furniture,
                                        "folder with the unpacked .sh3f catalogues of Debian's sweethome3d-furniture (trees, cars, lamps; "
                                        "CC-BY and CC0, see their LICENSE.TXT)");
  osm->needs(furniture);
  furniture->needs(osm);
  city.spec_flags({"seed"});
  city.output("GLB file");
  city.run(make_city_command);

  auto info = grammar.command("info", "what a scene holds; what was repaired and dropped, and why");
  info.one_scene();
  info.spec_flags(kSceneSections);
  info.json();
  info.run(info_command);

  auto calibrate = grammar.command("calibrate", "fit the rendering-time model of this machine, or check one");
  calibrate.scene(false);
  calibrate.app.get_option("SCENE")->description(
      "scenes whose frames are timed, and for which the bound is to hold; name the one that is to be placed, so that it rests on its own "
      "frames. None: built-in cities");
  calibrate.app.add_option("--seconds", calibrate.arguments().seconds, "seconds of timed renders, at most")->check(CLI::Range(1.0, 3600.0));
  calibrate.app
      .add_option("--target-error", calibrate.arguments().target_error,
                  "stop as soon as the held-out median error is within this share and the coverage is met; 0: use all seconds")
      ->check(CLI::Range(0.0, 1.0));
  calibrate.app.add_option("--coverage", calibrate.arguments().coverage, "share of frames that the bound is to cover")
      ->check(CLI::Range(0.5, 0.999))
      ->capture_default_str();
  calibrate.app.add_option("--evaluate", calibrate.arguments().evaluate, "target file to check on the scenes")
      ->excludes("--target-error")
      ->excludes("--coverage");
  calibrate.app.add_option("--samples", calibrate.arguments().samples, "write the timed frames to this file (CSV) as well");
  calibrate.app.add_option("--refit", calibrate.arguments().refit, "fit the frames of this file instead of timing any")
      ->excludes("--evaluate")
      ->excludes("--samples");
  calibrate.app
      .add_flag("--self-test", calibrate.arguments().self_test, "run the fit on stiff and extreme data, print a table; times nothing")
      ->excludes("--evaluate")
      ->excludes("--samples")
      ->excludes("--refit");
  calibrate.app.add_flag("--explain", calibrate.arguments().explain, "say what each term costs, in words");
  calibrate.spec_flags(kTimingSections);
  calibrate.output("target file", false);
  calibrate.app.get_option("--self-test")->excludes("--output");
  calibrate.json();
  calibrate.run(calibrate_command);
}

void add_planning_commands(Grammar& grammar) {
  auto survey = grammar.command("survey", "where a scene is slow, and why, and how low the budget may go");
  survey.one_scene();
  survey.target();
  survey.spec_flags(kPlanSections);
  survey.output("result folder", false);
  survey.json();
  survey.run(survey_command);

  auto place = grammar.command("place", "place impostors so that every view meets the budget, at least memory");
  place.one_scene();
  place.target();
  place.spec_flags(kPlanSections);
  place.output("result folder");
  place.json();
  place.run(place_command);

  auto sweep = grammar.command("sweep", "the whole curve of memory against the budget, held against an earlier one");
  sweep.one_scene();
  sweep.target();
  sweep.app.add_option("--baseline", sweep.arguments().baseline, "an earlier sweep.json: growing memory, and a budget no longer met, fail");
  sweep.app.add_option("--acceptance", sweep.arguments().acceptance, "JSON list of criteria: target, budget_ms, max_total_bytes ...");
  sweep.spec_flags(kSweepSections);
  sweep.output("result folder");
  sweep.json();
  sweep.run(sweep_command);

  auto bake = grammar.command("bake", "one impostor of a scene's objects for a given view cell");
  bake.one_scene();
  bake.app.add_option("--objects", bake.arguments().objects, "object ids, as 1,2,5-9; all without it");
  bake.app
      .add_option("--view-cell", bake.arguments().view_cell,
                  "shaft:DX,DY,DZ,APEX_DEG,MIN_DISTANCE (direction to the viewer) or box:X0,Y0,Z0,X1,Y1,Z1")
      ->required();
  const std::vector<std::string> names(technique_names().begin(), technique_names().end());
  bake.app.add_option("--technique", bake.arguments().technique, "impostor technique")->check(CLI::IsMember(names))->capture_default_str();
  bake.app.add_option("--views", bake.arguments().quality_views, "views inside the view cell that the image metrics look at; 0: none")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  bake.spec_flags(kBakeSections);
  bake.output("result folder");
  bake.json();
  bake.run(bake_command);
}

void add_result_commands(Grammar& grammar) {
  auto check = grammar.command("check", "re-score DIR/placement.json from scratch");
  auto verify = grammar.command("verify", "render and measure a placement; writes DIR/verify.json");
  for (auto* builder : {&check, &verify}) {
    builder->folder();
    builder->app.add_option("--scene", builder->arguments().scenes, "the scene file, where it is not where place found it")->expected(1);
    builder->app.add_option("--target", builder->arguments().target, "the target file, where it is not where place found it");
    builder->json();
  }
  check.spec_flags({"threads", "scene.texture_folders", "scene.max_triangles", "scene.max_texels"});
  verify.app.add_option("--views", grammar.parsed.context.spec.verify_views, "views to render")->check(CLI::Range(1, 100'000));
  verify.app.add_option("--judged-views", verify.arguments().judged_views, "views inside view cells to judge by rays")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  verify.spec_flags({"seed", "threads", "device", "scene.texture_folders", "scene.max_triangles", "scene.max_texels"});
  check.run(check_command);
  verify.run(verify_command);

  auto report = grammar.command("report", "write DIR/report.html again, of a placement, a survey or a sweep");
  report.folder();
  report.run(report_command);
}

void add_service_commands(Grammar& grammar) {
  auto serve = grammar.command("serve", "the HTTP service: jobs over HTTP, and a web page");
  ServiceArguments& service = serve.arguments().service;
  const auto option = [&](const char* flag, auto& value, const char* help) {
    return serve.app.add_option(flag, value, help)->capture_default_str();
  };
  option("--data", service.data, "folder of jobs, uploads and results");
  option("--listen", service.listen, "ADDRESS:PORT; port 0: any that is free; other than loopback needs --tokens");
  option("--tokens", service.tokens, "file of lines OWNER SHA256-OF-TOKEN; each owner sees the own jobs only");
  option("--scenes", service.scenes, "folder of scenes that clients may name");
  option("--targets", service.targets, "folder of target files that clients may name");
  option("--presets", service.presets, "folder of configuration files (TOML) that the page offers");
  option("--web", service.web, "folder of the page; default: web, beside the program");
  option("--workers", service.workers, "jobs that run at a time")->check(CLI::Range(1, 64));
  option("--queue", service.queue, "jobs that may wait")->check(CLI::Range(1, 1'000'000));
  option("--attempts", service.attempts, "workers that may be lost before a job fails")->check(CLI::Range(1, 1000));
  option("--deadline-minutes", service.deadline_minutes, "that one attempt at a job may take; 0: as long as it takes")
      ->check(CLI::Range(0.0, 1e6));
  option("--keep-days", service.keep_days, "from a job's end to its removal, and of uploads that no job uses; 0: for ever")
      ->check(CLI::Range(0.0, 1e5));
  option("--upload-mb", service.upload_mb, "that one upload may have")->check(CLI::Range(0.001, 1e6));
  option("--quota-gb", service.quota_gb, "that uploads and results may have together")->check(CLI::Range(0.001, 1e6));
  option("--owner-share", service.owner_share, "of the queue, uploads, streams and quota that one of several owners of tokens may take")
      ->check(CLI::Range(0.001, 1.0));
  option("--cache-gb", service.cache_gb, "that stage caches may have together")->check(CLI::Range(0.0, 1e6));
  option("--scene-mtriangles", service.scene_mtriangles, "millions of triangles that a scene may draw")->check(CLI::Range(1e-6, 1e6));
  option("--scene-mtexels", service.scene_mtexels, "millions of texels that a scene's textures may have")->check(CLI::Range(1e-6, 1e6));
  option("--worker-memory-gb", service.worker_memory_gb, "that a job may have; 0: no limit")->check(CLI::Range(0.0, 1e5));
  option("--worker-cpu-hours", service.worker_cpu_hours, "processor hours that a job may use; 0: no limit")->check(CLI::Range(0.0, 1e5));
  option("--streams", service.streams, "event streams that may be open")->check(CLI::Range(1, 100'000));
  option("--connections", service.connections, "connections that may be open")->check(CLI::Range(1, 100'000));
  serve.run(serve_command);

  auto work = grammar.command("work", "one job of the service, in its folder (the service starts it)");
  work.app.group("");  // not for people
  work.app.add_option("FOLDER", work.arguments().work_folder)->required();
  work.app.add_option("PARENT", work.arguments().work_parent)->required();
  work.run(work_command);
}

void add_client_commands(Grammar& grammar) {
  auto submit = grammar.command("submit", "submit a job to a service: prints its id");
  ClientArguments& client = submit.arguments().client;
  submit.app.add_option("--kind", client.kind, "kind of job")
      ->check(CLI::IsMember({"survey", "place", "sweep", "calibrate", "verify", "bake"}))
      ->capture_default_str();
  submit.app.add_option("--scene", submit.arguments().scenes, "scene file; uploaded unless the service has it")->expected(1);
  submit.app.add_option("--scene-name", client.scene_name, "a scene of the service's folder")->excludes("--scene");
  submit.app.add_option("--target", submit.arguments().target, "target file; uploaded unless the service has it");
  submit.app.add_option("--target-name", client.target_name, "a target file of the service's folder")->excludes("--target");
  submit.app.add_option("--baseline", submit.arguments().baseline, "sweep: an earlier sweep.json");
  submit.app.add_option("--job", client.job, "verify: the id of the place job to look at");
  submit.app.add_option("--label", client.label, "a word for people");
  submit.argument_flags();
  submit.app.add_flag("--wait", client.wait, "wait for its end, showing how far it is; exit as the local command would");
  submit.output("result folder: waits, and fetches the result", false);
  submit.spec_flags(kSubmitSections, is_services_own);
  submit.json();
  submit.run(submit_command);

  auto status = grammar.command("status", "how a job of a service is");
  auto fetch = grammar.command("fetch", "the result of a job of a service");
  auto cancel = grammar.command("cancel", "cancel a job of a service");
  for (auto* builder : {&status, &fetch, &cancel}) builder->app.add_option("JOB", client.job, "its id")->required();
  for (auto* builder : {&submit, &status, &fetch, &cancel})
    builder->app.add_option("--server", client.server, "http://HOST:PORT; a token comes from the environment, STANDIN_TOKEN")
        ->capture_default_str();
  status.app.add_flag("--wait", client.wait, "wait for its end; exit as the local command would");
  status.json();
  fetch.output("result folder");
  status.run(status_command);
  fetch.run(fetch_command);
  cancel.run(cancel_command);
}

// Words nobody understood explain more than what CLI11 misses for lack of them.
std::string complaint(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> words = app.remaining(true);
  if (words.empty()) return error.what();
  std::string sentence = "not understood:";
  for (const auto& word : words) sentence += " " + word;
  return sentence;
}

}  // namespace

ParsedCommand parse_command_line(int argc, char** argv) {
  Grammar grammar;
  grammar.app.require_subcommand(1);
  grammar.app.add_flag("--quiet", grammar.parsed.quiet, "no progress on stderr");
  grammar.app.set_version_flag("--version", "standin " STANDIN_VERSION);
  add_input_commands(grammar);
  add_planning_commands(grammar);
  add_result_commands(grammar);
  add_service_commands(grammar);
  add_client_commands(grammar);
  try {
    grammar.app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    if (!grammar.print_config && !grammar.print_schema) {  // --help, --version
      grammar.app.exit(done);
      return {};
    }
  } catch (const CLI::ParseError& error) {
    throw Failure(ErrorWord::kBadUsage, complaint(grammar.app, error));
  }
  if (grammar.print_schema) {
    std::cout << spec_schema().dump(2) << "\n";
    return {};
  }
  if (!grammar.config.empty()) read_config(grammar.parsed.context.spec, grammar.config);
  for (const auto& [field, text] : grammar.flags) set_field_from_text(grammar.parsed.context.spec, *field, text);
  if (grammar.print_config) {
    std::cout << to_json(grammar.parsed.context.spec, false).dump(2) << "\n";
    return {};
  }
  return std::move(grammar.parsed);
}

}  // namespace standin
