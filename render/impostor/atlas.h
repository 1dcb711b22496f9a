// Texture atlases (thesis 3.6): all quads of a job in as few and as full pages as possible.
//
// Pages need not be powers of two, but hold whole blocks of 4 x 4 texels, as compressed formats want them; each block of a quad has a
// gutter of one texel on every side that repeats its border, and colour is dilated into transparent texels, so that filtering at a border
// never sees black. Packing is deterministic.
#pragma once

#include "render/impostor/impostor.h"

namespace standin {

struct AtlasOptions {
  std::uint32_t max_side = 4096;
  std::uint32_t gutter = 1;
};

/// Takes the impostors as they are (moved in); quads keep their texel blocks in Impostor::texels too.
[[nodiscard]] ImpostorSet pack_atlas(std::vector<Impostor> impostors, const AtlasOptions& options = {});

/// Texels x 4 of the slots with their gutters: the objective (architecture.md, texture_bytes).
[[nodiscard]] std::uint64_t texture_bytes(const Impostor& impostor, const AtlasOptions& options = {});
/// Bytes of vertices and indices as the GLB holds them.
[[nodiscard]] std::uint64_t geometry_bytes(const Impostor& impostor);
/// Bytes of all pages minus the sum of texture_bytes.
[[nodiscard]] std::uint64_t padding_bytes(const ImpostorSet& set, const AtlasOptions& options = {});

}  // namespace standin
