#include "placement/select/serving.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace standin {
namespace {

constexpr std::uint32_t kNone = UINT32_MAX;

void require(bool holds, const char* what, std::uint64_t index) {
  if (!holds) throw Failure(ErrorWord::kBadUsage, std::string("selection problem: ") + what + " (at " + std::to_string(index) + ")");
}

void require_finite(const std::vector<double>& values, const char* what) {
  for (std::size_t i = 0; i < values.size(); ++i) require(std::isfinite(values[i]), what, i);
}

template <class Id>
void require_offsets(const std::vector<Id>& offset, std::size_t rows, std::size_t values, const char* what) {
  require(offset.size() == rows + 1 && offset.front() == 0 && offset.back() == values, what, offset.size());
  for (std::size_t i = 0; i < rows; ++i) require(offset[i] <= offset[i + 1], what, i);
}

void validate_sizes(const SelectionProblem& problem) {
  const std::size_t candidates = problem.node.size();
  require(problem.stages >= 1, "stages must be >= 1", problem.stages);
  require(problem.deficit.size() == problem.form.size() * problem.stages, "deficit must hold `stages` values per CPV",
          problem.deficit.size());
  require(problem.cpv.size() < UINT32_MAX, "entries must be fewer than 2^32 - 1", problem.cpv.size());
  require(!problem.block_offset.empty(), "block_offset must start at 0", 0);
  require_offsets(problem.block_offset, problem.block_offset.size() - 1, problem.cpv.size(), "block_offset must rise to the entries");
  require(problem.worth.size() == problem.cpv.size() * problem.stages, "worth must hold `stages` values per entry", problem.worth.size());
  require(problem.bytes.size() == candidates, "bytes must hold one value per candidate", problem.bytes.size());
  require(problem.cost.size() == candidates * problem.forms * problem.stages, "cost must hold forms * stages values per candidate",
          problem.cost.size());
  require_offsets(problem.run_offset, candidates, problem.runs.size(), "run_offset must rise to the number of runs");
}

void validate_blocks(const SelectionProblem& problem) {
  for (std::uint32_t b = 0; b < problem.block_count(); ++b)
    for (std::uint32_t e = problem.block_offset[b]; e < problem.block_offset[b + 1]; ++e) {
      require(problem.cpv[e] < problem.cpv_count(), "entry names a CPV that does not exist", e);
      require(e == problem.block_offset[b] || problem.cpv[e - 1] < problem.cpv[e], "CPVs of a block must ascend", e);
    }
}

void validate_candidates(const SelectionProblem& problem) {
  std::vector<std::uint32_t> node_of_block(problem.block_count(), kNone);
  std::vector<std::uint32_t> last_user(problem.block_count(), kNone);
  for (std::uint32_t c = 0; c < problem.candidate_count(); ++c) {
    require(problem.node[c] < problem.parent.size(), "node of a candidate is not in the tree", c);
    require(std::isfinite(problem.bytes[c]) && problem.bytes[c] > 0.0, "bytes must be finite and > 0", c);
    for (const BlockRun& run : problem.runs_of(c)) {
      require(run.begin <= run.end && run.end <= problem.block_count(), "run names a block that does not exist", c);
      for (std::uint32_t b = run.begin; b < run.end; ++b) {
        require(last_user[b] != c, "a block is listed twice by a candidate", c);
        require(node_of_block[b] == kNone || node_of_block[b] == problem.node[c], "a block is shared by two nodes", b);
        last_user[b] = c;
        node_of_block[b] = problem.node[c];
      }
    }
  }
}

}  // namespace

Columns::Columns(const SelectionProblem& problem, const TreeOrder& order) : problem_(problem), order_(order) {
  list_candidates();
  list_blocks();
  if (problem.stages == 1) find_best();
}

void Columns::list_candidates() {
  const auto for_each_block = [&](auto&& visit) {
    for (std::uint32_t c = 0; c < problem_.candidate_count(); ++c)
      for (const BlockRun& run : problem_.runs_of(c))
        for (std::uint32_t b = run.begin; b < run.end; ++b) visit(b, c);
  };
  candidate_offset_.assign(problem_.block_count() + 1, 0);
  for_each_block([&](std::uint32_t block, std::uint32_t) { ++candidate_offset_[block + 1]; });
  std::partial_sum(candidate_offset_.begin(), candidate_offset_.end(), candidate_offset_.begin());
  candidate_.resize(candidate_offset_.back());
  std::vector<std::uint64_t> next(candidate_offset_.begin(), candidate_offset_.end() - 1);
  for_each_block([&](std::uint32_t block, std::uint32_t candidate) { candidate_[next[block]++] = candidate; });
}

