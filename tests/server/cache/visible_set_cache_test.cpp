#include "server/cache/visible_set_cache.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/server/cache/painted_scene.h"
#include "tests/support/temp_folder.h"

namespace standin {
namespace {

using test::kBlock, test::kPane;

const std::vector<Box> kRegions = {{Vec3(-8.0, 1.0, 6.0), Vec3(-4.0, 2.0, 8.0)}, {Vec3(2.0, 1.0, 6.0), Vec3(6.0, 2.0, 8.0)}};
const VisibilityOptions kOptions{.rays = 20'000, .missed_share = 1e-2, .seed = 3};

class VisibleSetCaches : public test::TempFolder {
 protected:
  /// Looks up or samples the sets of a scene and audits them; counts into `hits` and `misses`.
  std::vector<VisibleSet> sets_of(const Scene& scene, int threads = 1) {
    StageCache cache(root_, fingerprint_of("build"));
    const Raytracer raytracer(scene);
    const VisibleSetCache visible(&cache, scene, raytracer);
    auto sets = visible.sets(kRegions, kOptions, threads, {});
    audit_ = visible.audit(kRegions, sets, Camera{}, {.rays = 1000}, threads, {});
    counts_ = cache.figures().stages["visible_sets"];
    audits_ = cache.figures().stages["visibility_audits"];
    return sets;
  }

  CacheCounts counts_;
  CacheCounts audits_;
  VisibilityAudit audit_;
};

void expect_same(const std::vector<VisibleSet>& a, const std::vector<VisibleSet>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].objects, b[i].objects);
    EXPECT_EQ(a[i].missed_share_bound, b[i].missed_share_bound);
    EXPECT_EQ(a[i].rays, b[i].rays);
    EXPECT_EQ(a[i].misses, b[i].misses);
  }
}

std::vector<VisibleSet> fresh_sets(const Scene& scene) {
  const Raytracer raytracer(scene);
  return sample_visible_sets(scene, raytracer, kRegions, kOptions, 2, {});
}

TEST_F(VisibleSetCaches, AreWhatSamplingWouldFind) {
  const Scene scene = test::painted_scene();
  const auto fresh = fresh_sets(scene);
  ASSERT_GE(fresh[0].objects.size(), 2U);
  expect_same(sets_of(scene), fresh);
  EXPECT_EQ(counts_.misses, 2U);
  EXPECT_EQ(audits_.misses, 1U);
  const VisibilityAudit audit = audit_;
  expect_same(sets_of(scene, 3), fresh);
  EXPECT_EQ(counts_.hits, 2U);
  EXPECT_EQ(counts_.misses, 0U);
  EXPECT_EQ(audits_.hits, 1U);
  EXPECT_EQ(audit_.mean_missed_share_bound, audit.mean_missed_share_bound);
  EXPECT_EQ(audit_.worst_view_share, audit.worst_view_share);
  EXPECT_EQ(audit_.mean_worst_share, audit.mean_worst_share);
  EXPECT_EQ(audit_.rays, audit.rays);
  EXPECT_EQ(audit_.misses, audit.misses);
  EXPECT_EQ(audit_.views, audit.views);
}

TEST_F(VisibleSetCaches, ColoursDoNotMatterAndMasksAndPlacesDo) {
  const Scene before = test::painted_scene();
  static_cast<void>(sets_of(before));
  const auto after = [&](const std::function<void(Scene&)>& change) {
    Scene scene = before;
    change(scene);
    update_derived(scene);
    expect_same(sets_of(scene), fresh_sets(scene));
    return counts_.misses;
  };
  EXPECT_EQ(after([](Scene& s) { s.materials[2].base_colour.r = 0.5F; }), 0U);
  EXPECT_EQ(after([](Scene& s) { s.textures[0].rgba[1] ^= 1; }), 0U);
  EXPECT_EQ(after([](Scene& s) { s.textures[0].rgba[3] ^= 255; }), 2U) << "what the mask lets through";
  EXPECT_EQ(after([](Scene& s) { s.objects[kBlock].world_from_object[3].x += 0.5; }), 2U);
  EXPECT_EQ(after([](Scene& s) { s.objects.pop_back(); }), 2U);
  EXPECT_EQ(after([](Scene& s) { std::swap(s.objects[kPane], s.objects[kBlock]); }), 2U) << "entries hold numbers";
  EXPECT_EQ(after([](Scene& s) { s.parts[kBlock].mesh = 1; }), 2U) << "instances of one tree";
}

TEST_F(VisibleSetCaches, EverySettingMatters) {
  const Scene scene = test::painted_scene();
  const Raytracer raytracer(scene);
  StageCache cache(root_, fingerprint_of("build"));
  const VisibleSetCache visible(&cache, scene, raytracer);
  std::set<Fingerprint> all = {visible.inputs_of(kRegions[0], kOptions, 0), visible.inputs_of(kRegions[1], kOptions, 0),
                               visible.inputs_of(kRegions[0], kOptions, 1)};
  for (int setting = 0; setting < 3; ++setting) {
    VisibilityOptions options = kOptions;
    if (setting == 0) options.rays += 1;
    if (setting == 1) options.missed_share *= 2;
    if (setting == 2) options.seed += 1;
    all.insert(visible.inputs_of(kRegions[0], options, 0));
  }
  EXPECT_EQ(all.size(), 6U);
}

}  // namespace
}  // namespace standin
