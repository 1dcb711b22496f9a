#include "placement/select/fewest_shown.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "placement/select/antichain.h"

namespace standin {
namespace {

class FewestFinder {
 public:
  FewestFinder(const SelectionProblem& problem, const TreeOrder& order) : problem_(problem), order_(order) {}

  /// An antichain of at most `most` members that meets the CPV; nothing if there is none. `servings`: by (rank, candidate id).
  [[nodiscard]] std::optional<std::vector<Serving>> find(const std::vector<Serving>& servings, std::uint32_t cpv, std::size_t most) {
    tables_.clear();
    complete_.clear();
    for (std::size_t i = servings.size(); i > 0;) {
      const std::size_t end = i;
      const std::uint32_t rank = rank_of(servings[i - 1]);
      while (i > 0 && rank_of(servings[i - 1]) == rank) --i;
      add_node(servings, i, end, most);
    }
    std::uint32_t all = kNone;
    for (auto root = complete_.rbegin(); root != complete_.rend(); ++root) all = joined(all, *root, most);
    if (all == kNone) return std::nullopt;
    const auto& gains = tables_[all].gain;
    for (std::size_t count = 1; count < gains.size(); ++count)
      if (gains[count] >= static_cast<GainSum>(problem_.deficit[cpv])) return members(all, count, servings);
    return std::nullopt;
  }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;

  /// Greatest gains for 0, 1, .. members of a part of the tree, made of a node's own impostors, or of two parts beside each other.
  struct Table {
    std::vector<GainSum> gain;
    std::vector<std::uint32_t> of_left;  // members of the left part
    std::uint32_t left = kNone;          // tables
    std::uint32_t right = kNone;
    std::size_t own = 0;           // serving that one member may be instead
    bool own_beats_parts = false;  // it gains more than any one member of the parts
    std::uint32_t rank = 0;
  };

  [[nodiscard]] std::uint32_t rank_of(const Serving& s) const { return order_.first(problem_.node[s.candidate]); }
  [[nodiscard]] GainSum gain(const Serving& s) const { return problem_.gain(s.candidate, s.entry, 0); }

  void add_node(const std::vector<Serving>& servings, std::size_t begin, std::size_t end, std::size_t most) {
    std::size_t own = begin;
    for (std::size_t i = begin + 1; i < end; ++i)
      if (gain(servings[i]) > gain(servings[own])) own = i;
    std::uint32_t parts = kNone;
    const std::uint32_t last = order_.last(problem_.node[servings[own].candidate]);
    for (; !complete_.empty() && tables_[complete_.back()].rank <= last; complete_.pop_back())
      parts = joined(parts, complete_.back(), most);

    Table table;
    if (parts != kNone) table = {.gain = tables_[parts].gain, .of_left = std::vector<std::uint32_t>(tables_[parts].gain.size(), 0)};
    for (std::size_t k = 0; k < table.of_left.size(); ++k) table.of_left[k] = static_cast<std::uint32_t>(k);
    table.left = parts;
    if (table.gain.empty()) table.gain = {0.0L};
    if (table.gain.size() == 1) table.gain.push_back(-1.0L);
    table.own = own;
    table.own_beats_parts = gain(servings[own]) >= table.gain[1];
    table.gain[1] = std::max(table.gain[1], gain(servings[own]));
    table.rank = rank_of(servings[own]);
    tables_.push_back(std::move(table));
    complete_.push_back(static_cast<std::uint32_t>(tables_.size() - 1));
  }

  /// Two parts beside each other.
  std::uint32_t joined(std::uint32_t left, std::uint32_t right, std::size_t most) {
    if (left == kNone) return right;
    const auto &a = tables_[left].gain, &b = tables_[right].gain;
    const std::size_t size = std::min(most + 1, a.size() + b.size() - 1);
    Table table{.gain = std::vector<GainSum>(size, -1.0L), .of_left = std::vector<std::uint32_t>(size, 0), .left = left, .right = right};
    for (std::size_t i = 0; i < a.size(); ++i)
      for (std::size_t j = 0; j < b.size() && i + j < size; ++j)
        if (a[i] + b[j] > table.gain[i + j]) {
          table.gain[i + j] = a[i] + b[j];
          table.of_left[i + j] = static_cast<std::uint32_t>(i);
        }
    table.rank = std::min(tables_[left].rank, tables_[right].rank);
    tables_.push_back(std::move(table));
    return static_cast<std::uint32_t>(tables_.size() - 1);
  }

