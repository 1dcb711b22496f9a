// The city's models: buildings, trees, cars, street furniture and ground tiles, each built to a triangle budget.
//
// A model stands on y = 0, its front faces +z and x is to its right. All but trees come close to `triangles` from below (never above,
// except that each has a plainest form); a tree meets it exactly, up to one triangle, and so takes up what the others leave.
#pragma once

#include <cstdint>
#include <vector>

#include "render/scene/city_textures.h"
#include "render/scene/scene.h"

namespace standin {

struct ModelPart {
  Mesh mesh;
  Surface surface = Surface::kTrim;
};

struct Model {
  std::vector<ModelPart> parts;
  [[nodiscard]] std::uint64_t triangle_count() const {
    std::uint64_t sum = 0;
    for (const ModelPart& part : parts) sum += part.mesh.triangle_count();
    return sum;
  }
};

struct BuildingShape {
  double width_m = 18.0;
  double depth_m = 13.0;
  int floors = 5;
  bool gabled = false;  // else a mansard roof
};

inline constexpr double kFloorHeight_m = 3.3;
inline constexpr double kBayWidth_m = 3.0;
inline constexpr double kPavementHeight_m = 0.15;

[[nodiscard]] Model make_building(const BuildingShape& shape, std::uint64_t triangles);

struct TreeShape {
  double height_m = 10.0;
  double crown_radius_m = 3.0;
};

[[nodiscard]] Model make_tree(const TreeShape& shape, std::uint64_t triangles, std::uint64_t seed);

struct CarShape {
  double length_m = 4.5;
  double width_m = 1.8;
  double height_m = 1.45;
  double cabin_from = 0.25;  // share of the length where the cabin starts and ends
  double cabin_to = 0.85;
};

[[nodiscard]] Model make_car(const CarShape& shape, std::uint64_t triangles);

enum class FurnitureKind { kLamp, kBollard, kBench, kBin, kSign, kColumn };
inline constexpr int kFurnitureKinds = 6;

[[nodiscard]] Model make_furniture(FurnitureKind kind, std::uint64_t triangles);

/// One block with the halves of the streets around it, centred: carriageway, kerb, pavement and yard (paved, or a lawn).
struct TileShape {
  Vec2 pitch_m{93.75, 76.9};
  double street_width_m = 14.5;
  double pavement_m = 3.0;
  bool lawn = false;
};

[[nodiscard]] Model make_tile(const TileShape& shape, std::uint64_t triangles);

}  // namespace standin
