#include "placement/select/reverse_delete.h"

#include <algorithm>
#include <utility>

namespace standin {
namespace {

void sort_by_falling_bytes(const SelectionProblem& problem, std::vector<std::uint32_t>& candidates) {
  std::sort(candidates.begin(), candidates.end(), [&](std::uint32_t a, std::uint32_t b) {
    return problem.bytes[a] != problem.bytes[b] ? problem.bytes[a] > problem.bytes[b] : a < b;
  });
}

/// Members that the candidate could make redundant: only those in use where it serves.
std::vector<std::uint32_t> rivals(const SelectionProblem& problem, const Cover& cover, std::uint32_t candidate) {
  std::vector<std::uint32_t> result;
  problem.for_each_served(candidate, [&](std::uint32_t entry) {
    for (const Serving& used : cover.antichain(problem.cpv[entry])) result.push_back(used.candidate);
  });
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

struct Removed {
  std::uint32_t candidate = 0;
  std::vector<Assignment> previous;
};

/// Adds the candidate and drops what it makes redundant; leaves the cover as it was unless memory falls.
bool try_exchange(const SelectionProblem& problem, Cover& cover, std::uint32_t candidate) {
  std::vector<std::uint32_t> droppable = rivals(problem, cover, candidate);
  double most = 0.0;
  for (const std::uint32_t rival : droppable) most += problem.bytes[rival];
  if (most <= problem.bytes[candidate]) return false;

  sort_by_falling_bytes(problem, droppable);
  cover.add(candidate);
  std::vector<Removed> removed;
  double freed = 0.0;
  for (const std::uint32_t rival : droppable) {
    auto replacements = cover.replacements(rival);
    if (!replacements) continue;
    removed.push_back({rival, cover.remove(rival, std::move(*replacements))});
    freed += problem.bytes[rival];
  }
  if (freed > problem.bytes[candidate]) return true;
  for (; !removed.empty(); removed.pop_back()) cover.put_back(removed.back().candidate, std::move(removed.back().previous));
  cover.remove(candidate, {});
  return false;
}

}  // namespace

bool reverse_delete(const SelectionProblem& problem, Cover& cover, const WorkBudget& budget, SelectionWork& work) {
  std::vector<std::uint32_t> members = cover.members();
  sort_by_falling_bytes(problem, members);
  for (const std::uint32_t member : members) {
    budget.check();
    if (work.exhausted()) return false;
    work.spend(problem.listed(member));
    if (auto replacements = cover.replacements(member)) cover.remove(member, std::move(*replacements));
  }
  return true;
}

bool exchange(const SelectionProblem& problem, Cover& cover, int rounds, const WorkBudget& budget, SelectionWork& work) {
  for (int round = 0; round < rounds; ++round) {
    bool improved = false;
    for (std::uint32_t c = 0; c < problem.candidate_count(); ++c) {
      budget.check();
      if (work.exhausted()) return false;
      work.spend(problem.listed(c));
      if (!cover.contains(c) && try_exchange(problem, cover, c)) improved = true;
    }
    if (!improved) break;
  }
  return true;
}

}  // namespace standin
