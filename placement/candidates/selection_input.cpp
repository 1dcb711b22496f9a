#include "placement/candidates/selection_input.h"

#include <algorithm>
#include <iterator>
#include <unordered_map>

#include "placement/candidates/draft.h"
#include "render/base/parallel.h"

namespace standin {
namespace {

// A checker adds the same numbers up in another order: deficits are raised by more than that can move a sum.
constexpr double kRoundingShare = 1e-10;

/// Rows of consecutive candidates of one node.
struct Rows {
  std::vector<std::uint64_t> size;  // per candidate
  std::vector<std::uint32_t> cpv;
  std::vector<double> gain;
};

/// Candidates of a node share most of their cells, so its terms are added up once per cell.
class NodeTerms {
 public:
  NodeTerms(const CellIndex& index, const Subdivision& subdivision, std::uint32_t node)
      : index_(index), subdivision_(subdivision), node_(node) {}

  const std::vector<double>& of(std::uint32_t cell) {
    const auto [at, added] = terms_ms_.try_emplace(cell);
    if (added) {
      const IdRange cpvs = index_.cpvs(cell);
      for (std::uint32_t p = cpvs.begin; p < cpvs.end; ++p) at->second.push_back(index_.terms_ms(subdivision_.cpvs[p], node_));
    }
    return at->second;
  }

 private:
  const CellIndex& index_;
  const Subdivision& subdivision_;
  std::uint32_t node_;
  std::unordered_map<std::uint32_t, std::vector<double>> terms_ms_;  // looked up only
};

void append_row(const CellIndex& index, const Subdivision& subdivision, const Candidate& candidate, const Cost& cost, NodeTerms& terms,
                Rows& rows) {
  const std::size_t before = rows.cpv.size();
  for (const std::uint32_t cell : candidate.cells) {
    const auto& terms_ms = terms.of(cell);
    const std::uint32_t first = index.cpvs(cell).begin;
    for (std::uint32_t i = 0; i < terms_ms.size(); ++i) {
      const double gain_ms = terms_ms[i] - in_form(cost, subdivision.cpvs[first + i]);
      if (gain_ms <= 0.0) continue;
      rows.cpv.push_back(first + i);
      rows.gain.push_back(gain_ms);
    }
  }
  rows.size.push_back(rows.cpv.size() - before);
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

void append(const Rows& rows, SelectionProblem& problem) {
  for (const std::uint64_t size : rows.size) problem.offset.push_back(problem.offset.back() + size);
  problem.cpv.insert(problem.cpv.end(), rows.cpv.begin(), rows.cpv.end());
  problem.gain.insert(problem.gain.end(), rows.gain.begin(), rows.gain.end());
}

}  // namespace

SelectionProblem make_selection_problem(const Hierarchy& hierarchy, const Subdivision& subdivision, const CandidateSet& candidates,
                                        const std::vector<std::optional<BakedSize>>& baked, const TimeModel& model, const Camera& camera,
                                        const SelectionBudget& budget, int threads, const WorkBudget& work) {
  const auto& list = candidates.candidates;
  const auto real = [&](std::uint32_t c) { return c < baked.size() ? baked[c] : std::nullopt; };
  SelectionProblem problem;
  for (const HierarchyNode& node : hierarchy.nodes) problem.parent.push_back(node.parent);
  for (const Cpv& cpv : subdivision.cpvs)
    problem.deficit.push_back(cpv.predicted_ms * (1.0 + kRoundingShare) - (budget.predicted_ms - budget.reserve_ms));
  for (std::uint32_t c = 0; c < list.size(); ++c) {
    problem.node.push_back(list[c].node);
    problem.bytes.push_back(real(c) ? real(c)->bytes : list[c].bytes);
  }

  const CellIndex index(hierarchy, subdivision);
  const auto runs = node_runs(list);
  std::vector<Rows> rows(runs.size());
  parallel_for(runs.size(), threads, work, [&](std::size_t run) {
    NodeTerms terms(index, subdivision, list[runs[run].begin].node);
    for (std::uint32_t c = runs[run].begin; c < runs[run].end; ++c) {
      const Cost cost = model.cost(impostor_features_bound(real(c) ? real(c)->cost : list[c].cost, camera));
      append_row(index, subdivision, list[c], cost, terms, rows[run]);
    }
  });
  problem.offset.push_back(0);
  for (Rows& of_node : rows) {
    append(of_node, problem);
    of_node = {};
  }
  return problem;
}

}  // namespace standin
