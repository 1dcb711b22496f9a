#include "placement/candidates/selection_input.h"

#include <algorithm>

#include "placement/candidates/cell_index.h"
#include "placement/candidates/cell_sets.h"
#include "render/base/parallel.h"

namespace standin {
namespace {

// A checker adds the same numbers up in another order: deficits are raised by more than that can move a sum.
constexpr double kRoundingShare = 1e-10;

constexpr std::uint32_t kForms = 2;

std::uint8_t form_of(const Cpv& cpv) {
  return cpv.pixels_capped ? 1 : 0;
}

/// Runs of candidates with the same node.
std::vector<IdRange> node_runs(const std::vector<Candidate>& candidates) {
  std::vector<IdRange> runs;
  for (std::uint32_t c = 0; c < candidates.size(); ++c) {
    if (runs.empty() || candidates[c].node != candidates[runs.back().begin].node) runs.push_back({c, c});
    runs.back().end = c + 1;
  }
  return runs;
}

/// Blocks of one node, numbered from 0, and the runs of its candidates.
struct NodeBlocks {
  std::vector<std::uint32_t> block_size;
  std::vector<std::uint32_t> cpv;
  std::vector<double> worth;
  std::vector<std::uint32_t> run_count;  // per candidate
  std::vector<BlockRun> runs;
};

/// One block per cell that the node's candidates serve. Cells of one leaf cube follow each other: candidates that serve whole leaves need
/// few runs.
class BlockMaker {
 public:
  BlockMaker(const CellIndex& index, const Subdivision& subdivision, std::span<const Candidate> candidates)
      : index_(index), subdivision_(subdivision), candidates_(candidates) {
    for (const Candidate& candidate : candidates) cells_.insert(cells_.end(), candidate.cells.begin(), candidate.cells.end());
    std::sort(cells_.begin(), cells_.end());
    cells_.erase(std::unique(cells_.begin(), cells_.end()), cells_.end());
    block_.resize(cells_.size());
    least_cost_.assign(cells_.size() * kForms, std::numeric_limits<double>::infinity());
  }

  /// `costs`: of the candidates, kForms each.
  NodeBlocks make(std::span<const double> costs) {
    NodeBlocks blocks;
    number_blocks();
    for (std::size_t c = 0; c < candidates_.size(); ++c) append_runs(candidates_[c].cells, costs.data() + c * kForms, blocks);
    for (const std::uint32_t position : order_) append_block(position, blocks);
    return blocks;
  }

 private:
  void number_blocks() {
    for (const CellGroup& group : group_cells(cells_, subdivision_, index_.leaf_level()))
      for (const std::uint32_t cell : group.cells) {
        block_[position(cell)] = static_cast<std::uint32_t>(order_.size());
        order_.push_back(position(cell));
      }
  }

  void append_runs(const std::vector<std::uint32_t>& cells, const double* costs, NodeBlocks& blocks) {
    std::vector<std::uint32_t> listed;
    for (const std::uint32_t cell : cells) {
      const std::uint32_t at = position(cell);
      listed.push_back(block_[at]);
      for (std::uint32_t form = 0; form < kForms; ++form)
        least_cost_[at * kForms + form] = std::min(least_cost_[at * kForms + form], costs[form]);
    }
    std::sort(listed.begin(), listed.end());
    const std::size_t before = blocks.runs.size();
    for (const std::uint32_t block : listed) {
      if (blocks.runs.size() > before && blocks.runs.back().end == block)
        ++blocks.runs.back().end;
      else
        blocks.runs.push_back({block, block + 1});
    }
    blocks.run_count.push_back(static_cast<std::uint32_t>(blocks.runs.size() - before));
  }

  void append_block(std::uint32_t at, NodeBlocks& blocks) const {
    const std::size_t before = blocks.cpv.size();
    const IdRange cpvs = index_.cpvs(cells_[at]);
    for (std::uint32_t p = cpvs.begin; p < cpvs.end; ++p) {
      const Cpv& cpv = subdivision_.cpvs[p];
      const double worth_ms = index_.terms_ms(cpv, candidates_.front().node);
      if (worth_ms <= least_cost_[at * kForms + form_of(cpv)]) continue;
      blocks.cpv.push_back(p);
      blocks.worth.push_back(worth_ms);
    }
    blocks.block_size.push_back(static_cast<std::uint32_t>(blocks.cpv.size() - before));
  }

