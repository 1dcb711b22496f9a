#include "placement/select/antichain.h"

#include <algorithm>

namespace standin {
namespace {

constexpr std::uint64_t kMaxSearchSteps = 200'000;

}  // namespace

Antichain AntichainFinder::best(std::span<const Serving> servings, std::uint32_t cpv, std::uint32_t without) {
  chosen_.clear();
  if (problem_.stages == 1)
    best_by_tree(servings, without);
  else
    search_stages(servings, cpv, without);
  return evaluated(chosen_, cpv);
}

// Backwards through the ranks every subtree is complete before its root comes up; `tops_` holds the values of complete subtrees, nearest
// rank on top, so a node's children are the topmost ones within its range.
void AntichainFinder::best_by_tree(std::span<const Serving> servings, std::uint32_t without) {
  groups_.clear();
  tops_.clear();
  const auto better = [&](const Serving& a, const Serving& b) {
    if (gain(a, 0) != gain(b, 0)) return gain(a, 0) > gain(b, 0);
    if (problem_.bytes[a.candidate] != problem_.bytes[b.candidate]) return problem_.bytes[a.candidate] < problem_.bytes[b.candidate];
    return a.candidate < b.candidate;
  };
  for (std::size_t i = servings.size(); i > 0;) {
    const std::uint32_t node_rank = rank(servings[i - 1]);
    Group group{last_rank(servings[i - 1]), {kNoCandidate, 0}, false};
    for (; i > 0 && rank(servings[i - 1]) == node_rank; --i)
      if (const Serving& s = servings[i - 1]; s.candidate != without && gain(s, 0) > 0.0)
        if (group.best.candidate == kNoCandidate || better(s, group.best)) group.best = s;
    if (group.best.candidate == kNoCandidate) continue;

    GainSum children = 0.0L;
    for (; !tops_.empty() && tops_.back().rank <= group.last_rank; tops_.pop_back()) children += tops_.back().value;
    group.own = gain(group.best, 0) >= children;
    tops_.push_back({node_rank, std::max<GainSum>(gain(group.best, 0), children)});
    groups_.push_back(group);
  }
  choose_greatest(chosen_);
}

void AntichainFinder::choose_greatest(std::vector<Serving>& chosen) const {
  for (std::size_t g = groups_.size(); g > 0;) {
    const Group& group = groups_[--g];
    if (!group.own) continue;
    chosen.push_back(group.best);
    while (g > 0 && rank(groups_[g - 1].best) <= group.last_rank) --g;  // its descendants are covered
  }
}

// suffix_[i] bounds what allowed_[i..] can still add, one stage at a time: the same DP, its forest summed at every step.
void AntichainFinder::bound_suffixes() {
  const std::uint32_t stages = problem_.stages;
  suffix_.assign((allowed_.size() + 1) * stages, 0.0L);
  for (std::uint32_t k = 0; k < stages; ++k) {
    tops_.clear();
    GainSum total = 0.0L;
    for (std::size_t i = allowed_.size(); i-- > 0;) {
      GainSum inside = 0.0L;
      for (; !tops_.empty() && tops_.back().rank <= last_rank(allowed_[i]); tops_.pop_back()) inside += tops_.back().value;
      const GainSum value = std::max<GainSum>(inside, gain(allowed_[i], k));
      tops_.push_back({rank(allowed_[i]), value});
      total += value - inside;
      suffix_[i * stages + k] = total;
    }
  }
}

GainSum AntichainFinder::missing(const GainSum* gained, const GainSum* further, std::uint32_t cpv) const {
  GainSum sum = 0.0L;
  for (std::uint32_t k = 0; k < problem_.stages; ++k)
    sum += std::max(problem_.deficit[static_cast<std::size_t>(cpv) * problem_.stages + k] - gained[k] - further[k], 0.0L);
  return sum;
}

// Depth first over "use allowed_[i], then skip its subtree" and "leave it". A path is a stack of indices; backing up means leaving the last
// one used.
void AntichainFinder::search_stages(std::span<const Serving> servings, std::uint32_t cpv, std::uint32_t without) {
  const std::uint32_t stages = problem_.stages;
  allowed_.clear();
  std::copy_if(servings.begin(), servings.end(), std::back_inserter(allowed_), [&](const Serving& s) { return s.candidate != without; });
  bound_suffixes();

  const std::vector<GainSum> nothing(stages, 0.0L);
  std::vector<GainSum> gained(stages, 0.0L);  // `stages` values per depth of the path, so that backing up restores exactly
  std::vector<std::size_t> path;
  GainSum least = missing(nothing.data(), nothing.data(), cpv);
  std::size_t i = 0;
  for (std::uint64_t step = 0; step < kMaxSearchSteps && least > 0.0L; ++step) {
    const GainSum* here = gained.data() + path.size() * stages;
    if (i < allowed_.size() && missing(here, suffix_.data() + i * stages, cpv) < least) {
      for (std::uint32_t k = 0; k < stages; ++k) {
        const GainSum before = gained[path.size() * stages + k];
        gained.push_back(before + gain(allowed_[i], k));
      }
      path.push_back(i);
      const std::uint32_t covered = last_rank(allowed_[i]);
      while (i < allowed_.size() && rank(allowed_[i]) <= covered) ++i;
      if (const GainSum now = missing(gained.data() + path.size() * stages, nothing.data(), cpv); now < least) {
        least = now;
        chosen_.clear();
        for (const std::size_t used : path) chosen_.push_back(allowed_[used]);
      }
    } else {
      if (path.empty()) break;
      i = path.back() + 1;
      path.pop_back();
      gained.resize((path.size() + 1) * stages);
    }
  }
}

Antichain AntichainFinder::evaluated(std::vector<Serving> chosen, std::uint32_t cpv) const {
  std::sort(chosen.begin(), chosen.end(), [](const Serving& a, const Serving& b) { return a.candidate < b.candidate; });
  GainSum violation = 0.0L;
  for (std::uint32_t k = 0; k < problem_.stages; ++k) {
    GainSum sum = 0.0L;
    for (const Serving& s : chosen) sum += gain(s, k);
    const GainSum deficit = problem_.deficit[static_cast<std::size_t>(cpv) * problem_.stages + k];
    if (sum < deficit) violation += deficit - sum;
  }
  return {std::move(chosen), static_cast<double>(violation)};
}

}  // namespace standin
