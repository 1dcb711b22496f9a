#include "placement/select/serving.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace standin {
namespace {

std::vector<std::uint32_t> candidates_by_rank(const SelectionProblem& problem, const TreeOrder& order) {
  std::vector<std::uint32_t> candidates(problem.candidate_count());
  std::iota(candidates.begin(), candidates.end(), 0U);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return order.first(problem.node[a]) < order.first(problem.node[b]); });
  return candidates;
}

void require(bool holds, const std::string& what, std::uint64_t index) {
  if (!holds) throw Failure(ErrorWord::kBadUsage, "selection problem: " + what + " (at " + std::to_string(index) + ")");
}

void validate_sizes(const SelectionProblem& problem) {
  const std::size_t candidates = problem.node.size();
  require(problem.stages >= 1, "stages must be >= 1", problem.stages);
  require(problem.deficit.size() % problem.stages == 0, "deficit must hold `stages` values per CPV", problem.deficit.size());
  require(problem.bytes.size() == candidates, "bytes must hold one value per candidate", problem.bytes.size());
  require(problem.offset.size() == candidates + 1 && problem.offset.front() == 0, "offset must start at 0 and hold candidates + 1 values",
          problem.offset.size());
  require(problem.offset.back() == problem.cpv.size(), "offset must end at the number of entries", problem.cpv.size());
  require(problem.cpv.size() < UINT32_MAX, "entries must be fewer than 2^32", problem.cpv.size());
  require(problem.gain.size() == problem.cpv.size() * problem.stages, "gain must hold `stages` values per entry", problem.gain.size());
}

void validate_row(const SelectionProblem& problem, std::uint32_t candidate) {
  require(problem.node[candidate] < problem.parent.size(), "node of a candidate is not in the tree", candidate);
  require(std::isfinite(problem.bytes[candidate]) && problem.bytes[candidate] > 0.0, "bytes must be finite and > 0", candidate);
  require(problem.offset[candidate] <= problem.offset[candidate + 1] && problem.offset[candidate + 1] <= problem.cpv.size(),
          "offset must not fall", candidate);
  for (std::uint64_t e = problem.offset[candidate]; e < problem.offset[candidate + 1]; ++e) {
    require(problem.cpv[e] < problem.cpv_count(), "entry names a CPV that does not exist", e);
    require(e == problem.offset[candidate] || problem.cpv[e - 1] < problem.cpv[e], "CPVs of a row must ascend", e);
  }
}

}  // namespace

Columns::Columns(const SelectionProblem& problem, const TreeOrder& order)
    : offset_(problem.cpv_count() + 1, 0), servings_(problem.cpv.size()) {
  for (const std::uint32_t cpv : problem.cpv) ++offset_[cpv + 1];
  std::partial_sum(offset_.begin(), offset_.end(), offset_.begin());
  std::vector<std::uint64_t> next(offset_.begin(), offset_.end() - 1);
  for (const std::uint32_t candidate : candidates_by_rank(problem, order))
    for (std::uint64_t e = problem.offset[candidate]; e < problem.offset[candidate + 1]; ++e)
      servings_[next[problem.cpv[e]]++] = {candidate, static_cast<std::uint32_t>(e)};
}

void validate(const SelectionProblem& problem) {
  validate_sizes(problem);
  for (std::size_t n = 0; n < problem.parent.size(); ++n)
    require(problem.parent[n] >= -1 && problem.parent[n] < static_cast<std::int64_t>(n), "parent[n] must be < n or -1", n);
  for (std::size_t p = 0; p < problem.deficit.size(); ++p) require(std::isfinite(problem.deficit[p]), "deficit must be finite", p);
  for (std::size_t g = 0; g < problem.gain.size(); ++g) require(std::isfinite(problem.gain[g]), "gain must be finite", g);
  for (std::uint32_t c = 0; c < problem.candidate_count(); ++c) validate_row(problem, c);
}

}  // namespace standin
