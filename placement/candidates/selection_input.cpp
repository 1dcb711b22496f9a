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
  std::vector<std::uint32_t> cell;       // per block
  std::vector<std::uint32_t> size;       // per block: its entries
  std::vector<double> least_cost;        // per block and form, over the candidates that list it
  std::vector<std::uint32_t> run_count;  // per candidate
  std::vector<BlockRun> runs;
};

/// One block per cell that the node's candidates serve. Cells of one leaf cube follow each other: candidates that serve whole leaves need
/// few runs.
class BlockMaker {
 public:
  BlockMaker(const CellIndex& index, const Subdivision& subdivision) : index_(index), subdivision_(subdivision) {}

  /// `costs`: of the candidates, kForms each. All candidates have the same node.
  [[nodiscard]] NodeBlocks make(std::span<const Candidate> candidates, std::span<const double> costs) const {
    NodeBlocks blocks;
    std::vector<std::uint32_t> cells;
    for (const Candidate& candidate : candidates) cells.insert(cells.end(), candidate.cells.begin(), candidate.cells.end());
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    for (const CellGroup& group : group_cells(cells, subdivision_, index_.leaf_level()))
      blocks.cell.insert(blocks.cell.end(), group.cells.begin(), group.cells.end());
    std::vector<std::uint32_t> block_of(cells.size());
    const auto position = [&](std::uint32_t cell) { return std::lower_bound(cells.begin(), cells.end(), cell) - cells.begin(); };
    for (std::uint32_t b = 0; b < blocks.cell.size(); ++b) block_of[static_cast<std::size_t>(position(blocks.cell[b]))] = b;

    blocks.least_cost.assign(cells.size() * kForms, std::numeric_limits<double>::infinity());
    std::vector<std::uint32_t> listed;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      listed.clear();
      for (const std::uint32_t cell : candidates[c].cells) listed.push_back(block_of[static_cast<std::size_t>(position(cell))]);
      append_runs(listed, costs.subspan(c * kForms, kForms), blocks);
    }
    for (std::uint32_t b = 0; b < blocks.cell.size(); ++b) {
      blocks.size.push_back(0);
      for_each_entry(blocks, b, candidates.front().node, [&](std::uint32_t, double) { ++blocks.size.back(); });
    }
    return blocks;
  }

  /// Calls visit(cpv, worth) where some candidate gains, in ascending order.
  template <class Visit>
  void for_each_entry(const NodeBlocks& blocks, std::uint32_t block, std::uint32_t node, Visit&& visit) const {
    const IdRange cpvs = index_.cpvs(blocks.cell[block]);
    for (std::uint32_t p = cpvs.begin; p < cpvs.end; ++p) {
      const Cpv& cpv = subdivision_.cpvs[p];
      const double worth_ms = index_.terms_ms(cpv, node);
      if (worth_ms > blocks.least_cost[block * kForms + form_of(cpv)]) visit(p, worth_ms);
    }
  }

 private:
  static void append_runs(std::vector<std::uint32_t>& listed, std::span<const double> costs, NodeBlocks& blocks) {
    std::sort(listed.begin(), listed.end());
    const std::size_t before = blocks.runs.size();
    for (const std::uint32_t block : listed) {
      for (std::uint32_t form = 0; form < kForms; ++form) {
        double& least = blocks.least_cost[block * kForms + form];
        least = std::min(least, costs[form]);
      }
      if (blocks.runs.size() > before && blocks.runs.back().end == block)
        ++blocks.runs.back().end;
      else
        blocks.runs.push_back({block, block + 1});
    }
    blocks.run_count.push_back(static_cast<std::uint32_t>(blocks.runs.size() - before));
  }

  const CellIndex& index_;
  const Subdivision& subdivision_;
};

/// Numbers the blocks of all nodes through; returns the first of each.
std::vector<std::uint32_t> lay_out(const std::vector<NodeBlocks>& all, SelectionProblem& problem) {
  std::vector<std::uint32_t> first;
  std::uint64_t entries = 0;
  for (const NodeBlocks& blocks : all) {
    first.push_back(problem.block_count());
    for (const std::uint32_t size : blocks.size) problem.block_offset.push_back(static_cast<std::uint32_t>(entries += size));
    for (const BlockRun& run : blocks.runs) problem.runs.push_back({first.back() + run.begin, first.back() + run.end});
    for (const std::uint32_t count : blocks.run_count) problem.run_offset.push_back(problem.run_offset.back() + count);
  }
  if (entries >= UINT32_MAX)
    throw Failure(ErrorWord::kBadUsage, "the covering problem's " + std::to_string(entries) +
                                            " (cluster, region) pairs violate < 2^32 - 1; raise the budget or the leaf size");
  problem.cpv.resize(entries);
  problem.worth.resize(entries);
  return first;
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

void rule_out(SelectionProblem& problem, std::uint32_t candidate) {
  constexpr double kNever_ms = 1e15;
  std::fill_n(problem.cost.begin() + static_cast<std::ptrdiff_t>(candidate) * kForms, kForms, kNever_ms);
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

  // Twice through the terms: once to know how large it gets, once to write in place. At city scale this is most of the memory.
  const CellIndex index(hierarchy, subdivision);
  const BlockMaker maker(index, subdivision);
  const auto runs = node_runs(list);
  std::vector<NodeBlocks> blocks(runs.size());
  parallel_for(runs.size(), threads, work, [&](std::size_t run) {
    const auto [begin, end] = runs[run];
    blocks[run] = maker.make(std::span(list).subspan(begin, end - begin), std::span(problem.cost).subspan(begin * kForms));
  });
  const auto first_block = lay_out(blocks, problem);
  parallel_for(runs.size(), threads, work, [&](std::size_t run) {
    std::uint32_t entry = problem.block_offset[first_block[run]];
    for (std::uint32_t b = 0; b < blocks[run].cell.size(); ++b)
      maker.for_each_entry(blocks[run], b, list[runs[run].begin].node, [&](std::uint32_t cpv, double worth_ms) {
        problem.cpv[entry] = cpv;
        problem.worth[entry++] = worth_ms;
      });
  });
  return problem;
}

}  // namespace standin
