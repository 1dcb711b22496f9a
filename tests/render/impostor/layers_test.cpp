// Layer sets of random and extreme set-ups: the O(1) estimate, the ranges' order, and the guarantees checked by true projections.
#include "render/impostor/layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/base/error.h"
#include "render/base/rng.h"

namespace standin {
namespace {

double log_uniform(Rng& rng, double low, double high) {
  return low * std::pow(high / low, rng.uniform());
}

LayerSetup random_setup(Rng& rng) {
  LayerSetup setup;
  setup.kind = rng.uniform() < 0.5 ? LayerSetup::Kind::kBox : LayerSetup::Kind::kShaft;
  setup.near_border = {log_uniform(rng, 0.3, 30.0), log_uniform(rng, 0.3, 30.0)};
  setup.cell_depth = log_uniform(rng, 0.3, 60.0);
  setup.tan_half = {log_uniform(rng, 0.01, 1.0), log_uniform(rng, 0.01, 1.0)};
  setup.s = rng.uniform() < 0.3 ? 0.0 : rng.uniform() * setup.cell_depth;
  setup.object_width = {log_uniform(rng, 1.0, 40.0), log_uniform(rng, 1.0, 40.0)};
  setup.t0 = log_uniform(rng, 5.0, 200.0);
  setup.depth = log_uniform(rng, 0.5, 60.0);
  setup.resolution = Vec2(std::floor(log_uniform(rng, 2.0, 500.0)), std::floor(log_uniform(rng, 2.0, 500.0)));
  setup.alpha_rad = log_uniform(rng, 3e-4, 2e-2);
  return setup;
}

std::string describe(const LayerSetup& setup) {
  return "s " + std::to_string(setup.s) + " m " + std::to_string(setup.cell_depth) + " t0 " + std::to_string(setup.t0) + " depth " +
         std::to_string(setup.depth) + " n " + std::to_string(setup.near_border.x) + " " + std::to_string(setup.near_border.y) + " res " +
         std::to_string(setup.resolution.x) + " alpha " + std::to_string(setup.alpha_rad);
}

TEST(LayerSets, RangesAdjoinAndHoldTheirLayers) {
  Rng rng(1);
  for (int i = 0; i < 300; ++i) {
    const LayerSetup setup = random_setup(rng);
    SCOPED_TRACE(describe(setup));
    const auto layers = layer_distances(setup, 20000);
    if (!layers) continue;
    EXPECT_EQ(layers->front().near, setup.t0);
    EXPECT_EQ(layers->back().far, setup.t0 + setup.depth);
    for (std::size_t k = 0; k < layers->size(); ++k) {
      const LayerDistance& layer = (*layers)[k];
      EXPECT_LE(layer.near, layer.t);
      EXPECT_LE(layer.t, layer.far);
      if (k > 0) {
        EXPECT_EQ(layer.near, (*layers)[k - 1].far);
      }
    }
  }
}

TEST(LayerSets, TheEstimateIsNearTheTruth) {
  Rng rng(2);
  int compared = 0;
  for (int i = 0; i < 1000; ++i) {
    LayerSetup setup = random_setup(rng);
    setup.strict = rng.uniform() < 0.7;
    const auto layers = layer_distances(setup, 20000);
    if (!layers) continue;
    const auto count = static_cast<double>(layers->size());
    const double estimate = estimated_layer_count(setup);
    EXPECT_NEAR(estimate, count, 2.0 + 0.03 * count) << describe(setup);
    EXPECT_EQ(estimate == 1.0, count == 1.0) << describe(setup);
    ++compared;
  }
  EXPECT_GT(compared, 800);
}

/// Where a viewpoint sees a point of slope u at depth a: the lateral position on the layer at depth `layer`, and the view's angle.
struct Viewpoint {
  Vec2 lateral{0.0};
  double height = 0.0;  // y of the frame; the near border is at s
};

Viewpoint random_viewpoint(Rng& rng, const LayerSetup& setup) {
  const auto side = [&] { return std::clamp(rng.uniform(-1.5, 1.5), -1.0, 1.0); };
  Viewpoint view;
  Vec2 half = 0.5 * setup.near_border;
  const double behind = std::clamp(rng.uniform(-0.5, 1.5), 0.0, 1.0);
  if (setup.kind == LayerSetup::Kind::kBox) {
    view.height = setup.s - behind * setup.cell_depth;
  } else {
    const double back = behind * log_uniform(rng, 0.1, 30.0) * setup.t0;
    view.height = setup.s - back;
    half += back * setup.tan_half;
  }
  view.lateral.x = side() * half.x;
  view.lateral.y = side() * half.y;
  return view;
}

/// A slope of the object's frustum; only a part of the symmetric range that W stands for, as for an object beside the axis.
Vec2 random_slope(Rng& rng, const LayerSetup& setup) {
  const Vec2 w = setup.object_width / (2.0 * (setup.t0 + setup.s));
  const double x = rng.uniform(0.2, 1.0), y = std::clamp(rng.uniform(-1.3, 1.3), -1.0, 1.0);
  return {(x > 0.9 ? 1.0 : x) * w.x, y * w.y};
}

// A point recorded at slope u on one layer must be seen, from anywhere in the cell, within one texel of slope u on the next layer.
TEST(LayerSets, NoPointMovesByMoreThanOneTexel) {
  Rng rng(3);
  double worst = 0.0;
  for (int i = 0; i < 200; ++i) {
    const LayerSetup setup = random_setup(rng);
    const auto layers = layer_distances(setup, 3000);
    if (!layers || layers->size() < 2) continue;
    const Vec2 texel = setup.object_width / ((setup.t0 + setup.s) * setup.resolution);
    for (int k = 0; k < 200; ++k) {
      const std::size_t layer = rng.below(layers->size() - 1);
      const Viewpoint view = random_viewpoint(rng, setup);
      const Vec2 slope = random_slope(rng, setup);
      const double a = (*layers)[layer].t + setup.s, next = (*layers)[layer + 1].t + setup.s;
      const Vec2 seen = view.lateral + (a * slope - view.lateral) * ((next - view.height) / (a - view.height));
      const Vec2 moved = glm::abs(seen / next - slope) / texel;
      worst = std::max({worst, moved.x, moved.y});
      ASSERT_LE(std::max(moved.x, moved.y), 1.0 + 1e-9) << describe(setup) << " layer " << layer;
    }
  }
  EXPECT_GT(worst, 0.95);  // the bound is met, not missed by far
}

// A point anywhere in a layer's range, shown on the layer along its ray from P, is off by at most alpha from anywhere in the cell.
double worst_parallax(const LayerSetup& setup, const std::vector<LayerDistance>& layers, Rng& rng) {
  double worst = 0.0;
  for (int k = 0; k < 400; ++k) {
    const LayerDistance& layer = layers[rng.below(layers.size())];
    const Viewpoint view = random_viewpoint(rng, setup);
    const Vec2 slope = random_slope(rng, setup);
    const double depth = rng.uniform() < 0.5 ? layer.near : layer.far;
    const auto seen = [&](double t) {
      const double a = t + setup.s;
      return Vec3(a * slope - view.lateral, a - view.height);
    };
    const Vec3 truth = seen(depth), image = seen(layer.t);
    worst = std::max(worst, std::atan2(glm::length(glm::cross(truth, image)), glm::dot(truth, image)) / setup.alpha_rad);
  }
  return worst;
}

TEST(LayerSets, ParallaxStaysBelowItsLimit) {
  Rng rng(4);
  double worst = 0.0, worst_thesis = 0.0;
  for (int i = 0; i < 300; ++i) {
    LayerSetup setup = random_setup(rng);
    const auto strict = layer_distances(setup, 3000);
    setup.strict = false;
    const auto thesis = layer_distances(setup, 3000);
    if (!strict || !thesis) continue;
    const double parallax = worst_parallax(setup, *strict, rng);
    ASSERT_LE(parallax, 1.0 + 1e-9) << describe(setup);
    worst = std::max(worst, parallax);
    worst_thesis = std::max(worst_thesis, worst_parallax(setup, *thesis, rng));
  }
  EXPECT_GT(worst, 0.95);
  EXPECT_GT(worst_thesis, 1.2);  // F1: what the strict form repairs
}

TEST(LayerSets, ExtremesAreDecidedWithoutNumbersRunningAway) {
  LayerSetup point;  // a cell without extent sees no parallax
  point.object_width = Vec2(10.0);
  point.t0 = 10.0;
  point.depth = 1e7;
  point.resolution = Vec2(512.0);
  point.alpha_rad = 1e-3;
  point.kind = LayerSetup::Kind::kBox;
  ASSERT_TRUE(layer_distances(point, 1).has_value());
  point.depth = std::numeric_limits<double>::infinity();
  ASSERT_TRUE(layer_distances(point, 1).has_value());

  LayerSetup wide = point;  // an opening of nearly 180 degrees: far too many layers, found at once
  wide.kind = LayerSetup::Kind::kShaft;
  wide.depth = 10.0;
  wide.tan_half = Vec2(1e12);
  EXPECT_FALSE(layer_distances(wide, 200).has_value());
  EXPECT_GT(estimated_layer_count(wide), 1e6);
  wide.tan_half = Vec2(0.0);  // and of zero
  EXPECT_TRUE(layer_distances(wide, 200).has_value());

  LayerSetup far_away = point;  // to infinity from a cell with extent: t/t0 runs up to the distance from which one layer is enough
  far_away.near_border = Vec2(1.0);
  const auto layers = layer_distances(far_away, 100000);
  ASSERT_TRUE(layers.has_value());
  EXPECT_TRUE(std::isinf(layers->back().far));
  EXPECT_TRUE(std::isfinite(layers->back().t));
  EXPECT_NEAR(estimated_layer_count(far_away), static_cast<double>(layers->size()), 2.0 + 0.03 * static_cast<double>(layers->size()));
}

TEST(LayerSets, ScaleDoesNotMatter) {
  Rng rng(5);
  for (int i = 0; i < 20; ++i) {
    const LayerSetup setup = random_setup(rng);
    const auto layers = layer_distances(setup, 2000);
    for (const double scale : {1e-9, 1e9}) {
      LayerSetup scaled = setup;
      scaled.near_border *= scale;
      scaled.s *= scale;
      scaled.cell_depth *= scale;
      scaled.object_width *= scale;
      scaled.t0 *= scale;
      scaled.depth *= scale;
      const auto again = layer_distances(scaled, 2000);
      ASSERT_EQ(layers.has_value(), again.has_value()) << describe(setup);
      if (!layers) continue;
      ASSERT_EQ(layers->size(), again->size()) << describe(setup);
      EXPECT_NEAR(again->back().t / (scale * layers->back().t), 1.0, 1e-10);
    }
  }
}

TEST(LayerSets, WhatIsOutOfRangeIsRefused) {
  LayerSetup good;
  good.t0 = 10.0;
  good.depth = 1.0;
  good.object_width = Vec2(1.0);
  good.resolution = Vec2(16.0);
  good.alpha_rad = 1e-3;
  EXPECT_NO_THROW((void)layer_distances(good, 10));
  const auto refused = [&](auto change) {
    LayerSetup bad = good;
    change(bad);
    try {
      (void)layer_distances(bad, 10);
    } catch (const Failure& failure) {
      return failure.word() == ErrorWord::kImpostorImpossible;
    }
    return false;
  };
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused([](LayerSetup& s) { s.t0 = 0.0; }));
  EXPECT_TRUE(refused([](LayerSetup& s) { s.t0 = -1.0; }));
  EXPECT_TRUE(refused([&](LayerSetup& s) { s.t0 = nan; }));
  EXPECT_TRUE(refused([&](LayerSetup& s) { s.depth = infinity; }));  // a shaft never ends in one layer
  EXPECT_TRUE(refused([](LayerSetup& s) { s.alpha_rad = 0.0; }));
  EXPECT_TRUE(refused([](LayerSetup& s) { s.resolution.x = 0.5; }));
  EXPECT_TRUE(refused([&](LayerSetup& s) { s.tan_half.y = infinity; }));
  EXPECT_FALSE(layer_distances(good, 0).has_value());
}

}  // namespace
}  // namespace standin
