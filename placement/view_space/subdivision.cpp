#include "placement/view_space/subdivision.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "placement/view_space/cell_boxes.h"
#include "placement/view_space/direction_search.h"
#include "render/base/error.h"
#include "render/base/parallel.h"

namespace standin {
namespace {

/// A cell that has been searched.
struct SearchedCell {
  Cell cell;
  std::vector<Box> chain;
  DirectionSearchResult found;
  double parent_ms = std::numeric_limits<double>::infinity();  // its parent's worst bound
};

// Halving ends where it no longer lowers the worst bound by so much.
constexpr double kLeastGain = 0.03;

std::vector<DirectionInterval> used_intervals(const std::vector<SearchedCell>& searched) {
  std::vector<DirectionInterval> intervals;
  for (const SearchedCell& one : searched)
    for (const HotRegion& region : one.found.hot) intervals.push_back(region.interval);
  std::sort(intervals.begin(), intervals.end());
  intervals.erase(std::unique(intervals.begin(), intervals.end()), intervals.end());
  return intervals;
}

class Subdivider {
 public:
  Subdivider(const Scene& scene, const std::vector<std::uint32_t>& rank, const ViewSpace& space, const Visibility& visibility,
             const TimeModel& model, const Camera& camera, const ViewSpaceOptions& view_space_options, const SubdivisionOptions& options,
             const WorkBudget& budget, SearchMemory* memory)
      : space_(space),
        visibility_(visibility),
        options_(options),
        budget_(budget),
        memory_(memory),
        cell_boxes_(space),
        estimator_(scene, rank, model, camera, view_space_options),
        all_objects_(scene.objects.size()) {
    std::iota(all_objects_.begin(), all_objects_.end(), 0U);
  }

  std::vector<SearchedCell> run() {
    std::vector<SearchedCell> frontier = search_leaves();
    for (const SearchedCell& searched : frontier) count(searched);
    std::vector<SearchedCell> done;
    while (!frontier.empty()) frontier = halve(std::move(frontier), done);
    std::sort(done.begin(), done.end(), [](const SearchedCell& a, const SearchedCell& b) { return a.cell.key < b.cell.key; });
    return done;
  }

  // The terms of each cell's CPVs, in order; a searched cell is freed once its terms are taken over.
  [[nodiscard]] Subdivision assemble(std::vector<SearchedCell> searched) const {
    Subdivision result;
    result.intervals = used_intervals(searched);
    result.visible_sets = visibility_.sets;
    result.terms.reserve(terms_);
    result.cpvs.reserve(cpvs_);
    for (SearchedCell& one : searched) {
      budget_.check();
      result.worst_predicted_ms = std::max(result.worst_predicted_ms, one.cell.worst_predicted_ms);
      result.cells.push_back(one.cell);
      add_cpvs(one.found, result);
      one = {};
    }
    return result;
  }

  [[nodiscard]] std::uint64_t cells_not_halved() const { return cells_not_halved_; }

 private:
  // Children searched at a time; the limits are looked at between batches, so this is fixed and not a matter of threads.
  static constexpr std::size_t kBatch = 256;

  [[nodiscard]] std::int32_t visible_set_of(const CellKey& leaf) const {
    if (visibility_.cells.empty()) return -1;
    const auto found = std::lower_bound(visibility_.cells.begin(), visibility_.cells.end(), leaf);
    if (found == visibility_.cells.end() || *found != leaf)
      throw Failure(ErrorWord::kInternal, "visibility: no set for leaf cell (" + std::to_string(leaf.index[0]) + ", " +
                                              std::to_string(leaf.index[1]) + ", " + std::to_string(leaf.index[2]) + ")");
    return static_cast<std::int32_t>(found - visibility_.cells.begin());
  }

  [[nodiscard]] CellCosts costs_of(const Cell& cell, std::vector<Box> chain) const {
    const auto& visible = cell.visible_set < 0 ? all_objects_ : visibility_.sets[static_cast<std::size_t>(cell.visible_set)];
    return estimator_.cell_costs(std::move(chain), visible, cell_boxes_.parts(cell.key));
  }

  [[nodiscard]] SearchedCell search(const CellKey& key, std::vector<Box> chain, std::int32_t visible_set) const {
    SearchedCell searched{{key, chain.front(), visible_set, 0.0, {}}, std::move(chain), {}, std::numeric_limits<double>::infinity()};
    searched.found = search(searched);
    searched.cell.worst_predicted_ms = searched.found.worst_predicted_ms;
    searched.cell.worst_interval = searched.found.worst_interval;
    return searched;
  }

  [[nodiscard]] DirectionSearchResult search(const SearchedCell& of) const {
    const double predicted_ms = options_.predicted_budget_ms;
    const SearchRequest request{of.cell.key, predicted_ms, of.chain, of.cell.visible_set};
    const auto known = memory_ != nullptr ? memory_->recall(request) : nullptr;
    if (known != nullptr && known->predicted_budget_ms <= predicted_ms) return at_looser_budget(known->found, predicted_ms);
    CellCosts costs = costs_of(of.cell, of.chain);
    DirectionSearchResult found = search_directions(estimator_, costs, predicted_ms, known != nullptr ? &known->found : nullptr);
    if (memory_ != nullptr) memory_->keep(request, found);
    return found;
  }

  [[nodiscard]] std::vector<SearchedCell> search_leaves() const {
    const auto& leaves = options_.leaves.empty() ? cell_boxes_.leaves() : options_.leaves;
    std::vector<SearchedCell> searched(leaves.size());
    parallel_for(leaves.size(), options_.threads, budget_,
                 [&](std::size_t i) { searched[i] = search(leaves[i], cell_boxes_.chain(leaves[i]), visible_set_of(leaves[i])); });
    return searched;
  }

