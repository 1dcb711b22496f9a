// The store's promises: nothing lost, nothing doubled, nobody sees what is another's.
#include "server/store/job_store.h"

#include <gtest/gtest.h>

#include "render/base/error.h"
#include "render/base/staged_file.h"
#include "server/store/blob_store.h"
#include "tests/support/temp_folder.h"

namespace standin {
namespace {

using nlohmann::json;

class JobStoreTest : public test::TempFolder {
 protected:
  static NewJob job(const std::string& owner = "anna", const std::string& label = "") {
    return {owner, "place", label, {{"kind", "place"}, {"label", label}}, {{"scene", {"city.glb", 3, std::string(64, 'a')}}}};
  }
  static ErrorWord word_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const Failure& failure) {
      return failure.word();
    }
    return ErrorWord::kInternal;
  }
  JobStore store_{root_ / "jobs.sqlite", {.all = 3, .of_one_owner = 3}};
};

TEST_F(JobStoreTest, JobsAreDoneInTheOrderInWhichTheyCame) {
  const std::string first = store_.submit(job(), "").job.id, second = store_.submit(job(), "").job.id;
  EXPECT_EQ(store_.start_next()->id, first);
  EXPECT_EQ(store_.start_next()->id, second);
  EXPECT_FALSE(store_.start_next().has_value());
}

TEST_F(JobStoreTest, OwnersTakeTurns) {
  std::vector<std::string> annas;
  JobStore store(root_ / "turns.sqlite");
  for (int i = 0; i < 3; ++i) annas.push_back(store.submit(job("anna"), "").job.id);
  const std::string berts = store.submit(job("bert"), "").job.id;
  EXPECT_EQ(store.start_next()->id, annas[0]);
  EXPECT_EQ(store.start_next()->id, berts) << "anna has one running";
  store.finish(berts, {.state = JobState::kSucceeded, .aim_met = true, .problem = {}, .artifacts = {}});
  EXPECT_EQ(store.start_next()->id, annas[1]) << "nobody else waits";
}

TEST_F(JobStoreTest, WhatGoesBackIsNextAgainAndCountsItsAttempts) {
  const std::string first = store_.submit(job(), "").job.id;
  (void)store_.submit(job(), "");
  EXPECT_EQ(store_.start_next()->attempts, 1);
  store_.report(first, "bake", 0.5, {{"impostors", 3.0}});
  store_.requeue(first, true);
  EXPECT_TRUE(store_.find("anna", first)->best_so_far.is_null()) << "what a lost worker had is lost";
  EXPECT_EQ(store_.start_next()->id, first);
  store_.requeue(first, false);
  const auto again = store_.start_next();
  EXPECT_EQ(again->id, first);
  EXPECT_EQ(again->attempts, 2) << "the second attempt did not count";
}

TEST_F(JobStoreTest, SurvivesItsProcess) {
  const std::string id = store_.submit(job("anna", "night"), "key").job.id;
  (void)store_.start_next();
  JobStore other(root_ / "jobs.sqlite");
  const auto found = other.find("anna", id);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->state, JobState::kRunning);
  EXPECT_EQ(found->label, "night");
  EXPECT_EQ(other.inputs_of(id).at("scene").sha256, std::string(64, 'a'));
  EXPECT_TRUE(other.submit(job("anna", "night"), "key").replayed);
}

TEST_F(JobStoreTest, TheSameKeyIsTheSameJobOfOneOwner) {
  const std::string id = store_.submit(job(), "key").job.id;
  EXPECT_EQ(store_.submit(job(), "key").job.id, id);
  EXPECT_NE(store_.submit(job("bert"), "key").job.id, id);
  EXPECT_EQ(word_of([&] { (void)store_.submit(job("anna", "other"), "key"); }), ErrorWord::kKeyReused);
}

TEST_F(JobStoreTest, TheQueueIsBounded) {
  for (int i = 0; i < 3; ++i) (void)store_.submit(job(), "");
  EXPECT_EQ(word_of([&] { (void)store_.submit(job(), "late"); }), ErrorWord::kQueueFull);
  (void)store_.start_next();
  EXPECT_FALSE(store_.submit(job(), "late").replayed) << "a refused job leaves no key behind";
}

TEST_F(JobStoreTest, OneOwnerDoesNotFillTheQueueForAll) {
  JobStore store(root_ / "shared.sqlite", {.all = 3, .of_one_owner = 2});
  for (int i = 0; i < 2; ++i) (void)store.submit(job("anna"), "");
  EXPECT_EQ(word_of([&] { (void)store.submit(job("anna"), ""); }), ErrorWord::kQueueFull);
  (void)store.submit(job("bert"), "");
  (void)store.start_next();  // of anna's
  EXPECT_FALSE(store.submit(job("anna"), "").replayed);
  EXPECT_EQ(word_of([&] { (void)store.submit(job("bert"), ""); }), ErrorWord::kQueueFull) << "three wait in all";
}

