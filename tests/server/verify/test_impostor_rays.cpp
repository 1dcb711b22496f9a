#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/base/error.h"
#include "tests/server/verify/judged_panes.h"

namespace standin {
namespace {

using test::HandMadeQuad;
using test::judged;
using test::kCamera;
using test::kFromOrigin;
using test::panes;
using test::SceneMaker;
using test::write_glb;

ImpostorJudgement judge(const Scene& scene, const std::vector<HandMadeQuad>& quads, const JudgedImpostor& impostor,
                        const std::vector<View>& views = {kFromOrigin}, const Camera& camera = kCamera) {
  return judge_impostor(scene, test::read_back(quads), impostor, camera, views, 1, {});
}

TEST(ImpostorRays, APaneAndItsQuadAgree) {
  const Scene scene = panes({{2.0, 10.0}});
  const auto result = judge(scene, {HandMadeQuad{}}, judged(scene, {{10.0, 10.0, 10.0}}));
  EXPECT_EQ(result.views, 1U);
  EXPECT_EQ(result.pixels, 26U * 26U);
  EXPECT_EQ(result.shown_pixels, 30U * 30U);
  EXPECT_EQ(result.gap_pixels, 0U);
  EXPECT_EQ(result.baseless_pixels, 0U);
  EXPECT_LT(result.max_parallax_ratio, 1e-4);
}

// 16 texels over slopes of 0.4 are 1.93 pixels each: column 8 holds the centres of two pixel columns, row 4 of two rows.
TEST(ImpostorRays, MissingTexelsAreGaps) {
  const Scene scene = panes({{2.0, 10.0}});
  const JudgedImpostor impostor = judged(scene, {{10.0, 10.0, 10.0}});
  const auto column = judge(scene, {{10.0, 0.2, 16, [](int x, int) { return x != 8; }}}, impostor);
  EXPECT_EQ(column.gap_pixels, 2U * 26U);
  EXPECT_EQ(column.shown_pixels, 28U * 30U);
  const auto texel = judge(scene, {{10.0, 0.2, 16, [](int x, int y) { return x != 8 || y != 4; }}}, impostor);
  EXPECT_EQ(texel.gap_pixels, 4U);
}

// Above the middle only: rows count from the top.
TEST(ImpostorRays, RowsCountFromTheTop) {
  SceneMaker maker;
  maker.add_object(maker.pane_mesh(), glm::scale(glm::translate(Mat4(1.0), Vec3(0, 1, -10)), Vec3(2, 1, 1)));
  const Scene upper = maker.take();
  const JudgedImpostor impostor = judged(upper, {{10.0, 10.0, 10.0}});
  EXPECT_EQ(judge(upper, {{10.0, 0.2, 16, [](int, int y) { return y < 8; }}}, impostor).gap_pixels, 0U);
  const auto flipped = judge(upper, {{10.0, 0.2, 16, [](int, int y) { return y >= 8; }}}, impostor);
  EXPECT_EQ(flipped.gap_pixels, flipped.pixels);
}

// A gap only counts where the original fills the disc: a column missing at the very border of the pane is none.
TEST(ImpostorRays, NothingIsAGapNearTheOutline) {
  const Scene scene = panes({{2.0, 10.0}});
  const auto result = judge(scene, {{10.0, 0.2, 16, [](int x, int) { return x != 0; }}}, judged(scene, {{10.0, 10.0, 10.0}}));
  EXPECT_EQ(result.gap_pixels, 0U);
}

// One pixel wider on every side: 32 x 32 pixels instead of 30 x 30, whose outline is 4 x 29 pixels and four cut corners long.
TEST(ImpostorRays, BloatIsTheExcessOverTheOutline) {
  const Scene scene = panes({{2.0, 10.0}});
  const JudgedImpostor impostor = judged(scene, {{10.0, 10.0, 10.0}});
  const auto opaque = [](int, int) { return true; };
  const auto wide = judge(scene, {{10.0, 16.45 / 15.45 * 0.2, 16, opaque}}, impostor);
  EXPECT_EQ(wide.excess_pixels, 32U * 32U - 30U * 30U);
  EXPECT_NEAR(*wide.bloat_px(), 124.0 / (116.0 + 4.0 / std::numbers::sqrt2), 1e-12);
  EXPECT_EQ(*judge(scene, {{10.0, 0.2, 16, opaque}}, impostor).bloat_px(), 0.0);
  const View inside_it{Vec3(0, 0, -9), Vec3(0, 0, -1)};
  EXPECT_FALSE(judge(scene, {{10.0, 0.2, 16, opaque}}, impostor, {inside_it}).bloat_px()) << "no outline is in the image";
}

// Two panes, the near one missing in the GLB: what shows through is 10 m too far.
TEST(ImpostorRays, SeeingThroughIsAGapUnlessTheSlabIsThatThick) {
  const Scene scene = panes({{2.0, 10.0}, {4.0, 20.0}});
  const std::vector<HandMadeQuad> far_only = {{20.0, 0.2, 16, [](int, int) { return true; }}};
  const auto thin = judge(scene, far_only, judged(scene, {{10.0, 9.9, 10.1}, {20.0, 19.9, 20.1}}));
  EXPECT_EQ(thin.gap_pixels, 26U * 26U);
  const auto thick = judge(scene, far_only, judged(scene, {{20.0, 9.5, 20.1}}));
  EXPECT_EQ(thick.gap_pixels, 0U);
}

TEST(ImpostorRays, TheNearestOpaqueTexelShows) {
  const Scene scene = panes({{2.0, 10.0}, {4.0, 20.0}});
  const auto result = judge(scene, {{20.0, 0.2, 8, [](int, int) { return true; }}, {10.0, 0.2, 8, [](int, int) { return true; }}},
                            judged(scene, {{10.0, 9.9, 10.1}, {20.0, 19.9, 20.1}}));
  EXPECT_EQ(result.gap_pixels, 0U);
  EXPECT_LT(result.max_parallax_ratio, 1e-4);
}

// A small pane at 10 m shown at 11 m, seen from 3 m to the side: atan(3/10) - atan(3/11) away from its place.
TEST(ImpostorRays, ADisplacedQuadHasItsAngleAsRatio) {
  const Scene scene = panes({{0.1, 10.0}});
  JudgedImpostor impostor = judged(scene, {{11.0, 10.0, 11.0}});
  impostor.alpha_rad = 0.5 * (std::atan(0.3) - std::atan(3.0 / 11.0));
  const View beside{Vec3(3, 0, 0), glm::normalize(Vec3(-3, 0, -10.5))};
  const auto result = judge(scene, {{11.0, 0.01, 8, [](int, int) { return true; }}}, impostor, {kFromOrigin, beside}, {0.1, 256, 256, 0.1});
  EXPECT_GT(result.shown_pixels, 100U);
  EXPECT_NEAR(result.max_parallax_ratio, 2.0, 0.05);
  EXPECT_EQ(result.worst_view, 1U);
}

// Closed coverage: the pane ends inside the outermost texels, which are opaque all the same.
TEST(ImpostorRays, ATexelMayPassItsSurfaceByOneTexel) {
  const Scene scene = panes({{1.8, 10.0}});
  const auto result = judge(scene, {HandMadeQuad{}}, judged(scene, {{10.0, 9.0, 11.0}}));
  EXPECT_GT(result.shown_pixels, 28U * 28U);
  EXPECT_EQ(result.baseless_pixels, 0U);
  EXPECT_LT(result.max_parallax_ratio, 1e-4);
}

TEST(ImpostorRays, TexelsWithoutAnOriginalAreCounted) {
  const Scene scene = panes({{1.8, 10.0}});
  const auto fine = judge(scene, {{10.0, 0.3, 128, [](int, int) { return true; }}}, judged(scene, {{10.0, 9.0, 11.0}}));
  EXPECT_GT(fine.baseless_pixels, 0U);
  const auto wrong_depth = judge(scene, {{30.0, 0.2, 16, [](int, int) { return true; }}}, judged(scene, {{30.0, 29.0, 31.0}}));
  EXPECT_EQ(wrong_depth.baseless_pixels, wrong_depth.shown_pixels);
  EXPECT_EQ(wrong_depth.gap_pixels, wrong_depth.pixels);
}

TEST(ImpostorRays, DoesNotDependOnThreads) {
  const Scene scene = panes({{2.0, 10.0}, {4.0, 20.0}});
  const GlbQuads quads =
      read_glb_quads(write_glb({"imp_0", Vec3(0.0), "MASK", {{11.0, 0.2, 16, [](int x, int y) { return (x + y) % 5 > 0; }}}}));
  const JudgedImpostor impostor = judged(scene, {{11.0, 10.0, 12.0}});
  Shaft cell = shaft_frame(Vec3(0, 0, -10), Vec3(0, 0, 1));
  cell.tan_half = Vec2(0.3);
  cell.min_distance_m = 10.0;
  const auto views = sample_cell_views(cell, scene.bounds, 40, 3);
  const auto one = judge_impostor(scene, quads, impostor, kCamera, views, 1, {});
  const auto three = judge_impostor(scene, quads, impostor, kCamera, views, 3, {});
  EXPECT_GT(one.gap_pixels, 0U);
  EXPECT_EQ(one.gap_pixels, three.gap_pixels);
  EXPECT_EQ(one.shown_pixels, three.shown_pixels);
  EXPECT_EQ(one.max_parallax_ratio, three.max_parallax_ratio);
  EXPECT_EQ(one.worst_view, three.worst_view);
}

TEST(ImpostorRays, AnImpostorWithoutQuadsIsAllGap) {
  const Scene scene = panes({{2.0, 10.0}});
  GlbQuads quads;
  quads.impostors.push_back({"imp_0", Vec3(0.0), {}});
  const auto result = judge_impostor(scene, quads, judged(scene, {{10.0, 10.0, 10.0}}), kCamera, std::vector<View>{kFromOrigin}, 1, {});
  EXPECT_EQ(result.gap_pixels, 26U * 26U);
  EXPECT_EQ(result.shown_pixels, 0U);
}

TEST(ImpostorRays, RefusesQuadsThatAreNoLayer) {
  const Scene scene = panes({{2.0, 10.0}});
  GlbQuads quads;
  GlbTriangle tilted;
  tilted.offsets = {Vec3(0, 0, -10), Vec3(1, 0, -11), Vec3(0, 1, -10)};
  quads.impostors.push_back({"imp_0", Vec3(0.0), {tilted}});
  const JudgedImpostor impostor = judged(scene, {{10.0, 10.0, 10.0}});
  EXPECT_THROW(static_cast<void>(judge_impostor(scene, quads, impostor, kCamera, std::vector<View>{kFromOrigin}, 1, {})), Failure);
}

}  // namespace
}  // namespace standin
