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

/// Each row gets a block of its own; impostors cost nothing to draw, so that worth is gain.
inline SelectionProblem make_problem(std::vector<std::int32_t> parent, const std::vector<Row>& rows, std::vector<double> deficit,
                                     std::uint32_t stages = 1) {
  SelectionProblem problem;
  problem.stages = stages;
  problem.parent = std::move(parent);
  problem.deficit = std::move(deficit);
  problem.form.assign(problem.deficit.size() / stages, 0);
  for (const auto& row : rows) {
    problem.node.push_back(row.node);
    problem.bytes.push_back(row.bytes);
    for (const auto& [cpv, gains] : row.gain) {
      problem.cpv.push_back(cpv);
      problem.worth.insert(problem.worth.end(), gains.begin(), gains.end());
    }
    problem.cost.insert(problem.cost.end(), stages, 0.0);
    problem.runs.push_back({problem.block_count(), problem.block_count() + 1});
    problem.block_offset.push_back(static_cast<std::uint32_t>(problem.cpv.size()));
    problem.run_offset.push_back(problem.runs.size());
  }
  return problem;
}

/// What make_problem was given, or would have to be: every gain written out.
inline std::vector<Row> rows_of(const SelectionProblem& problem) {
  std::vector<Row> rows;
  for (std::uint32_t c = 0; c < problem.candidate_count(); ++c) {
    Row row{problem.node[c], problem.bytes[c], {}};
    problem.for_each_served(c, [&](std::uint32_t entry) {
      for (std::uint32_t k = 0; k < problem.stages; ++k) row.gain[problem.cpv[entry]].push_back(problem.gain(c, entry, k));
    });
    rows.push_back(row);
  }
  return rows;
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

/// CPVs in cells; each node's originals have a worth in some of them; candidates serve some of their node's cells.
struct FactoredShape {
  std::uint32_t nodes = 6;
  std::uint32_t candidates = 9;
  std::uint32_t cells = 3;
  std::uint32_t cpvs_per_cell = 2;
  std::uint32_t stages = 1;
  double demand = 10.0;  // deficits are 1 .. demand
};

inline SelectionProblem random_factored_problem(std::uint64_t seed, const FactoredShape& shape) {
  Rng rng(seed);
  SelectionProblem problem;
  problem.stages = shape.stages;
  problem.forms = 2;
  problem.parent.push_back(-1);
  for (std::uint32_t n = 1; n < shape.nodes; ++n) problem.parent.push_back(static_cast<std::int32_t>(rng.below(n)));
  for (std::uint32_t p = 0; p < shape.cells * shape.cpvs_per_cell; ++p) {
    problem.form.push_back(static_cast<std::uint8_t>(rng.below(2)));
    for (std::uint32_t k = 0; k < shape.stages; ++k) problem.deficit.push_back(rng.uniform(1.0, shape.demand));
  }
  for (std::uint32_t n = 0; n < shape.nodes; ++n) {  // block n * cells + cell
    for (std::uint32_t cell = 0; cell < shape.cells; ++cell) {
      for (std::uint32_t i = 0; i < shape.cpvs_per_cell; ++i) {
        if (rng.uniform() < 0.3) continue;
        problem.cpv.push_back(cell * shape.cpvs_per_cell + i);
        for (std::uint32_t k = 0; k < shape.stages; ++k) problem.worth.push_back(rng.uniform(0.0, 8.0));
      }
      problem.block_offset.push_back(static_cast<std::uint32_t>(problem.cpv.size()));
    }
  }
  for (std::uint32_t c = 0; c < shape.candidates; ++c) {
    problem.node.push_back(static_cast<std::uint32_t>(rng.below(shape.nodes)));
    problem.bytes.push_back(rng.uniform(1.0, 9.0));
    for (std::uint32_t i = 0; i < problem.forms * shape.stages; ++i) problem.cost.push_back(rng.uniform(0.0, 3.0));
    for (std::uint32_t cell = 0; cell < shape.cells; ++cell) {
      const std::uint32_t block = problem.node.back() * shape.cells + cell;
      if (rng.uniform() < 0.4) continue;
      if (rng.uniform() < 0.5 && problem.runs.size() > problem.run_offset.back() && problem.runs.back().end == block)
        problem.runs.back().end = block + 1;
      else
        problem.runs.push_back({block, block + 1});
    }
    problem.run_offset.push_back(problem.runs.size());
  }
  return problem;
}

}  // namespace standin::test
