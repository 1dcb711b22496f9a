// The commands of `standin`: arguments in, exit code out. Results on stdout (text, or JSON with --json), progress on stderr.
//
// Exit codes: 0 done; 1 the aim could not be met (an unsolved view, a failed check); failures are thrown and mapped by main.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "render/base/work.h"
#include "server/job/job_spec.h"

namespace standin {

/// Of `serve`. Sizes and times as people say them.
struct ServiceArguments {
  std::string data = "standin-data";
  std::string listen = "127.0.0.1:8080";
  std::string tokens;
  std::string scenes;
  std::string targets;
  std::string presets;
  std::string web;  // empty: beside the program
  std::uint32_t workers = 1;
  std::uint32_t queue = 100;
  std::uint32_t attempts = 5;
  double deadline_minutes = 0.0;
  double keep_days = 30.0;
  double upload_mb = 2000.0;
  double quota_gb = 50.0;
  double owner_share = 0.5;
  double scene_mtriangles = 100.0;
  double scene_mtexels = 500.0;
  double cache_gb = 10.0;
  double worker_memory_gb = 8.0;
  double worker_cpu_hours = 24.0;
  std::uint32_t streams = 200;
  std::uint32_t connections = 1000;
};

/// Of the commands that speak to a service.
struct ClientArguments {
  std::string server = "http://127.0.0.1:8080";
  std::string kind = "place";
  std::string scene_name;  // of the server's folder
  std::string target_name;
  std::string label;
  std::string job;                               // its id
  std::map<std::string, std::string> arguments;  // that its kind takes (argument_fields()): text by key
  bool wait = false;
};

/// What the words after a command said.
struct CommandArguments {
  std::vector<std::string> scenes;
  std::string folder;  // DIR
  std::string output;  // -o
  std::string target;
  std::string evaluate;               // calibrate --evaluate
  std::string samples;                // calibrate --samples
  std::string refit;                  // calibrate --refit
  double seconds = 45.0;              // calibrate
  double target_error = 0.0;          // calibrate: ends it early; 0: never
  double coverage = 0.99;             // calibrate
  std::string baseline;               // sweep
  std::string acceptance;             // sweep
  std::string objects;                // bake: "1,2,5-9"; empty: all
  std::string view_cell;              // bake: shaft:... or box:...
  std::string technique = "layered";  // bake
  std::uint32_t quality_views = 50;   // bake; 0: its image metrics are left out
  std::uint32_t city_objects = 5287;
  std::uint64_t city_triangles = 10'400'000;
  std::string osm;                   // make-city: folder of vector tiles; empty: a generated city
  std::string furniture;             // make-city --osm: folder of unpacked catalogues
  std::uint32_t judged_views = 500;  // verify
  ServiceArguments service;          // serve
  ClientArguments client;            // submit, status, fetch, cancel
  std::string work_folder;           // work
  std::uint32_t work_parent = 0;
  bool json = false;
  bool explain = false;
  bool self_test = false;
};

struct CommandContext {
  CommandArguments arguments;
  JobSpec spec;
  WorkBudget budget;
};

int make_city_command(const CommandContext& context);
int info_command(const CommandContext& context);
int calibrate_command(const CommandContext& context);
int survey_command(const CommandContext& context);
int place_command(const CommandContext& context);
int sweep_command(const CommandContext& context);
int bake_command(const CommandContext& context);
int check_command(const CommandContext& context);
int verify_command(const CommandContext& context);
int report_command(const CommandContext& context);
int serve_command(const CommandContext& context);
int work_command(const CommandContext& context);
int submit_command(const CommandContext& context);
int status_command(const CommandContext& context);
int fetch_command(const CommandContext& context);
int cancel_command(const CommandContext& context);

}  // namespace standin
