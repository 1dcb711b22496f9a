// Layer spacing, depth border, parallax range and whole layer sets against 60-digit golden vectors.
#include <cmath>

#include "render/impostor/layers.h"
#include "tests/support/golden.h"

namespace standin {
namespace {

using nlohmann::json;
using test::golden_cases;
using test::golden_number;

/// Equal within `relative`, or both infinite. Next to the pole (condition above 1e12) any huge value will do.
void expect_close(double actual, double expected, double relative, double condition, double scale, const char* what) {
  if (condition > 1e12) {
    EXPECT_TRUE(std::isinf(actual) || actual > 1e9 * scale) << what << " = " << actual;
  } else if (std::isinf(expected)) {
    EXPECT_TRUE(std::isinf(actual)) << what << " = " << actual;
  } else {
    EXPECT_NEAR(actual, expected, relative * std::max(1.0, condition) * std::abs(expected)) << what;
  }
}

TEST(Layers, SpacingAgreesWithTheVectors) {
  for (const json& c : golden_cases("layer_spacing.json")) {
    SCOPED_TRACE(c.at("in").dump());
    const auto in = [&](const char* key) { return golden_number(c.at("in").at(key)); };
    const auto out = [&](const char* key) { return golden_number(c.at("out").at(key)); };
    const double t = in("t"), s = in("s"), n = in("n");
    const double w = in("w") / (2.0 * (in("t0") + s)), tau = 2.0 * w / in("res");
    expect_close(spacing_near(t, s, w, tau, n, false), out("c_near_thesis"), 1e-14, golden_number(c.at("cond_near")), t, "thesis");
    expect_close(spacing_near(t, s, w, tau, n, true), out("c_near_strict"), 1e-14, golden_number(c.at("cond_near")), t, "strict");
    expect_close(spacing_far(t, s, w, tau, n, in("m")), out("c_far_box"), 1e-14, golden_number(c.at("cond_far")), t, "far");
    expect_close(spacing_shaft(t, s, w, tau, in("tan_half_beta")), out("c_shaft"), 1e-14, golden_number(c.at("cond_shaft")), t, "shaft");
  }
}

TEST(Layers, DepthBorderAgreesWithTheVectors) {
  for (const json& c : golden_cases("depth_border.json")) {
    const auto& in = c.at("in");
    const double d = depth_border(golden_number(in.at("t_near")), golden_number(in.at("c")), golden_number(in.at("s")));
    expect_close(d, golden_number(c.at("out").at("d")), 1e-14, 1.0, 0.0, in.dump().c_str());
  }
}

TEST(Layers, ParallaxRangeAgreesWithTheVectors) {
  for (const json& c : golden_cases("e_min.json")) {
    SCOPED_TRACE(c.at("in").dump());
    const auto in = [&](const char* key) { return golden_number(c.at("in").at(key)); };
    const double condition = golden_number(c.at("cond"));
    const double behind = parallax_behind(in("t"), in("s"), in("r"), in("alpha"));
    const double front = parallax_front(in("t"), in("s"), in("r"), in("alpha"));
    expect_close(behind, golden_number(c.at("out").at("e_behind")), 1e-14, condition, in("t"), "behind");
    expect_close(front, golden_number(c.at("out").at("e_front")), 1e-14, std::min(condition, 1e12), in("t"), "front");
  }
}

Vec2 golden_pair(const json& value) {
  return value.is_array() ? Vec2(value.at(0).get<double>(), value.at(1).get<double>()) : Vec2(0.0);
}

LayerSetup golden_setup(const json& in) {
  LayerSetup setup;
  setup.kind = in.at("kind") == "box" ? LayerSetup::Kind::kBox : LayerSetup::Kind::kShaft;
  setup.near_border = golden_pair(in.at("n"));
  setup.s = in.at("s").get<double>();
  setup.cell_depth = in.at("m").is_number() ? in.at("m").get<double>() : 0.0;
  setup.tan_half = golden_pair(in.at("tan_half_beta"));
  setup.object_width = golden_pair(in.at("w"));
  setup.t0 = in.at("t0").get<double>();
  setup.depth = golden_number(in.at("depth"));
  setup.resolution = golden_pair(in.at("res"));
  setup.alpha_rad = in.at("alpha").get<double>();
  setup.strict = in.at("strict").get<bool>();
  return setup;
}

TEST(Layers, SetsAgreeWithTheVectors) {
  for (const json& c : golden_cases("layer_sets.json")) {
    SCOPED_TRACE(c.at("in").dump());
    const auto layers = layer_distances(golden_setup(c.at("in")), 1000000);
    ASSERT_TRUE(layers.has_value());
    const json& expected = c.at("out");
    ASSERT_EQ(layers->size(), expected.size());
    const double tolerance = std::max(1e-10, 100.0 * golden_number(c.at("float64_worst_rel")));
    for (std::size_t i = 0; i < expected.size(); ++i) {
      expect_close((*layers)[i].t, golden_number(expected[i].at(0)), tolerance, 1.0, 0.0, "t");
      expect_close((*layers)[i].near, golden_number(expected[i].at(1)), tolerance, 1.0, 0.0, "near");
      expect_close((*layers)[i].far, golden_number(expected[i].at(2)), tolerance, 1.0, 0.0, "far");
    }
  }
}

}  // namespace
}  // namespace standin
