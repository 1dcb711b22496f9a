// Where the rims of recorded surfaces need no texels beyond them (shift_bound.h): against nothing.
//
// A gap shows where what lies around it is covered. Beyond a rim that has no surface on its outer side, from anywhere in the view cell, a
// pixel's disc (2 pixels) is not covered, so nothing can be missing there, and the texels drawn for rays that pass beside the surface would
// only fatten the silhouette. Two layers shift by at most a texel for each layer between them and the next, and a pixel is no more than
// kDiscTexels wide in all but distant views; so a surface that may come to lie beyond a rim has a texel on its outer side within so many
// texels and one for each layer apart. From farther away a disc spans more: what is left open there is a slit of a small part of a pixel.
#pragma once

#include <vector>

#include "render/impostor/layer_image.h"

namespace standin {

/// Removes texels whose order is at least `shift_only` and beyond which, on the side away from the nearest texel of lower order in their
/// layer, no layer holds anything near enough.
void remove_outer_rims(std::vector<LayerImage>& images, float shift_only);

}  // namespace standin
