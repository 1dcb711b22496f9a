// What a job reads and where it writes, and how a result folder remembers both.
//
// A result folder is replaced only by a result of the same job: scene, target and settings are named by their content, never by a path
// (no paper asks for that; users lose no work by it).
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "server/job/job_spec.h"

namespace standin {

struct JobFiles {
  std::filesystem::path scene;
  std::filesystem::path target;
  std::filesystem::path folder;  // result folder; survey: may be empty (nothing is written)
};

/// Hidden file of a result folder: the paths of its scene and target, for `check` and `verify`.
inline constexpr const char* kInputsFile = ".standin-inputs.json";

/// Names a job by what goes into it. `more`: what else does, beside scene, target and settings.
[[nodiscard]] std::string fingerprint(const char* kind, const JobFiles& files, const JobSpec& spec,
                                      const nlohmann::json& more = nlohmann::json::object());
/// Content of kInputsFile: outside placement.json, which carries no path.
[[nodiscard]] std::string inputs_json(const JobFiles& files);

}  // namespace standin
