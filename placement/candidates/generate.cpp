// Candidates of every node, node by node and independent of each other.
#include <algorithm>
#include <iterator>
#include <set>

#include "placement/candidates/planar_parts.h"
#include "render/base/parallel.h"

namespace standin {
namespace {

/// A cell that can do with an impostor of the node: its own tight one is possible and gains something.
struct UsefulCell {
  std::uint32_t cell = 0;
  std::vector<double> terms_ms;  // of the node's objects, per CPV of the cell
  bool for_layers = false;       // a layered one is
};

class NodeCandidates {
 public:
  NodeCandidates(const DraftContext& context, std::uint32_t node) : context_(context), node_(node) {}

  CandidateSet generate(const DirectionGrid& grid, int leaf_level, const CandidateOptions& options) {
    serve_single_cells();
    for (const CellSet& cells : cells_to_serve()) {
      if (options.shape == CellShape::kPyramid) {
        serve_pyramids(cells, grid, leaf_level, options.apex_deg);
        continue;
      }
      serve_cubes(cells, options.shape == CellShape::kBox ? 0 : leaf_level);
      if (options.shape == CellShape::kShaft) serve_shafts(cells, grid, leaf_level, options.apex_deg);
    }
    if (context_.sizes.offers(Technique::kPlanar) && options.shape != CellShape::kPyramid) serve_planar_parts();
    return std::move(set_);
  }

 private:
  // A larger view cell around one of these costs more than the tight one: cells that fail here serve in no set.
  void serve_single_cells() {
    for (const std::uint32_t cell : context_.index.cells_seeing(node_)) {
      auto drafts = draft_candidates(context_, node_, {cell});
      CandidateSet uncounted;
      CandidateSet& set = offers_single_cells() ? set_ : uncounted;
      set.generated += std::max<std::size_t>(drafts.size(), 1);
      if (drafts.empty()) {
        ++set.impossible;
        continue;
      }
      UsefulCell useful{cell, {}, false};
      const IdRange cpvs = context_.index.cpvs(cell);
      for (std::uint32_t p = cpvs.begin; p < cpvs.end; ++p)
        useful.terms_ms.push_back(context_.index.terms_ms(context_.subdivision.cpvs[p], node_));
      set.hopeless += std::erase_if(drafts, [&](const Draft& draft) { return !gains(useful, draft.cost); });
      if (drafts.empty()) continue;
      useful.for_layers = drafts.front().candidate.technique == Technique::kLayered;
      useful_.push_back(std::move(useful));
      if (offers_single_cells()) keep(std::move(drafts));
    }
  }

  void serve_cubes(const CellSet& useful, int coarsest_level) {
    for (const CellSet& cells : distinct(box_cell_sets(useful, context_.subdivision, coarsest_level))) serve(cells);
  }

  void serve_shafts(const CellSet& useful, const DirectionGrid& grid, int leaf_level, std::span<const double> apex_deg) {
    const auto groups = group_cells(useful, context_.subdivision, leaf_level);
    for (const GroupSet& set : distinct(shaft_group_sets(context_.hierarchy.nodes[node_].bounds, groups, grid, apex_deg)))
      serve(cells_of(set, groups));
  }

  // Those with the same groups are told apart by their view cells alone: pyramids() keeps one of them.
  void serve_pyramids(const CellSet& useful, const DirectionGrid& grid, int leaf_level, std::span<const double> apex_deg) {
    const auto groups = group_cells(useful, context_.subdivision, leaf_level);
    for (const Pyramid& pyramid : pyramids(context_.hierarchy.nodes[node_].bounds, groups, grid, apex_deg)) {
      const CellSet cells = cells_of(pyramid.groups, groups);
      ++set_.generated;
      if (is_new(cells)) serve(cells, draft_candidates(context_, node_, cells, pyramid.shaft));
    }
  }

  /// Those that a layered impostor is useful for, and all: further techniques add sets and take none away.
  [[nodiscard]] std::vector<CellSet> cells_to_serve() const {
    CellSet for_layers, all;
    for (const UsefulCell& useful : useful_) {
      all.push_back(useful.cell);
      if (useful.for_layers) for_layers.push_back(useful.cell);
    }
    if (for_layers == all || for_layers.empty()) return {all};
    return {for_layers, all};
  }

  template <class Set>
  std::vector<Set> distinct(std::vector<Set> sets) {
    const std::size_t before = sets.size();
    std::sort(sets.begin(), sets.end());
    sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
    set_.generated += before;
    set_.duplicates += before - sets.size();
    return sets;
  }

  void serve(const CellSet& cells) {
    if (is_new(cells)) serve(cells, draft_candidates(context_, node_, cells));
  }

  bool is_new(const CellSet& cells) {
    const bool fresh = !offers_more_than_layers() || served_.insert(cells).second;
    if (!fresh) ++set_.duplicates;
    return fresh;
  }

