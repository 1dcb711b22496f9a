// A covering problem in a file, so that a scene is surveyed once and selected from many times. Only for the machine that wrote it.
#pragma once

#include <fstream>
#include <string>
#include <vector>

#include "placement/select/selection_problem.h"
#include "render/base/error.h"

namespace standin {

/// Calls visit(vector) for each of the problem's arrays.
template <class Problem, class Visit>
void for_each_array(Problem& problem, Visit&& visit) {
  visit(problem.parent);
  visit(problem.deficit);
  visit(problem.form);
  visit(problem.block_offset);
  visit(problem.cpv);
  visit(problem.worth);
  visit(problem.node);
  visit(problem.bytes);
  visit(problem.cost);
  visit(problem.run_offset);
  visit(problem.runs);
}

inline void write_selection_problem(const SelectionProblem& problem, const std::string& file) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(&problem.stages), sizeof(problem.stages));
  out.write(reinterpret_cast<const char*>(&problem.forms), sizeof(problem.forms));
  for_each_array(problem, [&](const auto& values) {
    const std::uint64_t count = values.size();
    out.write(reinterpret_cast<const char*>(&count), sizeof(count));
    out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(count * sizeof(values[0])));
  });
  if (!out.flush()) throw Failure(ErrorWord::kFileBroken, file + " cannot be written");
}

inline SelectionProblem read_selection_problem(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  SelectionProblem problem;
  in.read(reinterpret_cast<char*>(&problem.stages), sizeof(problem.stages));
  in.read(reinterpret_cast<char*>(&problem.forms), sizeof(problem.forms));
  for_each_array(problem, [&](auto& values) {
    std::uint64_t count = 0;
    in.read(reinterpret_cast<char*>(&count), sizeof(count));
    if (!in) throw Failure(ErrorWord::kFileBroken, file + " is not a covering problem");
    values.resize(count);
    in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(values[0])));
  });
  if (!in) throw Failure(ErrorWord::kFileBroken, file + " ends too early");
  return problem;
}

}  // namespace standin
