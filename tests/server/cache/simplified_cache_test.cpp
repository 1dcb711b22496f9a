#include "server/cache/simplified_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "render/scene/level_file.h"
#include "server/cache/object_content.h"
#include "tests/render/scene/level_meshes.h"
#include "tests/support/temp_folder.h"

namespace standin {
namespace {

void expect_same(const std::vector<SimplifiedMesh>& a, const std::vector<SimplifiedMesh>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(mesh_content(a[k].mesh), mesh_content(b[k].mesh)) << k;
    EXPECT_EQ(a[k].mesh.simplified_from, b[k].mesh.simplified_from) << k;
    EXPECT_EQ(a[k].mesh.is_piece, b[k].mesh.is_piece) << k;
    EXPECT_EQ(a[k].mesh.source, b[k].mesh.source) << k;
    EXPECT_EQ(a[k].mesh.name, b[k].mesh.name) << k;
    EXPECT_EQ(a[k].mesh.bounds.min, b[k].mesh.bounds.min) << k;
    EXPECT_EQ(a[k].mesh.bounds.max, b[k].mesh.bounds.max) << k;
    EXPECT_EQ(a[k].mesh.area_m2, b[k].mesh.area_m2) << k;
    EXPECT_EQ(a[k].error_m, b[k].error_m) << k;
    EXPECT_EQ(a[k].error_found_m, b[k].error_found_m) << k;
    EXPECT_EQ(a[k].pieces, b[k].pieces) << k;
  }
}

class SimplifiedCaches : public test::TempFolder {
 protected:
  /// In a job of its own.
  std::vector<SimplifiedMesh> cached(const Mesh& mesh, const SimplifyOptions& options = {}) {
    StageCache cache(root_, fingerprint_of("build"));
    auto forms = simplified_through(&cache)(mesh, options);
    counts_ = cache.figures().stages["simplified_meshes"];
    return forms;
  }

  CacheCounts counts_;
};

TEST_F(SimplifiedCaches, AreWhatSimplifyingWouldMake) {
  std::uint64_t forms = 0;
  for (const Mesh& mesh : {test::ball(12), test::sheet()})
    for (const SimplifyOptions& options :
         {SimplifyOptions{}, SimplifyOptions{.textured = false}, SimplifyOptions{.lock_border = true}, SimplifyOptions{.measure = false}}) {
      const auto fresh = simplified(mesh, options);
      forms += fresh.size();
      expect_same(cached(mesh, options), fresh);
      EXPECT_EQ(counts_.misses, 1U);
      expect_same(cached(mesh, options), fresh);
      EXPECT_EQ(counts_.hits, 1U);
      EXPECT_EQ(counts_.misses, 0U);
    }
  EXPECT_GE(forms, 4U);
}

TEST_F(SimplifiedCaches, WhatAMeshIsCalledAndWasMadeFromIsNoInput) {
  Mesh mesh = test::ball(12);
  static_cast<void>(cached(mesh));
  mesh.name = "renamed";
  mesh.is_piece = true;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) mesh.source.push_back(7 * v);
  expect_same(cached(mesh), simplified(mesh, {}));
  EXPECT_EQ(counts_.hits, 1U);
}

TEST_F(SimplifiedCaches, MeshesTooSmallForAnyFormAreNoEntries) {
  EXPECT_TRUE(cached(test::ball(2)).empty());
  EXPECT_EQ(counts_.hits + counts_.misses, 0U);
}

TEST_F(SimplifiedCaches, WhatIsCancelledLeavesNothing) {
  std::atomic<bool> stop = true;
  const WorkBudget cancelled(&stop);
  EXPECT_THROW(static_cast<void>(cached(test::ball(12), {.budget = &cancelled})), Failure);
  expect_same(cached(test::ball(12)), simplified(test::ball(12), {}));
  EXPECT_EQ(counts_.misses, 1U);
}

TEST_F(SimplifiedCaches, LevelsOfASceneAreTheSameOnSeveralThreads) {
  const auto levels_of = [&](const Simplify& simplify, int threads) {
    Scene scene = test::scene_of_placed({test::ball(12), test::sheet(), test::ball(9)}, {{0, Mat4(1.0)}, {1, Mat4(1.0)}, {2, Mat4(1.0)}});
    LevelOptions options = test::kLevelOptions;
    options.threads = threads;
    add_object_levels(scene, options, {}, simplify);
    return write_levels(scene).glb;
  };
  StageCache cache(root_, fingerprint_of("build"));
  const std::string fresh = levels_of(simplified, 1);
  EXPECT_EQ(levels_of(simplified_through(&cache), 3), fresh);
  EXPECT_EQ(levels_of(simplified_through(&cache), 2), fresh);
  EXPECT_EQ(cache.figures().stages["simplified_meshes"].hits, 3U);
}

TEST_F(SimplifiedCaches, WithoutACacheItIsSimplifying) {
  expect_same(simplified_through(nullptr)(test::sheet(), {}), simplified(test::sheet(), {}));
}

TEST(SimplifiedInputs, EveryOneMatters) {
  const Mesh plain = test::sheet();
  std::set<Fingerprint> all = {simplified_inputs(plain, {})};
  std::size_t changes = 1;
  const auto mesh = [&](const std::function<void(Mesh&)>& change) {
    Mesh changed = plain;
    change(changed);
    all.insert(simplified_inputs(changed, {}));
    ++changes;
  };
  mesh([](Mesh& m) { m.positions.back().y += 1e-6F; });
  mesh([](Mesh& m) { m.normals.back().y += 1e-6F; });
  mesh([](Mesh& m) { m.uvs.back().y += 1e-6F; });
  mesh([](Mesh& m) { m.uvs.clear(); });
  mesh([](Mesh& m) { std::swap(m.indices[0], m.indices[1]); });
  for (const SimplifyOptions& options :
       {SimplifyOptions{.textured = false}, SimplifyOptions{.lock_border = true}, SimplifyOptions{.measure = false},
        SimplifyOptions{.least_saving = 0.3}, SimplifyOptions{.pieces_per_triangle = 10.0}}) {
    all.insert(simplified_inputs(plain, options));
    ++changes;
  }
  EXPECT_EQ(all.size(), changes);
}

TEST_F(SimplifiedCaches, AnEntryThatFitsNoSuchMeshIsMadeAgain) {
  const Mesh mesh = test::ball(12);
  const Fingerprint inputs = simplified_inputs(mesh, {});
  const std::vector<std::uint32_t> beyond = {static_cast<std::uint32_t>(mesh.positions.size()), 0, 1};
  const std::vector<std::uint32_t> fine = {0, 1, 2};
  const std::vector<std::uint32_t> no_triangle = {0, 1};
  for (const auto& [source, indices] :
       {std::pair(beyond, fine), std::pair(fine, std::vector<std::uint32_t>{0, 1, 3}), std::pair(fine, no_triangle)}) {
    ByteWriter bytes;
    bytes.value(std::uint64_t{1});
    bytes.value(0.1);
    bytes.value(0.1);
    bytes.value(std::uint64_t{1});
    bytes.list(source);
    bytes.list(indices);
    StageCache(root_, fingerprint_of("build")).keep(kSimplifiedMeshes, inputs, bytes.bytes());
    expect_same(cached(mesh), simplified(mesh, {}));
    EXPECT_EQ(counts_.misses, 1U);
  }
}

}  // namespace
}  // namespace standin
