// Direction searches (placement/view_space) that outlive the job, one entry for each 3D cell.
//
// A search looks at the cell's chain of boxes and at the cost features of the objects that may be seen from it, in hierarchy order, in
// which costs are summed; the camera, the time model's prices and which pixel kinds the scene has are the same for all. The budget is no
// part of an entry's name: an entry holds its own, and a search at a tighter one answers every looser one (search_memory.h), so it replaces
// it. Objects are written as positions in the list that the name stands for.
#pragma once

#include <mutex>
#include <vector>

#include "estimation/time_model.h"
#include "placement/view_space/search_memory.h"
#include "placement/view_space/subdivision.h"
#include "server/cache/stage_cache.h"

namespace standin {

inline constexpr CacheStage kSearches{"searches"};

/// What all searches of a job share. All references must outlive the cache.
struct SearchScene {
  const Scene& scene;
  const std::vector<std::uint32_t>& hierarchy_rank;
  const Visibility& visibility;
  const TimeModel& model;
  const Camera& camera;
  const ViewSpaceOptions& options;
};

class SearchCache final : public SearchMemory {
 public:
  SearchCache(StageCache& cache, const SearchScene& scene);

  /// From this job's memory, else from the cache.
  [[nodiscard]] std::shared_ptr<const RememberedSearch> recall(const SearchRequest& request) override;
  void keep(const SearchRequest& request, const DirectionSearchResult& found) override;

  /// What the search of a cell depends on, but for the budget.
  [[nodiscard]] Fingerprint inputs_of(const SearchRequest& request);

 private:
  /// What may be seen from a leaf and all cells in it.
  struct VisibleObjects {
    std::once_flag once;
    std::vector<std::uint32_t> by_rank;
    Fingerprint content;
  };

  [[nodiscard]] const VisibleObjects& visible_from(std::int32_t visible_set);
  void look_up(std::int32_t visible_set, VisibleObjects& objects) const;
  [[nodiscard]] std::string bytes_of(const RememberedSearch& search, const std::vector<std::uint32_t>& by_rank) const;

  StageCache& cache_;
  SearchScene job_;
  Fingerprint shared_;
  std::vector<Fingerprint> contents_;    // per object
  std::vector<VisibleObjects> visible_;  // per visible set, that of everything last
};

}  // namespace standin
