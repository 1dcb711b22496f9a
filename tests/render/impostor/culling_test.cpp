// Culling on random stacks of layers wider than a machine word, against the definition and against rays.
#include "render/impostor/culling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/base/rng.h"

namespace standin {
namespace {

using Stack = std::vector<BitImage>;

Stack random_stack(Rng& rng, std::uint32_t width, std::uint32_t height, int layers, double opaque) {
  Stack stack;
  for (int k = 0; k < layers; ++k) {
    BitImage& mask = stack.emplace_back(width, height);
    for (std::uint32_t y = 0; y < height; ++y)
      for (std::uint32_t x = 0; x < width; ++x)
        if (rng.uniform() < opaque) mask.set(x, y);
  }
  return stack;
}

Stack hidden(const Stack& stack, CullRule rule) {
  OcclusionCulling culling(stack[0].width(), stack[0].height(), rule);
  Stack result;
  for (const BitImage& layer : stack) result.push_back(culling.hidden_in_next(layer));
  return result;
}

bool solid(const BitImage& a, const BitImage& b, int x, int y) {
  if (x < 0 || y < 0 || x >= static_cast<int>(a.width()) || y >= static_cast<int>(a.height())) return false;
  const auto ux = static_cast<std::uint32_t>(x), uy = static_cast<std::uint32_t>(y);
  return a.test(ux, uy) || b.test(ux, uy);
}

/// Texel by texel, as math.md 3 states it.
Stack umbra_by_definition(const Stack& stack) {
  const std::uint32_t width = stack[0].width(), height = stack[0].height();
  Stack result;
  BitImage behind(width, height);
  for (const BitImage& layer : stack) {
    BitImage& visible_hidden = result.emplace_back(behind);
    visible_hidden &= layer;
    BitImage next(width, height);
    for (std::uint32_t y = 0; y < height; ++y)
      for (std::uint32_t x = 0; x < width; ++x) {
        bool all = true;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) all = all && solid(layer, behind, static_cast<int>(x) + dx, static_cast<int>(y) + dy);
        if (all) next.set(x, y);
      }
    behind = next;
  }
  return result;
}

TEST(CullingOfStacks, UmbraIsItsDefinition) {
  Rng rng(1);
  for (int i = 0; i < 10; ++i) {
    const Stack stack = random_stack(rng, 130 + static_cast<std::uint32_t>(i), 20, 5, 0.95);
    const Stack fast = hidden(stack, CullRule::kUmbra), slow = umbra_by_definition(stack);
    for (std::size_t k = 0; k < stack.size(); ++k) EXPECT_EQ(fast[k], slow[k]) << "stack " << i << " layer " << k;
  }
}

TEST(CullingOfStacks, CornersFindEverythingTheUmbraDoesAndMore) {
  Rng rng(2);
  int more = 0;
  for (int i = 0; i < 20; ++i) {
    const Stack stack = random_stack(rng, 70, 30, 5, 0.8);
    const Stack umbra = hidden(stack, CullRule::kUmbra), corner = hidden(stack, CullRule::kCorner);
    for (std::size_t k = 0; k < stack.size(); ++k) {
      BitImage missed = umbra[k];
      missed -= corner[k];
      EXPECT_FALSE(missed.any(0, 0, 70, 30));
      BitImage found = corner[k];
      found -= umbra[k];
      more += found.any(0, 0, 70, 30);
    }
  }
  EXPECT_GT(more, 0);
}

// A ray moves by at most one texel from layer to layer, always to the same side: it must never end on a culled texel unblocked.
TEST(CullingOfStacks, NoRayOfTheViewCellSeesACulledTexel) {
  Rng rng(3);
  int ended_on_culled = 0;
  for (int i = 0; i < 20; ++i) {
    const Stack stack = random_stack(rng, 24, 24, 6, 0.85);
    const Stack culled = hidden(stack, CullRule::kCorner);
    for (int ray = 0; ray < 4000; ++ray) {
      double x = rng.uniform(-2.0, 26.0), y = rng.uniform(-2.0, 26.0);
      const double sign_x = rng.uniform() < 0.5 ? -1.0 : 1.0, sign_y = rng.uniform() < 0.5 ? -1.0 : 1.0;
      for (std::size_t k = 0; k < stack.size(); ++k) {
        const int tx = static_cast<int>(std::floor(x)), ty = static_cast<int>(std::floor(y));
        if (solid(stack[k], stack[k], tx, ty)) {
          ended_on_culled += culled[k].test(static_cast<std::uint32_t>(tx), static_cast<std::uint32_t>(ty));
          break;
        }
        x += sign_x * rng.uniform();
        y += sign_y * rng.uniform();
      }
    }
  }
  EXPECT_EQ(ended_on_culled, 0);
}

TEST(CullingOfStacks, BordersOfTheTextureHideNothing) {
  Stack stack;
  for (int k = 0; k < 2; ++k) {
    BitImage& full = stack.emplace_back(66, 5);
    for (std::uint32_t y = 0; y < 5; ++y)
      for (std::uint32_t x = 0; x < 66; ++x) full.set(x, y);
  }
  const BitImage second = hidden(stack, CullRule::kCorner)[1];
  for (std::uint32_t y = 0; y < 5; ++y)
    for (std::uint32_t x = 0; x < 66; ++x) EXPECT_EQ(second.test(x, y), x > 0 && y > 0 && x < 65 && y < 4) << x << " " << y;
}

}  // namespace
}  // namespace standin
