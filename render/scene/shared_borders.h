// Where meshes go on in others: an open edge that ends at a vertex of another mesh must stay as it is in every simpler form, or a crack
// opens between the two (not in the paper, which takes levels of detail as given).
//
// Vertices are compared in the world, part by part of all objects: pieces of one object, neighbours that were modelled apart (tiles of
// terrain, storeys of a house) and instances laid end to end all meet there, whatever their transforms.
#pragma once

#include <vector>

#include "render/base/work.h"
#include "render/scene/scene.h"

namespace standin {

/// Per mesh: whether an open edge of it ends, in some object, at a vertex of another object or of another part of the same.
[[nodiscard]] std::vector<bool> borders_shared(const Scene& scene, int threads, const WorkBudget& budget);

}  // namespace standin