  [[nodiscard]] std::vector<Serving> members(std::uint32_t root, std::size_t count, const std::vector<Serving>& servings) const {
    std::vector<Serving> result;
    std::vector<std::pair<std::uint32_t, std::size_t>> open{{root, count}};
    while (!open.empty()) {
      const auto [at, wanted] = open.back();
      open.pop_back();
      if (at == kNone || wanted == 0) continue;
      const Table& table = tables_[at];
      if (wanted == 1 && table.own_beats_parts) {
        result.push_back(servings[table.own]);
        continue;
      }
      open.emplace_back(table.left, table.of_left[wanted]);
      open.emplace_back(table.right, wanted - table.of_left[wanted]);
    }
    std::ranges::sort(result, {}, &Serving::candidate);
    return result;
  }

  const SelectionProblem& problem_;
  const TreeOrder& order_;
  std::vector<Table> tables_;
  std::vector<std::uint32_t> complete_;  // tables of complete subtrees, the next by rank on top
};

bool meets(const SelectionProblem& problem, std::span<const Serving> members, std::uint32_t cpv) {
  for (std::uint32_t k = 0; k < problem.stages; ++k) {
    GainSum sum = 0.0L;
    for (const Serving& s : members) sum += problem.gain(s.candidate, s.entry, k);
    if (sum < static_cast<GainSum>(problem.deficit[static_cast<std::size_t>(cpv) * problem.stages + k])) return false;
  }
  return true;
}

double total_gain(const SelectionProblem& problem, const Serving& s) {
  double sum = 0.0;
  for (std::uint32_t k = 0; k < problem.stages; ++k) sum += problem.gain(s.candidate, s.entry, k);
  return sum;
}

std::vector<Serving> without_needless(const SelectionProblem& problem, std::vector<Serving> members, std::uint32_t cpv) {
  std::vector<Serving> by_gain = members;
  std::ranges::stable_sort(by_gain, [&](const Serving& a, const Serving& b) { return total_gain(problem, a) < total_gain(problem, b); });
  for (const Serving& needless : by_gain) {
    std::vector<Serving> fewer = members;
    std::erase(fewer, needless);
    if (meets(problem, fewer, cpv)) members = std::move(fewer);
  }
  return members;
}

/// Per CPV, what of the chosen set serves it, by (rank, candidate id).
std::vector<std::vector<Serving>> servings_of(const SelectionProblem& problem, const TreeOrder& order, std::vector<std::uint32_t> chosen) {
  std::ranges::stable_sort(chosen, {}, [&](std::uint32_t c) { return order.first(problem.node[c]); });
  std::vector<std::vector<Serving>> servings(problem.cpv_count());
  for (const std::uint32_t c : chosen) problem.for_each_served(c, [&](std::uint32_t e) { servings[problem.cpv[e]].push_back({c, e}); });
  return servings;
}

}  // namespace

ShownImpostors show_fewest(const SelectionProblem& problem, Selection& selection, const WorkBudget& budget) {
  const TreeOrder order(problem.parent);
  const auto servings = servings_of(problem, order, selection.chosen);
  FewestFinder finder(problem, order);
  ShownImpostors shown;
  for (std::uint32_t p = 0; p < problem.cpv_count(); ++p) {
    budget.check();
    std::vector<std::uint32_t>& assigned = selection.assigned[p];
    shown.before += assigned.size();
    std::vector<Serving> members;
    for (const Serving& s : servings[p])
      if (std::ranges::binary_search(assigned, s.candidate)) members.push_back(s);
    if (members.size() == assigned.size() && meets(problem, members, p)) {
      const auto fewest = problem.stages == 1 && !assigned.empty() ? finder.find(servings[p], p, assigned.size()) : std::nullopt;
      if (fewest && fewest->size() < members.size() && meets(problem, *fewest, p)) members = *fewest;
      members = without_needless(problem, std::move(members), p);
      assigned.clear();
      for (const Serving& s : members) assigned.push_back(s.candidate);
      std::ranges::sort(assigned);
    }
    shown.after += assigned.size();
  }
  return shown;
}

}  // namespace standin
