// Packing: blocks apart, pages full, gutters and dilation as promised, the same bytes each time.
#include "render/impostor/atlas.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/base/error.h"
#include "render/base/rng.h"

namespace standin {
namespace {

/// An impostor of quads with random sizes; `opaque` of the texels carry a colour of their own.
Impostor random_impostor(Rng& rng, int quads, std::uint32_t max_side, double opaque = 0.7) {
  Impostor impostor;
  impostor.frame.width = impostor.frame.height = max_side;
  impostor.layers = {{1.0, 0.5, 2.0}};
  for (int i = 0; i < quads; ++i) {
    const auto side = [&] { return 1 + static_cast<std::uint32_t>(max_side * std::pow(rng.uniform(), 3.0) * 0.999); };
    const Quad quad{0, 0, 0, side(), side()};
    impostor.quads.push_back(quad);
    for (std::uint32_t k = 0; k < quad.width * quad.height; ++k) {
      const bool set = rng.uniform() < opaque || k == 0;
      for (int c = 0; c < 3; ++c) impostor.texels.push_back(set ? static_cast<std::uint8_t>(100 + rng.below(156)) : 0);
      impostor.texels.push_back(set ? 255 : 0);
    }
  }
  return impostor;
}

std::vector<Impostor> random_impostors(std::uint64_t seed, int count, int quads, std::uint32_t max_side) {
  Rng rng(seed);
  std::vector<Impostor> impostors;
  for (int i = 0; i < count; ++i) impostors.push_back(random_impostor(rng, quads, max_side));
  return impostors;
}

const std::uint8_t* texel(const Texture& page, std::uint32_t x, std::uint32_t y) {
  return page.rgba.data() + 4 * (std::size_t{y} * static_cast<std::size_t>(page.width) + x);
}

TEST(Atlas, BlocksWithGuttersDoNotOverlap) {
  const ImpostorSet set = pack_atlas(random_impostors(1, 10, 30, 60), {.max_side = 256});
  EXPECT_GT(set.pages.size(), 1U);
  std::vector<std::vector<char>> taken;
  for (const Texture& page : set.pages) {
    EXPECT_LE(std::max(page.width, page.height), 256);
    EXPECT_TRUE(page.width % 4 == 0 && page.height % 4 == 0) << "whole blocks of compressed formats";
    taken.emplace_back(page.rgba.size() / 4, 0);
  }
  for (std::size_t i = 0; i < set.impostors.size(); ++i)
    for (std::size_t q = 0; q < set.impostors[i].quads.size(); ++q) {
      const AtlasSlot& slot = set.slots[i][q];
      const Quad& quad = set.impostors[i].quads[q];
      const auto width = static_cast<std::uint32_t>(set.pages[slot.page].width),
                 height = static_cast<std::uint32_t>(set.pages[slot.page].height);
      ASSERT_TRUE(slot.x >= 1 && slot.y >= 1 && slot.x + quad.width + 1 <= width && slot.y + quad.height + 1 <= height);
      for (std::uint32_t y = slot.y - 1; y <= slot.y + quad.height; ++y)
        for (std::uint32_t x = slot.x - 1; x <= slot.x + quad.width; ++x) EXPECT_EQ(taken[slot.page][std::size_t{y} * width + x]++, 0);
    }
}

TEST(Atlas, TexelsAndTheirGuttersArriveUnchanged) {
  const ImpostorSet set = pack_atlas(random_impostors(2, 3, 20, 40));
  for (std::size_t i = 0; i < set.impostors.size(); ++i) {
    const std::uint8_t* next = set.impostors[i].texels.data();
    for (std::size_t q = 0; q < set.impostors[i].quads.size(); ++q) {
      const Quad& quad = set.impostors[i].quads[q];
      const AtlasSlot& slot = set.slots[i][q];
      const Texture& page = set.pages[slot.page];
      for (std::uint32_t y = 0; y < quad.height; ++y)
        for (std::uint32_t x = 0; x < quad.width; ++x, next += 4) {
          const std::uint8_t* there = texel(page, slot.x + x, slot.y + y);
          ASSERT_EQ(there[3], next[3]);
          if (next[3] != 0) {
            ASSERT_TRUE(std::equal(next, next + 3, there));
          }
        }
      for (std::uint32_t y = 0; y < quad.height; ++y) {
        EXPECT_EQ(texel(page, slot.x - 1, slot.y + y)[3], texel(page, slot.x, slot.y + y)[3]);
        EXPECT_EQ(texel(page, slot.x + quad.width, slot.y + y)[3], texel(page, slot.x + quad.width - 1, slot.y + y)[3]);
      }
    }
  }
}

TEST(Atlas, TransparentTexelsNearOpaqueOnesAreNotBlack) {
  Rng rng(3);
  Impostor impostor = random_impostor(rng, 8, 30, 0.2);
  const ImpostorSet set = pack_atlas({impostor});
  for (std::size_t q = 0; q < impostor.quads.size(); ++q) {
    const AtlasSlot& slot = set.slots[0][q];
    const Texture& page = set.pages[slot.page];
    for (std::uint32_t y = slot.y; y < slot.y + impostor.quads[q].height; ++y)
      for (std::uint32_t x = slot.x; x < slot.x + impostor.quads[q].width; ++x) {
        if (texel(page, x, y)[3] == 0) continue;
        for (const auto& [nx, ny] : {std::pair{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}}) EXPECT_GE(texel(page, nx, ny)[0], 100);
      }
  }
}

TEST(Atlas, WastesLittleOnManyTextures) {
  const ImpostorSet many = pack_atlas(random_impostors(4, 50, 40, 100));
  const double pages = static_cast<double>(padding_bytes(many));
  std::uint64_t blocks = 0;
  for (const Impostor& impostor : many.impostors) blocks += texture_bytes(impostor);
  std::printf("padding %.2f %% of %zu textures on %zu pages\n", 100.0 * pages / static_cast<double>(blocks), std::size_t{2000},
              many.pages.size());
  EXPECT_LT(pages, 0.08 * static_cast<double>(blocks));
}

TEST(Atlas, CountsItsBytes) {
  Impostor impostor;
  impostor.quads = {{0, 0, 0, 3, 5}, {0, 0, 0, 1, 1}};
  impostor.texels.assign(4 * 16, 255);
  impostor.layers = {{1.0, 0.5, 2.0}};
  EXPECT_EQ(texture_bytes(impostor), 4U * (5 * 7 + 3 * 3));
  EXPECT_EQ(geometry_bytes(impostor), 2U * (4 * 20 + 6 * 2));
  const ImpostorSet set = pack_atlas({impostor});
  ASSERT_EQ(set.pages.size(), 1U);
  EXPECT_EQ(padding_bytes(set), set.pages[0].rgba.size() - texture_bytes(impostor));
}

TEST(Atlas, IsTheSameEachTime) {
  const ImpostorSet a = pack_atlas(random_impostors(5, 5, 50, 80), {.max_side = 200}),
                    b = pack_atlas(random_impostors(5, 5, 50, 80), {.max_side = 200});
  ASSERT_EQ(a.pages.size(), b.pages.size());
  for (std::size_t i = 0; i < a.pages.size(); ++i) EXPECT_EQ(a.pages[i].rgba, b.pages[i].rgba);
}

TEST(Atlas, HasNoPageWithoutQuadsAndRefusesWhatFitsNone) {
  EXPECT_TRUE(pack_atlas({}).pages.empty());
  EXPECT_TRUE(pack_atlas({Impostor{}}).pages.empty());
  EXPECT_THROW((void)pack_atlas(random_impostors(6, 1, 200, 80), {.max_side = 40}), Failure);
}

}  // namespace
}  // namespace standin
