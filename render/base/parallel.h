// Independent tasks on several threads, with results that do not depend on how many.
//
// parallel_for runs task(0) .. task(count-1), each exactly once, in any order on any thread: a task writes only to slots of its own index.
// The first exception (by task index) is rethrown after all threads have stopped.
#pragma once

#include <cstddef>
#include <functional>

#include "render/base/work.h"

namespace standin {

/// `threads` >= 1; 1 runs in the calling thread, in order.
void parallel_for(std::size_t count, int threads, const WorkBudget& budget, const std::function<void(std::size_t)>& task);

}  // namespace standin
