#include "render/view/enclosing_region.h"
#include "tests/support/golden.h"

namespace standin {
namespace {

Vec3 vec3(const nlohmann::json& value) {
  return {value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>()};
}

DirectionCone cone_of(const nlohmann::json& in) {
  const auto& axes = in.at("face_N_U_V");
  const FaceFrame frame{"", vec3(axes.at(0)), vec3(axes.at(1)), vec3(axes.at(2))};
  const auto cell = in.at("cell").get<std::array<double, 4>>();
  return enclosing_cone(frame, cell, std::tan(0.5 * in.at("fov_x").get<double>()), std::tan(0.5 * in.at("fov_y").get<double>()),
                        Vec3(0.0, 0.0, 1.0));
}

TEST(EnclosingFrusta, ContainTheSeenAndRejectTheFar) {
  for (const auto& vector : test::golden_cases("enclosing_frusta.json")) {
    const auto& in = vector.at("in");
    const auto& out = vector.at("out");
    SCOPED_TRACE(in.dump());
    const DirectionCone cone = cone_of(in);
    const Box positions{vec3(in.at("box").at(0)), vec3(in.at("box").at(1))};
    EXPECT_NEAR(cone.half_angle_rad, out.at("cone_half_angle").get<double>(), 1e-8);
    EXPECT_NEAR(glm::length(cone.axis - vec3(out.at("cone_axis"))), 0.0, 1e-12);
    for (const auto& point : out.at("must_contain")) EXPECT_TRUE(contains(cone, positions, vec3(point))) << point;
    for (const auto& point : out.at("cone_rejects")) EXPECT_FALSE(contains(cone, positions, vec3(point))) << point;
  }
}

}  // namespace
}  // namespace standin
