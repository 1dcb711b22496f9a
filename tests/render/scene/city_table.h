// The city's size and triangle distributions as Markdown: what tests/bench/city.md shows.
#pragma once

#include <string>

namespace standin::test {

[[nodiscard]] std::string city_tables();

}  // namespace standin::test
