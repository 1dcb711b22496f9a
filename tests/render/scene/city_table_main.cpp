// Prints tests/bench/city.md.

#include <cstdio>

#include "tests/render/scene/city_table.h"

int main() {
  std::fputs(standin::test::city_tables().c_str(), stdout);
  return 0;
}
