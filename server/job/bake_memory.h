// Bakes of one world by what was asked for, so that a job at the next budget need not bake them again.
//
// The thesis places for one budget, and bakes at each greedy step (5.7.3). Neighbouring budgets choose many of the same impostors; a bake
// depends on the technique, the objects and the view cell alone, so what is recalled is what would have been baked, to the byte. Only what
// the last two jobs asked for is kept: budgets farther apart have little in common.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <tuple>
#include <vector>

#include "placement/candidates/candidates.h"
#include "render/impostor/impostor.h"

namespace standin {

/// Belongs to one scene, camera and bake quality. May be used from several threads.
class BakeMemory {
 public:
  /// The outer level: known or not. The inner one: the impostor, or nothing where there can be none.
  [[nodiscard]] std::optional<std::optional<Impostor>> recall(const Candidate& candidate);
  void keep(const Candidate& candidate, const std::optional<Impostor>& impostor);
  /// Forgets what was neither kept nor recalled since the last call.
  void begin_job();

  [[nodiscard]] std::uint64_t recalled() const { return recalled_; }
  [[nodiscard]] std::uint64_t kept() const { return kept_; }

 private:
  // Technique, objects, and the numbers of the view cell.
  using Request = std::tuple<Technique, std::vector<std::uint32_t>, std::vector<double>>;
  using Bakes = std::map<Request, std::shared_ptr<const std::optional<Impostor>>>;

  [[nodiscard]] static Request request_of(const Candidate& candidate);

  std::mutex mutex_;
  Bakes current_;
  Bakes previous_;
  std::uint64_t recalled_ = 0;
  std::uint64_t kept_ = 0;
};

}  // namespace standin
