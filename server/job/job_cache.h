// A job's cache (server/cache): opened as the settings say, and what it was worth in metrics.json.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "server/cache/stage_cache.h"
#include "server/job/job_spec.h"

namespace standin {

/// Nothing where the job has none. Throws Failure(kBadUsage) where the folder cannot be written to or lies in the result folder, which is
/// replaced whole, or where --update has nothing to update.
[[nodiscard]] std::unique_ptr<StageCache> open_cache(const JobSpec& spec, const std::filesystem::path& result_folder);
/// To be called when no stage will look anything up any more: deletes what was not used where the job asks for that, and adds "cache" to
/// `metrics`. Does nothing without a cache.
void close_cache(StageCache* cache, const JobSpec& spec, nlohmann::json& metrics);
/// "cache: visible sets 296 of 300 reused, ..." of metrics with a cache; "" of others.
[[nodiscard]] std::string cache_sentence(const nlohmann::json& metrics);

}  // namespace standin
