#include "placement/select/ruin_and_recreate.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "placement/select/reverse_delete.h"
#include "render/base/rng.h"

namespace standin {
namespace {

constexpr std::uint64_t kMostRuined = 6;   // members of a trial
constexpr std::size_t kMostRegions = 400;  // CPVs of a trial: members that many CPVs use are left in peace
constexpr double kLeastNoise = 0.7;        // of a price in a trial
constexpr double kNoticeable = 1e-12;      // relative gain in bytes that counts

class Trial {
 public:
  Trial(const SelectionProblem& problem, const TreeOrder& order, const Columns& columns, Cover& cover, SelectionWork& work)
      : problem_(problem), order_(order), columns_(columns), cover_(cover), work_(work), score_(problem.candidate_count(), 0.0) {}

  /// Whether the cover has become cheaper; it is as before otherwise.
  bool run(std::uint32_t seed_member, Rng& rng) {
    changes_.clear();
    balance_ = 0.0;
    touched_.clear();
    if (!ruin(seed_member, rng)) return false;
    const double ruined = -balance_;
    noise_ = rng.next();
    if (recreate(ruined) && drop_redundant() < -kNoticeable * ruined) return true;
    undo();
    return false;
  }

 private:
  struct Change {
    enum class Kind { kAdded, kRemoved, kAssigned } kind = Kind::kAdded;
    std::uint32_t candidate = 0;
    std::vector<Assignment> previous;
  };

  /// Takes the member out, and some of those that are used where it is.
  bool ruin(std::uint32_t member, Rng& rng) {
    std::vector<std::uint32_t> near;
    const std::vector<std::uint32_t> regions = users(member);
    if (regions.empty() || regions.size() > kMostRegions) return false;
    for (const std::uint32_t p : regions)
      for (const Serving& used : cover_.antichain(p))
        if (used.candidate != member) near.push_back(used.candidate);
    std::ranges::sort(near);
    near.erase(std::unique(near.begin(), near.end()), near.end());
    short_.clear();
    take_out(member);
    for (std::uint64_t more = rng.below(kMostRuined); more > 0 && !near.empty(); --more) {
      const auto at = near.begin() + static_cast<std::ptrdiff_t>(rng.below(near.size()));
      if (users(*at).size() <= kMostRegions) take_out(*at);
      near.erase(at);
    }
    std::ranges::sort(short_);
    short_.erase(std::unique(short_.begin(), short_.end()), short_.end());
    std::erase_if(short_, [&](std::uint32_t p) { return missing(p) <= 0.0; });
    return true;
  }

  [[nodiscard]] std::vector<std::uint32_t> users(std::uint32_t member) const {
    std::vector<std::uint32_t> regions;
    problem_.for_each_listed(member, [&](std::uint32_t entry) {
      if (cover_.uses(problem_.cpv[entry], member)) regions.push_back(problem_.cpv[entry]);
    });
    return regions;
  }

  void take_out(std::uint32_t member) {
    std::vector<Assignment> others = cover_.best_without(member);
    for (const Assignment& other : others) short_.push_back(other.cpv);
    balance_ -= problem_.bytes[member];
    touched_.push_back(member);
    changes_.push_back({Change::Kind::kRemoved, member, cover_.remove(member, std::move(others))});
  }

  [[nodiscard]] double missing(std::uint32_t p) const {
    GainSum sum = 0.0L;
    for (const Serving& used : cover_.antichain(p)) sum += problem_.gain(used.candidate, used.entry, 0);
    return static_cast<double>(problem_.deficit[p] - sum);
  }

  /// What the candidate adds to the antichain in use: 0 below a member of it.
  [[nodiscard]] double net(const Serving& s) const {
    const std::uint32_t node = problem_.node[s.candidate];
    double gain = problem_.gain(s.candidate, s.entry, 0);
    for (const Serving& used : cover_.antichain(problem_.cpv[s.entry])) {
      const std::uint32_t other = problem_.node[used.candidate];
      if (other != node && order_.first(other) <= order_.first(node) && order_.first(node) <= order_.last(other)) return 0.0;
      if (order_.first(node) <= order_.first(other) && order_.first(other) <= order_.last(node))
        gain -= problem_.gain(used.candidate, used.entry, 0);
    }
    return gain;
  }

  [[nodiscard]] double price(std::uint32_t candidate) const {
    return problem_.bytes[candidate] * Rng(noise_, candidate).uniform(kLeastNoise, 1.0);
  }

