// The shipped impostors.glb read back as textured triangles, for checks that must not trust the code that wrote it.
//
// Kept is what decides where an impostor is opaque and what it shows: per node "imp_<id>" its triangles with texel coordinates, and the
// texels of every page. Layout in the file (one quad = two triangles, shared vertices or not) does not matter.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/geometry.h"

namespace standin {

struct GlbTriangle {
  std::array<Vec3, 3> offsets{};  // metres, world axes, from the node's origin
  std::array<Vec2, 3> texels{};   // coordinates in texels of the page, (0, 0) its upper left corner
  std::uint32_t page = 0;
};

struct GlbPage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  // as stored, rows from the top
  double alpha_cutoff = 0.5;       // of the material: texels are opaque from there on (alpha_sampling.h)
};

struct GlbImpostor {
  std::string node;
  Vec3 origin{0.0};  // world
  std::vector<GlbTriangle> triangles;
};

struct GlbQuads {
  std::vector<GlbPage> pages;  // by material
  std::vector<GlbImpostor> impostors;

  /// Throws Failure(kFileBroken) where the file has no such node.
  [[nodiscard]] const GlbImpostor& impostor(std::string_view node) const;
};

/// `bytes`: a whole GLB. Throws Failure(kFileBroken) where it is malformed or its materials are not alpha-masked.
[[nodiscard]] GlbQuads read_glb_quads(const std::string& bytes);

}  // namespace standin
