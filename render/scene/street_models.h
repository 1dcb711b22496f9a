// Trees, cars and street furniture from the catalogues of Sweet Home 3D (Debian: sweethome3d-furniture; the .sh3f files are zip archives).
//
// A catalogue's properties give each model's size in centimetres; its OBJ is in units of its own and cut into a mesh per drawn part. A
// model here is scaled to its size, stands on the ground at its foot, faces along z, and has one mesh per material: a draw call each.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "render/scene/scene.h"

namespace standin {

enum class StreetModelKind { kTree, kCar, kSmall };

struct StreetModelName {
  std::string_view path;  // as the catalogues write it
  StreetModelKind kind = StreetModelKind::kTree;
  double weight = 1.0;  // how often it is taken among its kind
};

/// What the real city takes of the catalogues: trees of Astana's climate (light ones more often), common cars, lamps and benches.
inline constexpr std::array kStreetModels{
    StreetModelName{"/scopia/cypress/cypress.obj", StreetModelKind::kTree, 5},
    StreetModelName{"/scopia/poplar/poplar.obj", StreetModelKind::kTree, 2},
    StreetModelName{"/scopia/pine/pine.obj", StreetModelKind::kTree, 1},
    StreetModelName{"/scopia/acacia/acacia.obj", StreetModelKind::kTree, 1},
    StreetModelName{"/scopia/sycamoreMaple/sycamoreMaple.obj", StreetModelKind::kTree, 1},
    StreetModelName{"/scopia/japaneseMaple/japaneseMaple.obj", StreetModelKind::kTree, 0.5},
    StreetModelName{"/scopia/bush/bush.obj", StreetModelKind::kTree, 1.5},
    StreetModelName{"/scopia/suv/suv.obj", StreetModelKind::kCar, 3},
    StreetModelName{"/scopia/renault-scenic/renault-scenic.obj", StreetModelKind::kCar, 3},
    StreetModelName{"/scopia/peugeot-308/peugeot-308.obj", StreetModelKind::kCar, 3},
    StreetModelName{"/scopia/smart-car/smart-car.obj", StreetModelKind::kCar, 2},
    StreetModelName{"/scopia/chevrolet/chevrolet.obj", StreetModelKind::kCar, 2},
    StreetModelName{"/scopia/van/van.obj", StreetModelKind::kCar, 2},
    StreetModelName{"/blendswap-cc-by/fordFocus/fordFocus.obj", StreetModelKind::kCar, 0.5},
    StreetModelName{"/scopia/candelabre/candelabre.obj", StreetModelKind::kSmall, 4},
    StreetModelName{"/katorlegaz/classic-lamppost/classic-lamppost.obj", StreetModelKind::kSmall, 3},
    StreetModelName{"/katorlegaz/painted-bench/painted-bench.obj", StreetModelKind::kSmall, 2},
    StreetModelName{"/scopia/littlebank/littlebank.obj", StreetModelKind::kSmall, 1},
};

struct StreetModel {
  StreetModelName name;
  std::uint64_t triangles = 0;
  Vec3 size_m{0.0};
  std::uint32_t first_part = 0;  // in the scene that it was added to
  std::uint32_t part_count = 0;
};

/// Adds the meshes, materials and textures of kStreetModels to `scene`. `folder` holds the unpacked catalogues, each with its
/// PluginFurnitureCatalog.properties, at any depth. Throws Failure(kFileMissing) naming the first model that no catalogue offers, and
/// what load_scene throws.
[[nodiscard]] std::vector<StreetModel> add_street_models(Scene& scene, const std::filesystem::path& folder);

}  // namespace standin
