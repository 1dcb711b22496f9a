// Umbra and corner masks against the golden vectors.
#include "render/impostor/culling.h"
#include "tests/support/golden.h"

namespace standin {
namespace {

using nlohmann::json;

BitImage mask_of(const json& rows) {
  BitImage mask(static_cast<std::uint32_t>(rows.at(0).size()), static_cast<std::uint32_t>(rows.size()));
  for (std::uint32_t y = 0; y < mask.height(); ++y)
    for (std::uint32_t x = 0; x < mask.width(); ++x)
      if (rows.at(y).at(x).get<int>() != 0) mask.set(x, y);
  return mask;
}

void expect_masks(const json& layers, const json& expected, CullRule rule) {
  const BitImage first = mask_of(layers.at(0));
  OcclusionCulling culling(first.width(), first.height(), rule);
  for (std::size_t k = 0; k < layers.size(); ++k)
    EXPECT_EQ(culling.hidden_in_next(mask_of(layers.at(k))), mask_of(expected.at(k))) << "layer " << k;
}

TEST(Culling, MasksAgreeWithTheVectors) {
  for (const json& c : test::golden_cases("occlusion_masks.json")) {
    expect_masks(c.at("in"), c.at("umbra"), CullRule::kUmbra);
    expect_masks(c.at("in"), c.at("corner4"), CullRule::kCorner);
  }
}

}  // namespace
}  // namespace standin
