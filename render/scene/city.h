// A seeded, scalable city in the spirit of the thesis' Vienna (1.6): blocks of textured facades along streets, street furniture, heavy
// trees with alpha-masked leaves and cars, all instanced. The object count is exact and the drawn triangles are within 1 % of what was
// asked.
#pragma once

#include <cstdint>

#include "render/scene/scene.h"

namespace standin {

struct CityOptions {
  std::uint32_t objects = 5287;          // >= 16
  std::uint64_t triangles = 10'400'000;  // drawn, instances counted each; >= 200 per object
  std::uint64_t seed = 1;
};

[[nodiscard]] Scene make_city(const CityOptions& options);

}  // namespace standin
