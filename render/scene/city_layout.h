// Where everything stands: a grid of blocks with closed perimeters (so that streets are canyons), a tenth of them parks, and slots along
// the kerbs for cars, trees and furniture.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/scene/city_parts.h"

namespace standin {

struct CityCounts {
  std::uint32_t columns = 1;
  std::uint32_t rows = 1;
  std::uint32_t buildings = 0;
  std::uint32_t trees = 0;
  std::uint32_t cars = 0;
  std::uint32_t furniture = 0;
  [[nodiscard]] std::uint32_t tiles() const { return columns * rows; }
};

/// The shares of 2,276 buildings, 450 trees, 420 cars and one ground tile per 25.4 of 5,287 objects; furniture makes the sum exact.
[[nodiscard]] CityCounts city_counts(std::uint32_t objects);

/// One object: model `model` of its kind.
struct Place {
  std::uint32_t model = 0;
  std::uint32_t colour = 0;
  Vec3 position{0.0};
  double yaw_rad = 0.0;
  Vec3 scale{1.0};
};

struct CityLayout {
  TileShape tile;
  std::vector<Place> tiles;  // model 0: paved yard, 1: lawn
  std::vector<Place> buildings;
  std::vector<Place> trees;
  std::vector<Place> cars;
  std::vector<Place> furniture;  // model: FurnitureKind
};

inline constexpr std::array<BuildingShape, 12> kBuildingShapes{{{12, 13, 4, true},
                                                                {12, 13, 5, false},
                                                                {15, 13, 4, false},
                                                                {15, 13, 6, true},
                                                                {18, 13, 5, true},
                                                                {18, 13, 6, false},
                                                                {21, 13, 4, true},
                                                                {21, 13, 6, false},
                                                                {24, 13, 5, false},
                                                                {27, 13, 5, true},
                                                                {30, 13, 6, false},
                                                                {36, 13, 5, false}}};
inline constexpr std::array<TreeShape, 6> kTreeShapes{{{8.5, 2.4}, {9.5, 2.8}, {10.5, 3.2}, {11.5, 3.4}, {12.5, 3.8}, {13.0, 4.2}}};
inline constexpr std::array<CarShape, 3> kCarShapes{
    {{4.5, 1.8, 1.45, 0.25, 0.85}, {3.7, 1.66, 1.5, 0.15, 0.8}, {5.1, 1.95, 2.2, 0.1, 0.97}}};

[[nodiscard]] CityLayout lay_out_city(const CityCounts& counts, std::uint64_t seed);

}  // namespace standin
