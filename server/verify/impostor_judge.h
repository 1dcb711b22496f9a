// Rays judge a sample of the shipped impostors (impostor_rays.h says what they judge).
//
// Impostors are taken evenly over the order of their layer counts, so that flat and deep ones are judged alike; of each, a few views all
// over its view cell.
#pragma once

#include "server/verify/glb_quads.h"
#include "server/verify/verify.h"

namespace standin {

/// Fills in judged_views (about options.judged_views, none where there is no impostor), gap_pixels, max_parallax_ratio, the baseless
/// pixels and the bloat, and says in left_out what rays could not judge. Independent of options.threads.
void judge_impostors(const VerifyInput& input, const GlbQuads& glb, const VerifyOptions& options, const WorkBudget& budget,
                     VerifyResult& result);

}  // namespace standin
