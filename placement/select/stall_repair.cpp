#include "placement/select/stall_repair.h"

#include <algorithm>

namespace standin {
namespace {

struct Missing {
  double bytes_per_gain = 0.0;
  std::uint32_t candidate = 0;
};

double useful_gain(const SelectionProblem& problem, std::uint32_t cpv, const Serving& serving) {
  double sum = 0.0;
  for (std::uint32_t k = 0; k < problem.stages; ++k) {
    const double gain = problem.gain(serving.candidate, serving.entry, k);
    const double deficit = problem.deficit[static_cast<std::size_t>(cpv) * problem.stages + k];
    sum += std::min(std::max(gain, 0.0), std::max(deficit, 0.0));
  }
  return sum;
}

std::vector<Missing> missing_members(const SelectionProblem& problem, const Cover& cover, std::uint32_t cpv, const Antichain& best) {
  std::vector<Missing> missing;
  for (const Serving& serving : best.members)
    // Infinite where only a negative gain is left to a member: added last, if at all.
    if (!cover.contains(serving.candidate))
      missing.push_back({problem.bytes[serving.candidate] / useful_gain(problem, cpv, serving), serving.candidate});
  std::sort(missing.begin(), missing.end(), [](const Missing& a, const Missing& b) {
    return a.bytes_per_gain != b.bytes_per_gain ? a.bytes_per_gain < b.bytes_per_gain : a.candidate < b.candidate;
  });
  return missing;
}

}  // namespace

void repair_stall(const SelectionProblem& problem, Cover& cover, std::uint32_t cpv, const Antichain& best) {
  for (const Missing& missing : missing_members(problem, cover, cpv, best)) {
    cover.add(missing.candidate);
    if (Antichain now = cover.best(cpv); now.meets()) {
      cover.assign(cpv, std::move(now.members));
      return;
    }
  }
  // All of `best` is in S, and nothing cheaper was found on the way.
  cover.assign(cpv, best.members);
}

}  // namespace standin
