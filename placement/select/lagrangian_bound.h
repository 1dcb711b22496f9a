// A lower bound on the bytes of any solution, by splitting them (math.md 5.5, taken further).
//
// Let every covering constraint q = (CPV, stage) pay a part w_iq >= 0 of candidate i's bytes. If the parts of each candidate add up to no
// more than its bytes m_i, then
//     sum over q of  (cheapest antichain that meets q alone, at prices w_q)  <=  bytes of any feasible set:
// the set's bytes cover all the parts, and at each q it contains an antichain. Constraints that are left out pay nothing, and the rest
// still gives a bound (tight_constraints.h says which are looked at). This is Lagrangian decomposition (Guignard and Kim 1987): it knows
// that impostors of one cluster do not add up at a CPV, which the sum over all candidates of 5.5 forgets; in cities that alone is a factor
// of ten. ANY split gives a bound, so the search needs no proof of its own:
//   - a sweep visits one q after the other, gives it its share of the bytes that nobody has claimed yet, and takes back what its optimum
//     does not need (priced_column.h): no sweep lowers the bound. It ends in a split that no single q can improve, below the best;
//   - between sweeps, a subgradient step moves bytes towards the q whose fractional optimum uses the candidate; it goes by the mean of the
//     optima so far, of which the latest count most (as in the volume algorithm, Barahona and Anbil 2000).
// A split is kept as a bid t_q for each q and a potential pi for each entry: w_iq = max(0, t_q a_iq - pi), so that memory does not grow
// with the number of gains. At the end each q's antichain is asked for without fractions, which raises the bound once more.
#pragma once

#include <span>
#include <vector>

#include "placement/select/priced_column.h"
#include "placement/select/selection_work.h"
#include "placement/select/serving.h"
#include "placement/select/tight_constraints.h"
#include "render/base/work.h"

namespace standin {

class BytesSplit {
 public:
  /// Of no constraint yet.
  BytesSplit(const SelectionProblem& problem, const TreeOrder& order, const Columns& columns);

  /// Constraints that are to pay, too, from the first on until all together have `most_gains`. Those that are there already, or ask for
  /// nothing, change nothing. The best split so far stays one: it has no bid for the new ones.
  void add(std::span<const std::uint32_t> constraints, std::uint64_t most_gains, const WorkBudget& budget);

  /// One sweep, forwards and backwards in turn; returns the bound that the split now gives, without its rounding error.
  double sweep(const WorkBudget& budget);
  /// A subgradient step of the given length factor towards `aim_bytes`, then a sweep.
  double step(double factor, double aim_bytes, const WorkBudget& budget);

  /// Of the best sweep so far.
  [[nodiscard]] double best_value() const { return best_value_; }
  void return_to_best();

  /// Bytes of the candidate that no constraint pays: its reduced cost.
  [[nodiscard]] double unclaimed_bytes(std::uint32_t candidate) const { return free_[candidate]; }
  /// Proven bound of the split, less all rounding errors, with whole antichains.
  [[nodiscard]] double certified(const WorkBudget& budget);

  [[nodiscard]] std::uint64_t gains() const { return gains_; }
  /// Gains looked at so far: the unit of work.
  [[nodiscard]] std::uint64_t work() const { return work_ + column_.looked_at(); }

 private:
  struct Use {
    std::uint32_t candidate = 0;
    float share = 0.0F;
  };

  void load(std::uint32_t q);
  [[nodiscard]] double payment(const PricedColumn::Group& group, std::uint32_t position) const;
  template <class Visit>
  void for_each_payment(Visit&& visit) const;
  double visit(std::uint32_t q);
  void keep_optimum(std::uint32_t q);
  void shift_payments(double factor, double aim_bytes, const WorkBudget& budget);
  void keep_as_best();
  [[nodiscard]] double shifted(std::uint32_t candidate, double payment) const;

  const SelectionProblem& problem_;
  const Columns& columns_;
  PricedColumn column_;
  std::vector<Serving> servings_;
  std::vector<std::uint32_t> active_;     // constraints q
  std::vector<double> bid_;               // per q
  std::vector<double> potential_;         // per entry * K
  std::vector<double> free_;              // per candidate: bytes that nobody pays
  std::vector<std::uint32_t> demands_;    // per candidate: constraints that it helps
  std::vector<std::uint32_t> remaining_;  // of these, not visited yet in this sweep
  std::vector<std::vector<Use>> use_;     // per q: its fractional optima, averaged
  std::uint32_t q_ = 0;                   // the constraint at hand
  // Of the step that the sweep applies as it goes; a length of 0: none.
  double length_ = 0.0;
  std::vector<double> mean_use_;  // per candidate
  std::vector<double> shrink_;    // per candidate: so that its payments stay within its bytes
  std::vector<float> used_;       // per candidate: its share in use_[q_]
  double value_ = 0.0;            // of the latest sweep
  double best_value_ = 0.0;
  std::vector<double> best_bid_, best_potential_, best_free_;
  bool forwards_ = true;
  std::uint64_t gains_ = 0;
  std::uint64_t work_ = 0;
};

/// Sweeps and steps on the best split; `aim_bytes`: of a known solution (it scales the steps). Fewer than `iterations` are made on
/// very large problems, and where the latest ones gained next to nothing of these bytes. Returns false when the work limit ended it.
bool improve(BytesSplit& split, double aim_bytes, int iterations, const WorkBudget& budget, SelectionWork& work);

/// Lets the tightest constraints of a known solution of `known_bytes` pay, then twice as many, and so on, as long as that gains anything
/// and is affordable: the best split of few constraints is found soon, and the search goes on from there. `iterations`: of improve(), each
/// time constraints are added. Returns false when the work limit ended it.
bool improve_by(const TightConstraints& tight, BytesSplit& split, double known_bytes, int iterations, const WorkBudget& budget,
                SelectionWork& work);

}  // namespace standin