  struct ChildTask {
    CellKey key;
    std::size_t parent;  // index into the frontier
  };

  [[nodiscard]] std::vector<ChildTask> child_tasks(const std::vector<SearchedCell>& frontier, std::size_t& next) const {
    std::vector<ChildTask> tasks;
    for (; next < frontier.size() && tasks.size() < kBatch; ++next)
      for (int c = 0; c < 8; ++c) {
        const CellKey key = frontier[next].cell.key.child(c);
        if (!cell_boxes_.cell_box(key).empty()) tasks.push_back({key, next});
      }
    return tasks;
  }

  [[nodiscard]] std::vector<SearchedCell> search_children(const std::vector<SearchedCell>& parents,
                                                          const std::vector<ChildTask>& tasks) const {
    std::vector<SearchedCell> children(tasks.size());
    parallel_for(tasks.size(), options_.threads, budget_, [&](std::size_t i) {
      const SearchedCell& parent = parents[tasks[i].parent];
      std::vector<Box> chain = {cell_boxes_.cell_box(tasks[i].key)};
      chain.insert(chain.end(), parent.chain.begin(), parent.chain.end());
      children[i] = search(tasks[i].key, std::move(chain), parent.cell.visible_set);
      children[i].parent_ms = parent.cell.worst_predicted_ms;
    });
    return children;
  }

  void count(const SearchedCell& searched) {
    terms_ += searched.found.terms.size();
    cpvs_ += searched.found.hot.size();
  }

  [[nodiscard]] bool within_limits() const { return terms_ <= options_.max_terms && cpvs_ <= options_.max_cpvs; }

  // CPVs of the last cell of `result`.
  static void add_cpvs(const DirectionSearchResult& found, Subdivision& result) {
    const auto cell = static_cast<std::uint32_t>(result.cells.size() - 1);
    for (const HotRegion& region : found.hot) {
      const auto at = std::lower_bound(result.intervals.begin(), result.intervals.end(), region.interval);
      result.cpvs.push_back({cell, static_cast<std::uint32_t>(at - result.intervals.begin()), region.pixels_capped, region.constant_ms,
                             region.predicted_ms, result.terms.size(), static_cast<std::uint32_t>(region.term_count)});
      const auto terms = found.terms_of(region);
      result.terms.insert(result.terms.end(), terms.begin(), terms.end());
    }
  }

  // Cells that stay leaves move to `done`; returns the children of the others.
  [[nodiscard]] std::vector<SearchedCell> halve(std::vector<SearchedCell> frontier, std::vector<SearchedCell>& done) {
    const auto first_cold = std::stable_partition(frontier.begin(), frontier.end(), [this](const SearchedCell& searched) {
      return !searched.found.hot.empty() && searched.cell.key.level < space_.finest_level &&
             searched.cell.worst_predicted_ms <= (1.0 - kLeastGain) * searched.parent_ms;
    });
    std::move(first_cold, frontier.end(), std::back_inserter(done));
    frontier.erase(first_cold, frontier.end());
    std::stable_sort(frontier.begin(), frontier.end(),
                     [](const SearchedCell& a, const SearchedCell& b) { return a.cell.worst_predicted_ms > b.cell.worst_predicted_ms; });
    std::vector<SearchedCell> children;
    std::size_t next = 0;
    while (next < frontier.size() && within_limits()) {
      const std::size_t first = next;
      auto batch = search_children(frontier, child_tasks(frontier, next));
      for (std::size_t i = first; i < next; ++i) {
        terms_ -= frontier[i].found.terms.size();
        cpvs_ -= frontier[i].found.hot.size();
        frontier[i] = {};
      }
      for (const SearchedCell& child : batch) count(child);
      std::move(batch.begin(), batch.end(), std::back_inserter(children));
    }
    cells_not_halved_ += frontier.size() - next;
    std::move(frontier.begin() + static_cast<std::ptrdiff_t>(next), frontier.end(), std::back_inserter(done));
    return children;
  }

  const ViewSpace& space_;
  const Visibility& visibility_;
  const SubdivisionOptions& options_;
  const WorkBudget& budget_;
  SearchMemory* memory_;
  CellBoxes cell_boxes_;
  RegionEstimator estimator_;
  std::vector<std::uint32_t> all_objects_;
  std::uint64_t terms_ = 0;
  std::uint64_t cpvs_ = 0;
  std::uint64_t cells_not_halved_ = 0;
};

}  // namespace

Subdivision subdivide(const Scene& scene, const std::vector<std::uint32_t>& hierarchy_rank, const ViewSpace& view_space,
                      const Visibility& visibility, const TimeModel& model, const Camera& camera, const ViewSpaceOptions& options,
                      const SubdivisionOptions& subdivision_options, const WorkBudget& budget, SearchMemory* memory) {
  Subdivider subdivider(scene, hierarchy_rank, view_space, visibility, model, camera, options, subdivision_options, budget, memory);
  Subdivision result = subdivider.assemble(subdivider.run());
  if (subdivider.cells_not_halved() > 0)
    result.left_out.push_back("halving " + std::to_string(subdivider.cells_not_halved()) + " more hot cells in position: more than " +
                              std::to_string(subdivision_options.max_cpvs) + " problem views or " +
                              std::to_string(subdivision_options.max_terms) + " object terms otherwise");
  return result;
}

}  // namespace standin
