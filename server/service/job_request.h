// What a client asks for: a body of POST /v1/jobs, read with all that is wrong with it named at once.
//
// A job of the service is a command of the command line: its kind is the command, `spec` holds its settings as a configuration file would,
// `arguments` what the command takes beside them. Settings that name paths, or belong to the machine, are the service's own.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "server/command_line/commands.h"
#include "server/job/job_spec.h"

namespace standin {

enum class JobKind { kSurvey, kPlace, kSweep, kCalibrate, kVerify, kBake };
inline constexpr int kJobKinds = 6;
[[nodiscard]] std::string_view kind_name(JobKind kind);

/// Where a job's file comes from.
struct FileReference {
  enum class Source { kNone, kUpload, kName, kJob } source = Source::kNone;
  std::string value;  // an upload's id, a name in the configured folder, or the id of a job that made it
};

struct JobRequest {
  JobKind kind = JobKind::kSurvey;
  std::string label;
  FileReference scene;
  FileReference target;
  FileReference baseline;  // sweep
  std::string placed_job;  // verify: the job whose placement is looked at
  JobSpec spec;
  nlohmann::json arguments;  // as given, valid
  bool dry_run = false;
};

/// An argument that a kind takes.
struct ArgumentField {
  JobKind kind;
  std::string key;
  std::string help;
  nlohmann::json schema;
  std::function<void(CommandArguments&, const nlohmann::json&)> set;
};
[[nodiscard]] const std::vector<ArgumentField>& argument_fields();

/// Whether a setting names files of the server, or shares out its processors: not a client's to set.
[[nodiscard]] bool is_services_own(const std::string& key);

/// Throws InvalidBody with a JSON pointer for each field that is unknown, missing, of the wrong type or out of its range.
[[nodiscard]] JobRequest parse_job_request(const nlohmann::json& body);
/// `arguments`: of a JobRequest.
void apply_arguments(JobKind kind, const nlohmann::json& arguments, CommandArguments& to);
/// JSON Schema of the body.
[[nodiscard]] nlohmann::json job_request_schema();

}  // namespace standin
