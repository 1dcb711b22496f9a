// Counts what a lookup must not do: this binary's operator new, replaced.
#pragma once

#include <cstdint>

namespace standin::test {

[[nodiscard]] std::uint64_t allocation_count();

}  // namespace standin::test