TEST_F(JobStoreTest, AnOwnersBytesCountOnceWhereverTheyAreUsed) {
  const StoredFile city{"city.glb", 3, std::string(64, 'a')};  // what job() reads
  (void)store_.add_upload("anna", city);
  (void)store_.add_upload("anna", {"again.glb", 3, city.sha256});
  (void)store_.add_upload("anna", {"other.glb", 40, std::string(64, 'b')});
  (void)store_.add_upload("bert", {"large.glb", 500, std::string(64, 'c')});
  const std::string id = store_.submit(job("anna"), "").job.id;
  (void)store_.start_next();
  store_.finish(id, {.state = JobState::kSucceeded, .aim_met = true, .problem = {}, .artifacts = {{"x", 7000, std::string(64, 'd')}}});
  EXPECT_EQ(store_.bytes_of("anna"), 7043U);
  EXPECT_EQ(store_.bytes_of("anna", {city.sha256}), 7040U);
  EXPECT_EQ(store_.bytes_of("carl"), 0U);
}

TEST_F(JobStoreTest, OldUploadsGoUnlessAJobUsesThem) {
  const Upload used = store_.add_upload("anna", {"city.glb", 3, std::string(64, 'a')});
  const Upload unused = store_.add_upload("anna", {"other.glb", 3, std::string(64, 'b')});
  const std::string id = store_.submit(job("anna"), "").job.id;
  store_.remove_uploads_before(unused.created_ms);
  EXPECT_TRUE(store_.find_upload("anna", unused.id)) << "it came at that moment, not before";
  store_.remove_uploads_before(now_ms() + 1);
  EXPECT_TRUE(store_.find_upload("anna", used.id));
  EXPECT_FALSE(store_.find_upload("anna", unused.id));
  (void)store_.remove("anna", id);
  store_.remove_uploads_before(now_ms() + 1);
  EXPECT_FALSE(store_.find_upload("anna", used.id));
}

TEST_F(JobStoreTest, NobodySeesWhatIsAnothers) {
  const std::string id = store_.submit(job(), "").job.id;
  EXPECT_FALSE(store_.find("bert", id).has_value());
  EXPECT_FALSE(store_.ask_cancel("bert", id).has_value());
  EXPECT_FALSE(store_.remove("bert", id));
  EXPECT_TRUE(store_.list("bert", {}).jobs.empty());
  const Upload upload = store_.add_upload("anna", {"city.glb", 3, std::string(64, 'b')});
  EXPECT_FALSE(store_.find_upload("bert", upload.id).has_value());
  EXPECT_FALSE(store_.remove_upload("bert", upload.id));
}

TEST_F(JobStoreTest, AQueuedJobIsCancelledAtOnceARunningOneIsAsked) {
  const std::string running = store_.submit(job(), "").job.id, queued = store_.submit(job(), "").job.id;
  (void)store_.start_next();
  EXPECT_EQ(store_.ask_cancel("anna", queued)->state, JobState::kCancelled);
  EXPECT_EQ(store_.ask_cancel("anna", running)->state, JobState::kRunning);
  EXPECT_TRUE(store_.find("anna", running)->cancel_asked);
  EXPECT_EQ(word_of([&] { (void)store_.remove("anna", running); }), ErrorWord::kNotFinished);
  EXPECT_FALSE(store_.start_next().has_value());
}

TEST_F(JobStoreTest, PagesHoldEachJobOnce) {
  JobStore store(root_ / "many.sqlite");
  std::vector<std::string> ids;
  for (int i = 0; i < 7; ++i) ids.insert(ids.begin(), store.submit(job(), "").job.id);
  std::vector<std::string> seen;
  JobFilter filter{.state = JobState::kQueued, .kind = "place", .limit = 3};
  for (int page = 0; page < 3; ++page) {
    const JobPage got = store.list("anna", filter);
    for (const Job& one : got.jobs) seen.push_back(one.id);
    EXPECT_EQ(got.next.has_value(), page < 2);
    filter.before = got.next.value_or(0);
  }
  EXPECT_EQ(seen, ids);
}

