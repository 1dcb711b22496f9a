#include "server/job/bake_memory.h"

#include <utility>

namespace standin {
namespace {

void append(std::vector<double>& numbers, const Vec3& value) {
  numbers.insert(numbers.end(), {value.x, value.y, value.z});
}

// A shaft has 15 numbers, a box 6: no two kinds have the same.
std::vector<double> numbers_of(const ViewCell& cell) {
  std::vector<double> numbers;
  if (const auto* shaft = std::get_if<Shaft>(&cell)) {
    for (const Vec3* value : {&shaft->apex, &shaft->axis, &shaft->right, &shaft->up}) append(numbers, *value);
    numbers.insert(numbers.end(), {shaft->tan_half.x, shaft->tan_half.y, shaft->min_distance_m});
  } else {
    const Box& box = std::get<Box>(cell);
    append(numbers, box.min);
    append(numbers, box.max);
  }
  return numbers;
}

}  // namespace

BakeMemory::Request BakeMemory::request_of(const Candidate& candidate) {
  return {candidate.technique, candidate.objects, numbers_of(candidate.view_cell)};
}

std::optional<std::optional<Impostor>> BakeMemory::recall(const Candidate& candidate) {
  const Request request = request_of(candidate);
  std::shared_ptr<const std::optional<Impostor>> known;
  {
    const std::scoped_lock lock(mutex_);
    auto found = current_.find(request);
    if (found == current_.end()) {
      const auto old = previous_.extract(request);
      if (old.empty()) return std::nullopt;
      found = current_.emplace(request, old.mapped()).first;
    }
    ++recalled_;
    known = found->second;
  }
  return *known;
}

void BakeMemory::keep(const Candidate& candidate, const std::optional<Impostor>& impostor) {
  auto copy = std::make_shared<const std::optional<Impostor>>(impostor);
  const std::scoped_lock lock(mutex_);
  ++kept_;
  current_.insert_or_assign(request_of(candidate), std::move(copy));
}

void BakeMemory::begin_job() {
  const std::scoped_lock lock(mutex_);
  previous_ = std::exchange(current_, {});
}

}  // namespace standin