  /// False when it stalls, or costs as much as what was taken out.
  bool recreate(double most_bytes) {
    double added = 0.0;
    while (!short_.empty()) {
      const std::uint32_t pick = best_addition();
      if (pick == kNoCandidate || (added += problem_.bytes[pick]) >= 2.0 * most_bytes) return false;
      cover_.add(pick);
      balance_ += problem_.bytes[pick];
      touched_.push_back(pick);
      changes_.push_back({Change::Kind::kAdded, pick, {}});
      reassign();
    }
    return true;
  }

  std::uint32_t best_addition() {
    scored_.clear();
    for (const std::uint32_t p : short_) {
      const double missing_ms = missing(p);
      columns_.read(p, servings_);
      work_.spend(servings_.size());
      for (const Serving& s : servings_) {
        if (cover_.contains(s.candidate)) continue;
        const double gain = std::min(net(s), missing_ms);
        if (gain <= 0.0) continue;
        if (score_[s.candidate] == 0.0) scored_.push_back(s.candidate);
        score_[s.candidate] += gain;
      }
    }
    std::uint32_t best = kNoCandidate;
    double most = 0.0;
    for (const std::uint32_t c : scored_) {
      const double score = score_[c] / price(c);
      if (score > most || (score == most && c < best)) std::tie(most, best) = std::pair(score, c);
      score_[c] = 0.0;
    }
    return best;
  }

  void reassign() {
    std::vector<Assignment> previous;
    for (const std::uint32_t p : short_) {
      previous.push_back({p, cover_.antichain(p)});
      cover_.assign(p, cover_.best(p).members);
    }
    changes_.push_back({Change::Kind::kAssigned, 0, std::move(previous)});
    std::erase_if(short_, [&](std::uint32_t p) { return missing(p) <= 0.0; });
  }

  /// Of what was added and what is used beside it; returns the balance in bytes.
  double drop_redundant() {
    std::vector<std::uint32_t> droppable;
    for (const std::uint32_t candidate : touched_)
      if (cover_.contains(candidate))
        for (const std::uint32_t p : users(candidate))
          for (const Serving& used : cover_.antichain(p)) droppable.push_back(used.candidate);
    std::ranges::sort(droppable);
    droppable.erase(std::unique(droppable.begin(), droppable.end()), droppable.end());
    for (const std::uint32_t candidate : touched_)
      if (cover_.contains(candidate) && users(candidate).empty()) droppable.push_back(candidate);
    std::ranges::sort(droppable, [&](std::uint32_t a, std::uint32_t b) {
      return problem_.bytes[a] != problem_.bytes[b] ? problem_.bytes[a] > problem_.bytes[b] : a < b;
    });
    for (const std::uint32_t member : droppable) {
      auto replacements = cover_.replacements(member);
      if (!replacements) continue;
      balance_ -= problem_.bytes[member];
      changes_.push_back({Change::Kind::kRemoved, member, cover_.remove(member, std::move(*replacements))});
    }
    return balance_;
  }

  void undo() {
    for (; !changes_.empty(); changes_.pop_back()) {
      Change& change = changes_.back();
      if (change.kind == Change::Kind::kAdded)
        cover_.remove(change.candidate, {});
      else if (change.kind == Change::Kind::kRemoved)
        cover_.put_back(change.candidate, std::move(change.previous));
      else
        for (auto& [cpv, antichain] : change.previous) cover_.assign(cpv, std::move(antichain));
    }
  }

  const SelectionProblem& problem_;
  const TreeOrder& order_;
  const Columns& columns_;
  Cover& cover_;
  SelectionWork& work_;
  std::vector<Change> changes_;
  double balance_ = 0.0;                // bytes now less bytes before
  std::vector<std::uint32_t> touched_;  // taken out or added
  std::vector<std::uint32_t> short_;    // CPVs that are not met, ascending
  std::vector<std::uint32_t> scored_;
  std::vector<double> score_;  // per candidate, 0 between picks
  std::vector<Serving> servings_;
  std::uint64_t noise_ = 0;
};

}  // namespace

std::uint64_t ruin_and_recreate(const SelectionProblem& problem, const TreeOrder& order, const Columns& columns, Cover& cover,
                                std::uint64_t trials, const WorkBudget& budget, SelectionWork& work) {
  if (problem.stages != 1) return trials;
  Trial trial(problem, order, columns, cover, work);
  std::vector<std::uint32_t> members = cover.members();
  for (std::uint64_t done = 0; done < trials && !members.empty(); ++done) {
    budget.check();
    if (work.exhausted()) return done;
    Rng rng(1, done);
    if (trial.run(members[rng.below(members.size())], rng)) members = cover.members();
  }
  return trials;
}

}  // namespace standin