TEST_F(JobStoreTest, EventsTellEveryStateInOrder) {
  const std::string id = store_.submit(job(), "").job.id;
  (void)store_.start_next();
  store_.report(id, "survey", 0.5, {{"worst_bound_ms", 30.5}});
  EXPECT_EQ(store_.find("anna", id)->best_so_far["worst_bound_ms"], 30.5);
  store_.finish(id,
                {.state = JobState::kSucceeded, .aim_met = true, .problem = {}, .artifacts = {{"metrics.json", 2, std::string(64, 'c')}}});
  store_.report(id, "late", 0.1, nullptr);  // of a worker that is gone
  const auto events = store_.events_of(id, 0);
  ASSERT_EQ(events.size(), 4U);
  EXPECT_EQ(events[0].data["state"], "queued");
  EXPECT_EQ(events[2].data["stage"], "survey");
  EXPECT_TRUE(events[1].data["best_so_far"].is_null());
  EXPECT_EQ(events[2].data["best_so_far"]["worst_bound_ms"], 30.5);
  EXPECT_EQ(events[3].data["aim_met"], true);
  EXPECT_EQ(store_.events_of(id, events[1].id).size(), 2U);
  EXPECT_EQ(store_.artifacts_of(id).at(0).name, "metrics.json");
}

TEST_F(JobStoreTest, PredictsByWhatEarlierJobsTookInProportionToTheirScenes) {
  EXPECT_EQ(store_.predict("anna", "place", 3).jobs, 0);
  for (const std::uint64_t rss_bytes : {100, 300, 900}) {
    const std::string id = store_.submit(job(), "").job.id;
    (void)store_.start_next();
    store_.finish(id, {.state = JobState::kSucceeded, .aim_met = true, .problem = {}, .artifacts = {}, .used = JobUse{1.0, rss_bytes}});
  }
  const JobPrediction predicted = store_.predict("anna", "place", 6);  // twice the scene's 3 bytes
  EXPECT_EQ(predicted.jobs, 3);
  EXPECT_EQ(predicted.peak_rss_bytes, 600.0);
  EXPECT_EQ(store_.predict("anna", "survey", 6).jobs, 0);
  EXPECT_EQ(store_.predict("bert", "place", 6).jobs, 0);
}

TEST_F(JobStoreTest, ARemovedJobTakesAllOfItsOwnAlong) {
  const std::string id = store_.submit(job(), "key").job.id;
  EXPECT_EQ(store_.blobs_in_use().size(), 1U);
  EXPECT_TRUE(store_.remove("anna", id));
  EXPECT_TRUE(store_.blobs_in_use().empty());
  EXPECT_TRUE(store_.events_of(id, 0).empty());
  EXPECT_FALSE(store_.submit(job(), "key").replayed);
}

class BlobStoreTest : public test::TempFolder {
 protected:
  BlobStore blobs_{root_ / "blobs"};
};

// SHA-256 of "abc" (FIPS 180-2, B.1).
constexpr const char* kAbc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

TEST_F(BlobStoreTest, PiecesBecomeOneFileNamedByItsContent) {
  BlobStore::Incoming incoming(blobs_);
  incoming.write("a");
  incoming.write("bc");
  const StoredFile file = incoming.finish("x");
  EXPECT_EQ(file.sha256, kAbc);
  EXPECT_EQ(file.bytes, 3U);
  EXPECT_EQ(std::filesystem::file_size(blobs_.path_of(kAbc)), 3U);
}

TEST_F(BlobStoreTest, WhatIsNotFinishedLeavesNoTrace) {
  { BlobStore::Incoming(blobs_).write("abc"); }
  EXPECT_FALSE(blobs_.holds(kAbc));
  EXPECT_TRUE(std::filesystem::is_empty(root_ / "blobs/incoming"));
}

TEST_F(BlobStoreTest, KeepsWhatIsInUseOrCameInAMomentAgo) {
  BlobStore::Incoming incoming(blobs_);
  incoming.write("abc");
  (void)incoming.finish("x");
  blobs_.keep_only({}, std::chrono::seconds(60));
  EXPECT_TRUE(blobs_.holds(kAbc)) << "nobody had the time to say that it is in use";
  blobs_.keep_only({kAbc}, std::chrono::seconds(0));
  EXPECT_TRUE(blobs_.holds(kAbc));
  blobs_.keep_only({}, std::chrono::seconds(0));
  EXPECT_FALSE(blobs_.holds(kAbc));
}

TEST_F(BlobStoreTest, ABlobThatACrashCutIsReplaced) {
  std::filesystem::create_directories(blobs_.path_of(kAbc).parent_path());
  write_file(blobs_.path_of(kAbc), "a");
  BlobStore::Incoming incoming(blobs_);
  incoming.write("abc");
  (void)incoming.finish("x");
  EXPECT_EQ(read_file(blobs_.path_of(kAbc)), "abc");
}

}  // namespace
}  // namespace standin
