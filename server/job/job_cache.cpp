#include "server/job/job_cache.h"

#include "render/base/build_identity.h"
#include "server/cache/bake_cache.h"
#include "server/cache/search_cache.h"
#include "server/cache/simplified_cache.h"
#include "server/cache/visible_set_cache.h"

namespace standin {
namespace {

using nlohmann::json;

// In the order in which a job comes to them.
struct NamedStage {
  const CacheStage* stage;
  const char* results;
};
constexpr NamedStage kStages[] = {{&kVisibleSets, "visible sets"},
                                  {&kVisibilityAudits, "visibility audits"},
                                  {&kSimplifiedMeshes, "simplified meshes"},
                                  {&kSearches, "direction searches"},
                                  {&kBakes, "bakes"}};

json to_json(const CacheCounts& counts) {
  return {{"hits", counts.hits}, {"misses", counts.misses}, {"bytes_read", counts.bytes_read}, {"bytes_written", counts.bytes_written}};
}

json to_json(const CacheFigures& figures) {
  json cache = {{"folder_bytes", figures.folder_bytes},
                {"removed_entries", figures.removed_entries},
                {"write_failures", figures.write_failures},
                {"why_not_written", figures.why_not_written}};
  for (const NamedStage& named : kStages) {
    const auto found = figures.stages.find(named.stage->name);
    cache[std::string(named.stage->name)] = to_json(found != figures.stages.end() ? found->second : CacheCounts{});
  }
  return cache;
}

bool lies_in(const std::filesystem::path& path, const std::filesystem::path& folder) {
  // What does not exist yet is made canonical only as far as it does, and stays relative where it was.
  const auto canonical = [](const std::filesystem::path& any) { return std::filesystem::weakly_canonical(std::filesystem::absolute(any)); };
  const auto relative = canonical(path).lexically_relative(canonical(folder));
  return !relative.empty() && *relative.begin() != "..";
}

}  // namespace

std::unique_ptr<StageCache> open_cache(const JobSpec& spec, const std::filesystem::path& result_folder) {
  if (spec.cache.empty()) {
    if (spec.update) throw Failure(ErrorWord::kBadUsage, "--update violates: needs --cache DIR, of which it deletes what is not used");
    return nullptr;
  }
  if (!result_folder.empty() && lies_in(spec.cache, result_folder))
    throw Failure(ErrorWord::kBadUsage, "--cache " + spec.cache + " violates: outside the result folder, which is replaced whole");
  return std::make_unique<StageCache>(spec.cache, build_identity());
}

void close_cache(StageCache* cache, const JobSpec& spec, json& metrics) {
  if (cache == nullptr) return;
  if (spec.update) cache->remove_unused();
  metrics["cache"] = to_json(cache->figures());
}

std::string cache_sentence(const json& metrics) {
  if (!metrics.contains("cache")) return "";
  const json& cache = metrics["cache"];
  std::string sentence = "cache:";
  for (const NamedStage& named : kStages) {
    const json& counts = cache[std::string(named.stage->name)];
    const auto hits = counts["hits"].get<std::uint64_t>(), misses = counts["misses"].get<std::uint64_t>();
    if (hits + misses == 0) continue;
    sentence += std::string(sentence.back() == ':' ? " " : ", ") + named.results + " " + std::to_string(hits) + " of " +
                std::to_string(hits + misses) + " reused";
  }
  if (sentence.back() == ':') sentence += " nothing to reuse";
  if (cache["write_failures"] > 0)
    sentence += "; " + cache["write_failures"].dump() + " results could not be kept (" + cache["why_not_written"].get<std::string>() + ")";
  return sentence;
}

}  // namespace standin
