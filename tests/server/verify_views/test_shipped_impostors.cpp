// What is read back from the GLB is what was written, texel for texel; a file that does not fit its placement is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "render/base/error.h"
#include "render/base/rng.h"
#include "render/impostor/atlas.h"
#include "render/impostor/impostor_glb.h"
#include "server/verify/shipped_impostors.h"

namespace standin {
namespace {

constexpr std::uint64_t kSeed = 20;

Vec3 random_point(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

ImpostorFrame random_frame(Rng& rng) {
  ImpostorFrame frame;
  frame.reference_viewpoint = random_point(rng, 1e5);
  frame.forward = glm::normalize(random_point(rng, 1.0));
  frame.right = glm::normalize(glm::cross(frame.forward, random_point(rng, 1.0)));
  frame.up = glm::cross(frame.right, frame.forward);
  frame.slope_step = {rng.uniform(5e-4, 5e-3), rng.uniform(5e-4, 5e-3)};
  frame.width = 64;
  frame.height = 48;
  frame.slope_min = {-32.0 * frame.slope_step.x + 0.1, 24.0 * frame.slope_step.y - 0.05};
  return frame;
}

Impostor random_impostor(Rng& rng) {
  Impostor impostor;
  impostor.objects = {static_cast<std::uint32_t>(rng.below(9))};
  impostor.view_cell = Box{random_point(rng, 1.0), Vec3(2.0)};
  impostor.frame = random_frame(rng);
  const auto layers = static_cast<std::uint32_t>(1 + rng.below(20));
  double distance_m = rng.uniform(1.0, 2000.0);
  for (std::uint32_t i = 0; i < layers; ++i, distance_m *= 1.004)
    impostor.layers.push_back({distance_m, 0.999 * distance_m, 1.001 * distance_m});
  for (std::uint32_t i = 0; i < 30; ++i) {
    Quad quad{static_cast<std::uint32_t>(rng.below(layers)), static_cast<std::uint32_t>(rng.below(40)),
              static_cast<std::uint32_t>(rng.below(30)), 0, 0};
    quad.width = 1 + static_cast<std::uint32_t>(rng.below(64 - quad.x));
    quad.height = 1 + static_cast<std::uint32_t>(rng.below(48 - quad.y));
    impostor.quads.push_back(quad);
    for (std::uint32_t texel = 0; texel < quad.width * quad.height; ++texel) {
      const bool opaque = rng.below(3) != 0;
      for (int c = 0; c < 3; ++c) impostor.texels.push_back(static_cast<std::uint8_t>(rng.below(256)));
      impostor.texels.push_back(opaque ? 255 : 0);
    }
  }
  return impostor;
}

Placement placement_of(const ImpostorSet& set) {
  Placement placement;
  for (const auto& impostor : set.impostors) {
    PlacementImpostor placed;
    placed.objects = impostor.objects;
    placed.view_cell = impostor.view_cell;
    placed.frame = impostor.frame;
    placed.layers = impostor.layers;
    placed.quads = static_cast<std::uint32_t>(impostor.quads.size());
    placement.impostors.push_back(placed);
  }
  return placement;
}

ImpostorSet random_set(std::uint64_t seed, std::uint32_t max_side) {
  std::vector<Impostor> impostors;
  for (std::uint64_t i = 0; i < 5; ++i) {
    Rng rng(seed, i);
    impostors.push_back(random_impostor(rng));
  }
  AtlasOptions options;
  options.max_side = max_side;
  return pack_atlas(std::move(impostors), options);
}

/// One line per quad: where it is, where its texels are and which ones they are (transparent ones may have gained a colour).
std::multiset<std::string> quads_as_text(const ImpostorSet& set, std::size_t id) {
  const Impostor& impostor = set.impostors[id];
  std::multiset<std::string> lines;
  std::size_t next = 0;
  for (std::size_t q = 0; q < impostor.quads.size(); ++q) {
    const Quad& quad = impostor.quads[q];
    const AtlasSlot& slot = set.slots[id][q];
    std::string line;
    for (const auto value : {quad.layer, quad.x, quad.y, quad.width, quad.height, slot.page, slot.x, slot.y})
      line += std::to_string(value) + " ";
    for (std::uint32_t i = 0; i < quad.width * quad.height; ++i, next += 4)
      for (std::size_t c = 0; c < 4; ++c)
        line += static_cast<char>(impostor.texels[next + 3] != 0 || c == 3 ? impostor.texels[next + c] : 0);
    lines.insert(line);
  }
  return lines;
}

void expect_broken(const std::string& glb, const Placement& placement, const std::string& what) {
  try {
    static_cast<void>(read_shipped_impostors(glb, placement));
    ADD_FAILURE() << "accepted: " << what;
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kFileBroken);
    EXPECT_THAT(failure.what(), testing::HasSubstr(what));
  }
}

TEST(ShippedImpostors, ComeBackTexelForTexel) {
  for (std::uint64_t seed = kSeed; seed < kSeed + 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const ImpostorSet written = random_set(seed, seed % 2 == 0 ? 4096 : 200);
    const ImpostorSet read = read_shipped_impostors(encode_impostor_glb(written), placement_of(written));
    ASSERT_EQ(read.impostors.size(), written.impostors.size());
    ASSERT_EQ(read.pages.size(), written.pages.size());
    EXPECT_TRUE(seed % 2 == 0 || read.pages.size() > 1);
    for (std::size_t page = 0; page < read.pages.size(); ++page) EXPECT_EQ(read.pages[page].rgba, written.pages[page].rgba);
    for (std::size_t id = 0; id < read.impostors.size(); ++id) EXPECT_EQ(quads_as_text(read, id), quads_as_text(written, id));
  }
}

TEST(ShippedImpostors, NoneAreNone) {
  EXPECT_TRUE(read_shipped_impostors(encode_impostor_glb({}), {}).impostors.empty());
}

TEST(ShippedImpostors, RefusesAnotherJobsFile) {
  const ImpostorSet set = random_set(kSeed, 4096);
  const std::string glb = encode_impostor_glb(set);
  const Placement good = placement_of(set);

  Placement wrong = good;
  wrong.impostors.push_back(good.impostors[0]);
  expect_broken(glb, wrong, "imp_5 is in the placement but not in the file");
  wrong = good;
  ++wrong.impostors[1].quads;
  expect_broken(glb, wrong, "imp_1 has 60 triangles");
  wrong = good;
  for (auto& layer : wrong.impostors[2].layers) layer.distance_m *= 1.0005;
  expect_broken(glb, wrong, "imp_2 has a corner");
  wrong = good;
  wrong.impostors[3].frame.slope_min.x += 0.3 * wrong.impostors[3].frame.slope_step.x;
  expect_broken(glb, wrong, "which is no texel's corner");
  wrong = good;
  wrong.impostors[4].frame.slope_step *= 0.5;
  expect_broken(glb, wrong, "imp_4 has a quad whose texels in the atlas are not those of its layer");
}

TEST(ShippedImpostors, RefusesATruncatedFile) {
  const ImpostorSet set = random_set(kSeed, 4096);
  const std::string glb = encode_impostor_glb(set);
  for (const std::size_t size : {std::size_t{0}, std::size_t{11}, std::size_t{40}, glb.size() / 2, glb.size() - 1})
    EXPECT_THROW(static_cast<void>(read_shipped_impostors(glb.substr(0, size), placement_of(set))), Failure) << size << " bytes";
}

}  // namespace
}  // namespace standin