  void serve(const CellSet& cells, std::vector<Draft> drafts) {
    if (drafts.empty())
      ++set_.impossible;
    else
      set_.generated += drafts.size() - 1;  // the set itself is counted
    set_.hopeless += std::erase_if(drafts, [&](const Draft& draft) { return !gains_anywhere(cells, draft.cost); });
    keep(std::move(drafts));
  }

  /// Of all sets served so far that one layer is not enough for.
  void serve_planar_parts() {
    const std::set<CellSet> whole = served_;
    for (const UsefulCell& useful : useful_) served_.insert({useful.cell});
    for (const CellSet& cells : whole)
      if (!draft_planar(context_, node_, cells)) serve_halves(cells, 1);
  }

  void serve_halves(const CellSet& cells, int depth) {
    constexpr int kMostHalvings = 4;
    const auto halves = halved_across(context_, node_, cells);
    if (halves.second.empty()) return;
    for (const CellSet* half : {&halves.first, &halves.second}) {
      if (!served_.insert(*half).second) continue;  // it was offered as whatever it needs, and is halved in its own turn
      ++set_.generated;
      if (auto draft = draft_planar(context_, node_, *half)) {
        serve_part(std::move(*draft));
        continue;
      }
      ++set_.impossible;
      if (depth < kMostHalvings && half->size() > 1) serve_halves(*half, depth + 1);
    }
  }

  void serve_part(Draft planar) {
    if (!gains_anywhere(planar.candidate.cells, planar.cost))
      ++set_.hopeless;
    else
      keep({std::move(planar)});
  }

  /// All of one cluster and view cell.
  void keep(std::vector<Draft> drafts) {
    if (drafts.empty()) return;
    if (belongs_to_child(context_, node_, drafts.front().candidate.cells)) {
      set_.duplicates += drafts.size();
      return;
    }
    for (Draft& draft : drafts) set_.candidates.push_back(std::move(draft.candidate));
  }

  /// Pyramids are a baseline without the tight shafts around single cells; these still tell which cells are useful.
  [[nodiscard]] bool offers_single_cells() const { return context_.shape != CellShape::kPyramid; }

  [[nodiscard]] bool offers_more_than_layers() const {
    const auto offered = [&](Technique technique) { return context_.sizes.offers(technique); };
    return offered(Technique::kDepthMesh) || offered(Technique::kPlanar) || offered(Technique::kLodSprite);
  }

  [[nodiscard]] bool gains(const UsefulCell& useful, const Cost& cost) const {
    const std::uint32_t first = context_.index.cpvs(useful.cell).begin;
    for (std::uint32_t i = 0; i < useful.terms_ms.size(); ++i)
      if (useful.terms_ms[i] > in_form(cost, context_.subdivision.cpvs[first + i])) return true;
    return false;
  }

  [[nodiscard]] bool gains_anywhere(const CellSet& cells, const Cost& cost) const {
    auto useful = useful_.begin();
    for (const std::uint32_t cell : cells) {  // both ascend
      while (useful->cell < cell) ++useful;
      if (gains(*useful, cost)) return true;
    }
    return false;
  }

  const DraftContext& context_;
  std::uint32_t node_;
  std::vector<UsefulCell> useful_;  // ascending cells
  std::set<CellSet> served_;        // of two or more cells; not kept where layered impostors alone are offered
  CandidateSet set_;
};

}  // namespace

CandidateSet generate_candidates(const Scene& scene, const Hierarchy& hierarchy, const Subdivision& subdivision, const TimeModel& model,
                                 const SizeModels& sizes, const Camera& camera, const BakeQuality& quality, const CandidateOptions& options,
                                 const WorkBudget& budget) {
  const CellIndex index(hierarchy, subdivision);
  const DirectionGrid grid(options.direction_step_deg, options.every_direction);
  const ObjectOutlines outlines(scene);
  const DraftContext context{scene, hierarchy, subdivision, index, outlines, model, sizes, camera, quality, options.shape};
  const int leaf_level = context.index.leaf_level();
  std::vector<CandidateSet> of_node(hierarchy.nodes.size());
  parallel_for(of_node.size(), options.threads, budget, [&](std::size_t node) {
    of_node[node] = NodeCandidates(context, static_cast<std::uint32_t>(node)).generate(grid, leaf_level, options);
  });

  CandidateSet all;
  std::size_t count = 0;
  for (const CandidateSet& set : of_node) count += set.candidates.size();
  all.candidates.reserve(count);
  for (CandidateSet& set : of_node) {
    all.generated += set.generated;
    all.duplicates += set.duplicates;
    all.impossible += set.impossible;
    all.hopeless += set.hopeless;
    std::move(set.candidates.begin(), set.candidates.end(), std::back_inserter(all.candidates));
    set = {};
  }
  return all;
}

}  // namespace standin