void Columns::list_blocks() {
  std::vector<std::uint32_t> used;
  rank_.assign(problem_.block_count(), kNone);
  for (std::uint32_t b = 0; b < problem_.block_count(); ++b) {
    if (candidates(b).empty()) continue;
    used.push_back(b);
    rank_[b] = order_.first(problem_.node[candidates(b).front()]);
  }
  std::stable_sort(used.begin(), used.end(), [&](std::uint32_t a, std::uint32_t b) { return rank_[a] < rank_[b]; });

  block_offset_.assign(problem_.cpv_count() + 1, 0);
  for (const std::uint32_t b : used)
    for (std::uint32_t e = problem_.block_offset[b]; e < problem_.block_offset[b + 1]; ++e) ++block_offset_[problem_.cpv[e] + 1];
  std::partial_sum(block_offset_.begin(), block_offset_.end(), block_offset_.begin());
  block_.resize(block_offset_.back());
  std::vector<std::uint64_t> next(block_offset_.begin(), block_offset_.end() - 1);
  for (const std::uint32_t b : used)
    for (std::uint32_t e = problem_.block_offset[b]; e < problem_.block_offset[b + 1]; ++e) block_[next[problem_.cpv[e]]++] = b;
}

void Columns::find_best() {
  const std::uint32_t forms = problem_.forms;
  best_.assign(static_cast<std::size_t>(problem_.block_count()) * forms, kNone);
  const auto better = [&](std::uint32_t a, std::uint32_t b, std::uint32_t form) {
    const double cost_a = problem_.cost[static_cast<std::size_t>(a) * forms + form];
    const double cost_b = problem_.cost[static_cast<std::size_t>(b) * forms + form];
    return cost_a != cost_b ? cost_a < cost_b : problem_.bytes[a] < problem_.bytes[b];
  };
  for (std::uint32_t b = 0; b < problem_.block_count(); ++b)
    for (std::uint32_t form = 0; form < forms; ++form)
      for (const std::uint32_t candidate : candidates(b))
        if (std::uint32_t& best = best_[static_cast<std::size_t>(b) * forms + form]; best == kNone || better(candidate, best, form))
          best = candidate;
}

std::uint32_t Columns::entry(std::uint32_t block, std::uint32_t cpv) const {
  const auto begin = problem_.cpv.begin() + problem_.block_offset[block];
  const auto end = problem_.cpv.begin() + problem_.block_offset[block + 1];
  return static_cast<std::uint32_t>(std::lower_bound(begin, end, cpv) - problem_.cpv.begin());
}

void Columns::read(std::uint32_t cpv, std::vector<Serving>& servings) const {
  servings.clear();
  for (const std::uint32_t block : blocks(cpv)) {
    const std::uint32_t at = entry(block, cpv);
    for (const std::uint32_t candidate : candidates(block))
      if (problem_.serves(candidate, at)) servings.push_back({candidate, at});
  }
}

void Columns::read_best(std::uint32_t cpv, std::vector<Serving>& servings) const {
  servings.clear();
  for (const std::uint32_t block : blocks(cpv)) {
    const Serving best{best_[static_cast<std::size_t>(block) * problem_.forms + problem_.form[cpv]], entry(block, cpv)};
    if (problem_.serves(best.candidate, best.entry)) servings.push_back(best);
  }
}

std::vector<bool> Columns::candidates_without(std::span<const std::uint32_t> cpvs) const {
  std::vector<bool> looked_at(problem_.block_count(), false);
  std::vector<bool> without(problem_.candidate_count(), true);
  for (const std::uint32_t cpv : cpvs) {
    for (const std::uint32_t block : blocks(cpv)) {
      if (looked_at[block]) continue;
      looked_at[block] = true;
      for (const std::uint32_t candidate : candidates(block)) without[candidate] = false;
    }
  }
  return without;
}

std::uint64_t Columns::coverage(std::uint32_t cpv) const {
  std::uint64_t count = 0;
  for (const std::uint32_t block : blocks(cpv)) count += candidates(block).size();
  return count;
}

void validate(const SelectionProblem& problem) {
  validate_sizes(problem);
  for (std::size_t n = 0; n < problem.parent.size(); ++n)
    require(problem.parent[n] >= -1 && problem.parent[n] < static_cast<std::int64_t>(n), "parent[n] must be < n or -1", n);
  for (std::size_t p = 0; p < problem.form.size(); ++p) require(problem.form[p] < problem.forms, "form must be < forms", p);
  require_finite(problem.deficit, "deficit must be finite");
  require_finite(problem.worth, "worth must be finite");
  require_finite(problem.cost, "cost must be finite");
  validate_blocks(problem);
  validate_candidates(problem);
}

}  // namespace standin