  [[nodiscard]] std::uint32_t position(std::uint32_t cell) const {
    return static_cast<std::uint32_t>(std::lower_bound(cells_.begin(), cells_.end(), cell) - cells_.begin());
  }

  const CellIndex& index_;
  const Subdivision& subdivision_;
  std::span<const Candidate> candidates_;
  std::vector<std::uint32_t> cells_;  // ascending
  std::vector<std::uint32_t> block_;  // per position in cells_
  std::vector<std::uint32_t> order_;  // positions by block
  std::vector<double> least_cost_;    // per position and form
};

void append(const NodeBlocks& blocks, SelectionProblem& problem) {
  const std::uint32_t first = problem.block_count();
  for (const std::uint32_t size : blocks.block_size) problem.block_offset.push_back(problem.block_offset.back() + size);
  problem.cpv.insert(problem.cpv.end(), blocks.cpv.begin(), blocks.cpv.end());
  problem.worth.insert(problem.worth.end(), blocks.worth.begin(), blocks.worth.end());
  for (const BlockRun& run : blocks.runs) problem.runs.push_back({first + run.begin, first + run.end});
  for (const std::uint32_t count : blocks.run_count) problem.run_offset.push_back(problem.run_offset.back() + count);
}

/// So that nothing is copied while it grows: at city scale these are most of the memory.
void reserve(const std::vector<NodeBlocks>& all, SelectionProblem& problem) {
  std::size_t blocks = 0, entries = 0, runs = 0;
  for (const NodeBlocks& of_node : all) {
    blocks += of_node.block_size.size();
    entries += of_node.cpv.size();
    runs += of_node.runs.size();
  }
  if (entries >= UINT32_MAX)
    throw Failure(ErrorWord::kBadUsage, "the covering problem has " + std::to_string(entries) +
                                            " (cluster, region) pairs, which violates < 2^32 - 1; raise the budget or the leaf size");
  problem.block_offset.reserve(blocks + 1);
  problem.cpv.reserve(entries);
  problem.worth.reserve(entries);
  problem.runs.reserve(runs);
}

}  // namespace

void set_budget(SelectionProblem& problem, const Subdivision& subdivision, const SelectionBudget& budget) {
  problem.deficit.clear();
  for (const Cpv& cpv : subdivision.cpvs)
    problem.deficit.push_back(cpv.predicted_ms * (1.0 + kRoundingShare) - (budget.predicted_ms - budget.reserve_ms));
}

void set_impostor(SelectionProblem& problem, std::uint32_t candidate, double bytes, const ImpostorCost& cost, const TimeModel& model,
                  const Camera& camera) {
  const Cost drawing = model.cost(impostor_features_bound(cost, camera));
  problem.bytes[candidate] = bytes;
  problem.cost[candidate * kForms] = drawing.fixed_ms + drawing.pixel_ms;
  problem.cost[candidate * kForms + 1] = drawing.fixed_ms;
}

SelectionProblem make_selection_problem(const Hierarchy& hierarchy, const Subdivision& subdivision, const CandidateSet& candidates,
                                        const TimeModel& model, const Camera& camera, const SelectionBudget& budget, int threads,
                                        const WorkBudget& work) {
  const auto& list = candidates.candidates;
  SelectionProblem problem;
  problem.forms = kForms;
  for (const HierarchyNode& node : hierarchy.nodes) problem.parent.push_back(node.parent);
  for (const Cpv& cpv : subdivision.cpvs) problem.form.push_back(form_of(cpv));
  set_budget(problem, subdivision, budget);
  for (const Candidate& candidate : list) problem.node.push_back(candidate.node);
  problem.bytes.resize(list.size());
  problem.cost.resize(list.size() * kForms);
  for (std::uint32_t c = 0; c < list.size(); ++c) set_impostor(problem, c, list[c].bytes, list[c].cost, model, camera);

  const CellIndex index(hierarchy, subdivision);
  const auto runs = node_runs(list);
  std::vector<NodeBlocks> blocks(runs.size());
  parallel_for(runs.size(), threads, work, [&](std::size_t run) {
    const auto [begin, end] = runs[run];
    blocks[run] =
        BlockMaker(index, subdivision, std::span(list).subspan(begin, end - begin)).make(std::span(problem.cost).subspan(begin * kForms));
  });
  reserve(blocks, problem);
  problem.run_offset.reserve(list.size() + 1);
  for (NodeBlocks& of_node : blocks) {
    append(of_node, problem);
    of_node = {};
  }
  return problem;
}

}  // namespace standin
