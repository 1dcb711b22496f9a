// The initial mesh against the golden vectors of the complete rule.
#include <set>

#include "render/impostor/depth_mesh.h"
#include "tests/support/golden.h"

namespace standin {
namespace {

using nlohmann::json;

/// Vectors are indexed [i][j]; i is our row.
BitImage mask_of(const json& rows) {
  BitImage mask(static_cast<std::uint32_t>(rows.at(0).size()), static_cast<std::uint32_t>(rows.size()));
  for (std::uint32_t y = 0; y < mask.height(); ++y)
    for (std::uint32_t x = 0; x < mask.width(); ++x)
      if (rows.at(y).at(x).get<int>() != 0) mask.set(x, y);
  return mask;
}

using Flat = std::array<int, 3>;  // layer, x, y of the cell
using Wall = std::array<int, 5>;  // layer, cell, side it faces

TEST(DepthMesh, InitialMeshAgreesWithTheVectors) {
  for (const json& c : test::golden_cases("tdm_mesh.json")) {
    std::vector<BitImage> opaque;
    for (const json& layer : c.at("in")) opaque.push_back(mask_of(layer));
    const DepthMesh mesh = initial_depth_mesh(unculled_lattice(opaque), Sheets::kAll);
    std::set<Flat> flats, expected_flats;
    std::set<Wall> walls, expected_walls;
    for (const DepthPolygon& p : mesh.polygons) {
      const LatticeVertex &v0 = mesh.vertices[p.corners[0]], &v1 = mesh.vertices[p.corners[1]], &v2 = mesh.vertices[p.corners[2]];
      if (v0.depth == v2.depth)
        EXPECT_TRUE(flats.insert({p.layer, p.cell_x, p.cell_y}).second);
      else  // the normal, up to a factor: (v1 - v0) x depth
        walls.insert({v2.depth % 2 == 0 ? p.layer : p.layer + 1, p.cell_x, p.cell_y, v1.y - v0.y, v0.x - v1.x});
    }
    const json& out = c.at("out").at("X");
    for (int k = 0; k < static_cast<int>(opaque.size()); ++k) {
      const json &flat = out.at("flat").at(static_cast<std::size_t>(k)), &wall = out.at("walls").at(static_cast<std::size_t>(k));
      for (int y = 0; y < static_cast<int>(flat.size()); ++y)
        for (int x = 0; x < static_cast<int>(flat.at(static_cast<std::size_t>(y)).size()); ++x)
          if (flat.at(static_cast<std::size_t>(y)).at(static_cast<std::size_t>(x)).get<int>() != 0) expected_flats.insert({k, x, y});
      for (const json& w : wall)
        expected_walls.insert({k, w.at(0).at(1).get<int>(), w.at(0).at(0).get<int>(), w.at(1).at(1).get<int>(), w.at(1).at(0).get<int>()});
    }
    EXPECT_EQ(flats, expected_flats);
    EXPECT_EQ(walls, expected_walls);
    EXPECT_EQ(mesh.flats, flats.size());
    EXPECT_EQ(mesh.walls, walls.size());
  }
}

}  // namespace
}  // namespace standin
