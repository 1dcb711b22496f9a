// What of a mesh proves texels from anywhere (size_bound.h): its largest faces and its largest connected pieces.
#pragma once

#include "render/impostor/size_bound.h"

namespace standin {

[[nodiscard]] SizeBound::MeshShape shape_of(const Mesh& mesh);

}  // namespace standin
