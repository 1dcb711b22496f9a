#include "server/sweep/curve.h"

#include <gtest/gtest.h>

#include "tests/server/sweep/points.h"

namespace standin {
namespace {

using nlohmann::json;
using test::point;

TEST(Curve, IsReadAsItWasWritten) {
  const Curve curve = curve_from_json(test::sweep_json({point(10.25, 5000, 3), point(16.0, 1200)}), "a.json");
  EXPECT_EQ(curve.subject, (CurveSubject{"city.glb", "llvmpipe", 45.0, 512, 384}));
  ASSERT_EQ(curve.points.size(), 2U);
  EXPECT_EQ(curve.points[0].budget_ms, 10.25);
  EXPECT_EQ(curve.points[0].unsolved, 3U);
  EXPECT_FALSE(curve.points[0].met());
  EXPECT_EQ(curve.points[1].texture_bytes, 1200U);
  EXPECT_EQ(curve.points[1].total_bytes(), 1320U);
  EXPECT_EQ(curve.points[1].lower_bound_bytes, 300.0);
  EXPECT_EQ(point_at(curve.points, 16.0), &curve.points[1]);
  EXPECT_EQ(point_at(curve.points, 16.0001), nullptr);
}

TEST(Curve, WhatIsBrokenIsNamed) {
  const auto sentence_after = [](const std::function<void(json&)>& change) {
    json object = test::sweep_json({point(10.0, 5000), point(16.0, 1200)});
    change(object);
    const Failure failure = test::failure_of([&] { static_cast<void>(curve_from_json(object, "a.json")); });
    EXPECT_EQ(failure.word(), ErrorWord::kFileBroken);
    return std::string(failure.what());
  };
  EXPECT_NE(sentence_after([](json& j) { j = json::array(); }).find("a.json lacks \"format\""), std::string::npos);
  EXPECT_NE(sentence_after([](json& j) { j["format"] = "standin.placement"; }).find("standin.placement"), std::string::npos);
  EXPECT_NE(sentence_after([](json& j) { j["version"] = 2; }).find("version 2"), std::string::npos);
  EXPECT_NE(sentence_after([](json& j) { j.erase("target"); }).find("\"target\""), std::string::npos);
  EXPECT_NE(sentence_after([](json& j) { j["points"] = json::array(); }).find("holds no budget"), std::string::npos);
  EXPECT_NE(sentence_after([](json& j) { j["points"][1].erase("texture_bytes"); }).find("points[1] lacks \"texture_bytes\""),
            std::string::npos);
  EXPECT_NE(sentence_after([](json& j) { j["points"][0]["texture_bytes"] = -4; }).find("points[0].texture_bytes = -4"), std::string::npos);
  EXPECT_NE(sentence_after([](json& j) { j["points"][0]["texture_bytes"] = 1.5; }).find("whole number"), std::string::npos);
  EXPECT_NE(sentence_after([](json& j) { j["points"][0]["cpv"]["unsolved"] = 101; }).find("more unsolved"), std::string::npos);
  EXPECT_NE(sentence_after([](json& j) { j["points"][0]["cpv"] = 3; }).find("points[0].cpv lacks"), std::string::npos);
  EXPECT_NE(sentence_after([](json& j) { std::swap(j["points"][0], j["points"][1]); }).find("order"), std::string::npos);
  EXPECT_NE(sentence_after([](json& j) { j["points"][1] = j["points"][0]; }).find("order"), std::string::npos);
}

TEST(Curve, BudgetsAreSaidAsTheyAreTyped) {
  EXPECT_EQ(milliseconds_text(16.0), "16 ms");
  EXPECT_EQ(milliseconds_text(16.05), "16.05 ms");
}

}  // namespace
}  // namespace standin
