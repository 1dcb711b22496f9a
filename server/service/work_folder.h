// The folder in which one job is done: what a worker finds there, and what it leaves.
//
//   job.json        what to do (WorkOrder)
//   inputs/ROLE/    the files it reads, linked from the blob store under the names that the client gave
//   unpacked/       the scene, where it came as an archive (bundle.h)
//   out/            the result, whole or not at all
//   outcome.json    how it ended, written last: a worker without one has not ended by itself
//   stdout.json     what the command printed
//   stderr.txt      what it complained about
// Server and worker meet nowhere else, except for the worker's progress, one JSON object a line on its stdout.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "server/service/confinement.h"
#include "server/service/job_request.h"

namespace standin {

struct WorkOrder {
  JobKind kind = JobKind::kSurvey;
  JobSpec spec;
  nlohmann::json arguments;
  WorkerLimits limits;
};

[[nodiscard]] nlohmann::json to_json(const WorkOrder& order);
[[nodiscard]] WorkOrder work_order_from_json(const nlohmann::json& object);

inline constexpr const char* kOrderFile = "job.json";
inline constexpr const char* kOutcomeFile = "outcome.json";
inline constexpr const char* kPrintedFile = "stdout.json";
inline constexpr const char* kComplaintsFile = "stderr.txt";

/// The one file that lies in inputs/ROLE; empty where there is none.
[[nodiscard]] std::filesystem::path input_file(const std::filesystem::path& folder, const std::string& role);
/// A name that a client gave, made harmless: no folders, no control characters, not hidden, of bounded length.
[[nodiscard]] std::string harmless_name(const std::string& name, const std::string& otherwise);

/// Does the job, in this process, which it confines first. Never throws; returns the exit code of the command.
int work(const std::filesystem::path& folder, pid_t parent);

}  // namespace standin
