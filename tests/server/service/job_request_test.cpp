// Bodies of POST /v1/jobs: what is taken, and how what is wrong is named.
#include "server/service/job_request.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "server/http/message.h"
#include "server/service/work_folder.h"

namespace standin {
namespace {

using nlohmann::json;

json place() {
  return {{"kind", "place"}, {"scene", {{"name", "a.glb"}}}, {"target", {{"upload", "t"}}}, {"spec", {{"budget_ms", 16}}}};
}

std::vector<std::string> pointers_of(const json& body) {
  std::vector<std::string> pointers;
  try {
    (void)parse_job_request(body);
  } catch (const InvalidBody& invalid) {
    for (const auto& problem : invalid.problems()) pointers.push_back(problem.pointer);
  }
  return pointers;
}

json with(json body, const std::string& pointer, const json& value) {
  body[json::json_pointer(pointer)] = value;
  return body;
}

TEST(JobRequest, SettingsAreThoseOfAConfigurationFile) {
  const JobRequest request = parse_job_request(with(with(place(), "/spec/view_space/leaf_m", 46), "/label", "night"));
  EXPECT_EQ(request.kind, JobKind::kPlace);
  EXPECT_EQ(request.spec.leaf_m, 46.0);
  EXPECT_EQ(request.spec.budget_ms, 16.0);
  EXPECT_EQ(request.scene.source, FileReference::Source::kName);
  EXPECT_EQ(request.target.value, "t");
  EXPECT_EQ(request.label, "night");
}

TEST(JobRequest, EveryKindSaysWhatItNeeds) {
  using testing::ElementsAre;
  EXPECT_THAT(pointers_of({{"kind", "place"}}), ElementsAre("/scene", "/target", "/spec/budget_ms"));
  EXPECT_THAT(pointers_of({{"kind", "survey"}}), ElementsAre("/scene", "/target"));
  EXPECT_THAT(pointers_of({{"kind", "verify"}}), ElementsAre("/job"));
  EXPECT_THAT(pointers_of({{"kind", "bake"}, {"scene", {{"name", "a.glb"}}}}), ElementsAre("/arguments/view_cell"));
  EXPECT_THAT(pointers_of({{"kind", "calibrate"}}), ElementsAre());
  EXPECT_THAT(pointers_of({{"kind", "dance"}}), ElementsAre("/kind"));
  EXPECT_THAT(pointers_of(json::array()), ElementsAre(""));
  EXPECT_THAT(pointers_of({{"kind", 7}}), ElementsAre("/kind"));
}

TEST(JobRequest, BoxesAreLookedAtToTheirNumbers) {
  const json corner = {0, 1, 2}, box = {{"min", corner}, {"max", corner}};
  EXPECT_EQ(parse_job_request(with(place(), "/spec/view_space/boxes", {box, box})).spec.boxes.size(), 2U);
  for (const json& wrong : {json(5), json::array(), json("x"), json{{"min", corner}}, json{{"min", corner}, {"max", 3}},
                            json{{"min", corner}, {"max", {0, 1}}}, json{{"min", corner}, {"max", {0, 1, "2"}}},
                            json{{"min", corner}, {"max", {0, 1, 2, 3}}}, json{{"min", corner}, {"max", corner}, {"mid", corner}}})
    EXPECT_THAT(pointers_of(with(place(), "/spec/view_space/boxes", json::array({box, wrong}))),
                testing::ElementsAre("/spec/view_space/boxes"))
        << wrong;
}

TEST(JobRequest, WhatIsTheServicesOwnIsRefused) {
  for (const char* pointer : {"/spec/cache/folder", "/spec/cache/update", "/spec/scene/texture_folders", "/spec/scene/max_triangles",
                              "/spec/scene/max_texels", "/spec/threads", "/spec/device"}) {
    EXPECT_THAT(pointers_of(with(place(), pointer, json::array())), testing::ElementsAre(pointer)) << pointer;
    const json::json_pointer place_in_schema(std::regex_replace(std::string(pointer), std::regex("/"), "/properties/"));
    EXPECT_FALSE(job_request_schema().contains(place_in_schema)) << pointer;
  }
  EXPECT_TRUE(job_request_schema().contains(json::json_pointer("/properties/spec/properties/scene/properties/up")));
  EXPECT_THAT(pointers_of(with(place(), "/spec/view_space/kind", "path:/etc/passwd")), testing::ElementsAre("/spec/view_space/kind"));
}

TEST(JobRequest, NamesEachWrongFieldByAPointerWithItsEscapes) {
  EXPECT_THAT(pointers_of(with(with(place(), "/spec/camera/width", 1e30), "/spec/camera/fov_y_deg", "wide")),
              testing::UnorderedElementsAre("/spec/camera/width", "/spec/camera/fov_y_deg"));
  json body = place();
  body["a/b~c"] = 1;
  EXPECT_THAT(pointers_of(body), testing::ElementsAre("/a~1b~0c"));
  EXPECT_THAT(pointers_of(with(place(), "/spec", 3)), testing::ElementsAre("/spec", "/spec/budget_ms"));
  EXPECT_THAT(pointers_of(with(place(), "/spec/view_space", 3)), testing::ElementsAre("/spec/view_space"));
  EXPECT_THAT(pointers_of(with(place(), "/arguments", {{"seconds", 3}})), testing::ElementsAre("/arguments/seconds"));
  EXPECT_THAT(pointers_of(with(place(), "/scene", {{"upload", "x"}, {"name", "y"}})), testing::ElementsAre("/scene"));
  EXPECT_THAT(pointers_of(with(place(), "/dry_run", 1)), testing::ElementsAre("/dry_run"));
}

TEST(JobRequest, AWorkOrderIsReadAsItWasWritten) {
  const JobRequest request = parse_job_request({{"kind", "bake"},
                                                {"scene", {{"name", "a.glb"}}},
                                                {"arguments", {{"view_cell", "box:0,0,0,1,1,1"}, {"views", 7}}},
                                                {"spec", {{"seed", 5}}}});
  const WorkOrder order = work_order_from_json(json::parse(to_json(WorkOrder{request.kind, request.spec, request.arguments, {}}).dump()));
  EXPECT_EQ(order.kind, JobKind::kBake);
  EXPECT_EQ(order.spec.seed, 5U);
  EXPECT_EQ(order.limits.data_bytes, WorkerLimits{}.data_bytes);
  CommandArguments arguments;
  apply_arguments(order.kind, order.arguments, arguments);
  EXPECT_EQ(arguments.view_cell, "box:0,0,0,1,1,1");
  EXPECT_EQ(arguments.quality_views, 7U);
}

TEST(WorkFolder, NamesOfClientsAreMadeHarmless) {
  EXPECT_EQ(harmless_name("../../etc/passwd", "x"), "passwd");
  EXPECT_EQ(harmless_name("C:\\scenes\\city.glb", "x"), "city.glb");
  EXPECT_EQ(harmless_name("..", "x"), "x");
  EXPECT_EQ(harmless_name(".hidden", "x"), "hidden");
  EXPECT_EQ(harmless_name("a\nb\x7f.glb", "x"), "ab.glb");
  EXPECT_EQ(harmless_name(std::string(500, 'a') + ".glb", "x").size(), 120U);
  EXPECT_TRUE(harmless_name(std::string(500, 'a') + ".glb", "x").ends_with(".glb"));
  EXPECT_EQ(harmless_name("", "x"), "x");
  EXPECT_EQ(harmless_name("a\xff"
                          "b.glb",
                          "x"),
            "a\uFFFD"
            "b.glb");
  EXPECT_NO_THROW((void)nlohmann::json(harmless_name(std::string(117, 'a') + "\u00e9\u00e9.glb", "x")).dump());
}

}  // namespace
}  // namespace standin
