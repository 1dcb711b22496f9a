// The commands of `standin`: arguments in, exit code out. Results on stdout (text, or JSON with --json), progress on stderr.
//
// Exit codes: 0 done; 1 the aim could not be met (an unsolved view, a failed check); failures are thrown and mapped by main.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "render/base/work.h"
#include "server/job/job_spec.h"

namespace standin {

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

}  // namespace standin
