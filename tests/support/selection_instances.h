// Selection problems for tests: written out row by row, or random from a printed seed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "placement/select/selection_problem.h"
#include "render/base/rng.h"

namespace standin::test {

/// A candidate as a person would write it: node, bytes, and gains per CPV.
struct Row {
  std::uint32_t node = 0;
  double bytes = 1.0;
  std::map<std::uint32_t, std::vector<double>> gain;
};

inline SelectionProblem make_problem(std::vector<std::int32_t> parent, const std::vector<Row>& rows, std::vector<double> deficit,
                                     std::uint32_t stages = 1) {
  SelectionProblem problem;
  problem.stages = stages;
  problem.parent = std::move(parent);
  problem.deficit = std::move(deficit);
  problem.offset.push_back(0);
  for (const auto& row : rows) {
    problem.node.push_back(row.node);
    problem.bytes.push_back(row.bytes);
    for (const auto& [cpv, gains] : row.gain) {
      problem.cpv.push_back(cpv);
      problem.gain.insert(problem.gain.end(), gains.begin(), gains.end());
    }
    problem.offset.push_back(problem.cpv.size());
  }
  return problem;
}

struct RandomShape {
  std::uint32_t nodes = 7;
  std::uint32_t candidates = 8;
  std::uint32_t cpvs = 4;
  std::uint32_t stages = 1;
  bool ties = false;      // few distinct values, not dyadic (multiples of 0.1)
  bool integers = true;   // sums are exact
  double negative = 0.0;  // share of entries with one negative stage
  double demand = 12.0;   // deficits are 1 .. demand
};

inline double random_value(Rng& rng, const RandomShape& shape, double most) {
  if (shape.ties) return 0.1 * static_cast<double>(1 + rng.below(3));
  if (shape.integers) return static_cast<double>(rng.below(static_cast<std::uint64_t>(most) + 1));
  return rng.uniform(0.0, most);
}

inline SelectionProblem random_problem(std::uint64_t seed, const RandomShape& shape) {
  Rng rng(seed);
  std::vector<std::int32_t> parent{-1};
  for (std::uint32_t n = 1; n < shape.nodes; ++n) parent.push_back(static_cast<std::int32_t>(rng.below(n)));
  std::vector<Row> rows;
  for (std::uint32_t c = 0; c < shape.candidates; ++c) {
    Row row{static_cast<std::uint32_t>(rng.below(shape.nodes)), 1.0 + random_value(rng, shape, 8.0), {}};
    for (std::uint32_t p = 0; p < shape.cpvs; ++p) {
      if (rng.uniform() < 0.4) continue;
      std::vector<double> gain;
      for (std::uint32_t k = 0; k < shape.stages; ++k) gain.push_back(random_value(rng, shape, 8.0));
      if (rng.uniform() < shape.negative) gain[rng.below(shape.stages)] = -1.0 - static_cast<double>(rng.below(4));
      row.gain[p] = gain;
    }
    rows.push_back(row);
  }
  std::vector<double> deficit;
  for (std::uint32_t q = 0; q < shape.cpvs * shape.stages; ++q) deficit.push_back(1.0 + random_value(rng, shape, shape.demand - 1.0));
  if (shape.ties)
    for (auto& d : deficit) d -= 0.5;
  return make_problem(std::move(parent), rows, std::move(deficit), shape.stages);
}

}  // namespace standin::test
