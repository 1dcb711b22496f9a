#include "server/report/report.h"

#include <gtest/gtest.h>

#include <regex>

namespace standin {
namespace {

using nlohmann::json;

/// What stands between <script ... id="report-data"> and the next "</script", as a browser cuts it.
std::string data_block(const std::string& page) {
  const std::string open = "id=\"report-data\">";
  const std::size_t begin = page.find(open) + open.size();
  return page.substr(begin, page.find("</script", begin) - begin);
}

json small_metrics() {
  return {{"budget_ms", 16.0},
          {"scene", {{"objects", 12}, {"triangles", 3456}}},
          {"cpv", {{"count", 9}, {"solved", 8}, {"unsolved", 1}}},
          {"verify", {{"frames", json::array({{{"before_ms", 31.25}, {"after_ms", 12.5}}})}}}};
}

json small_placement() {
  return {{"scene", {{"name", "tiny.glb"}, {"objects", json::array({{{"id", 0}, {"name", "oak"}}, {{"id", 1}, {"name", ""}}})}}},
          {"cells", json::array({{{"min", {0, 0, 0}}}})},
          {"impostors", json::array({{{"id", 0},
                                      {"technique", "layered"},
                                      {"objects", {1, 0}},
                                      {"layers", json::array({json::object(), json::object()})},
                                      {"texture_bytes", 1200},
                                      {"geometry_bytes", 80}}})}};
}

TEST(Report, CarriesTheNumbers) {
  const json data = json::parse(data_block(make_report(small_metrics(), small_placement(), {})));
  EXPECT_EQ(data["metrics"], small_metrics());
  EXPECT_EQ(data["job"]["scene_name"], "tiny.glb");
  ASSERT_EQ(data["impostors"].size(), 1U);
  const json& impostor = data["impostors"][0];
  EXPECT_EQ(impostor["label"], "object 1 and 1 more");
  EXPECT_EQ(impostor["layers"], 2);
  EXPECT_EQ(impostor["texture_bytes"], 1200);
  EXPECT_FALSE(data["job"].contains("cells"));
}

TEST(Report, EmbedsPictures) {
  const json data = json::parse(data_block(make_report(small_metrics(), nullptr, {{"atlas-0", "page 0", "foobar"}})));
  ASSERT_EQ(data["pictures"].size(), 1U);
  EXPECT_EQ(data["pictures"][0]["src"], "data:image/png;base64,Zm9vYmFy");
  EXPECT_TRUE(data["impostors"].empty());
}

TEST(Report, HostileNamesStayText) {
  const std::vector<std::string> names = {"</script><script>alert(1)</script>", "<!--<script>", "{{data}}{{script}}", "\" onload=\"x",
                                          "\\u003c/script>"};
  for (const auto& name : names) {
    json placement = small_placement();
    placement["scene"]["name"] = name;
    placement["scene"]["objects"][1]["name"] = name;
    const std::string page = make_report(small_metrics(), placement, {{"view-0/original", name, "x"}});
    const std::string block = data_block(page);
    EXPECT_EQ(block.find('<'), std::string::npos) << name;
    const json data = json::parse(block);
    EXPECT_EQ(data["job"]["scene_name"], name);
    EXPECT_EQ(data["pictures"][0]["caption"], name);
    EXPECT_EQ(page.find("<script>alert"), std::string::npos) << name;
  }
}

TEST(Report, BytesThatAreNotUtf8AreReplaced) {
  json placement = small_placement();
  placement["scene"]["name"] = "caf\xE9";
  EXPECT_EQ(json::parse(data_block(make_report(small_metrics(), placement, {})))["job"]["scene_name"], "caf\xEF\xBF\xBD");
}

TEST(Report, AsksForNothingOutside) {
  const std::string page = make_report(small_metrics(), small_placement(), {});
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=\"(https?:|//|[a-z]+\\.)")));
  EXPECT_EQ(page.find("@import"), std::string::npos);
  EXPECT_EQ(page.find("{{"), page.find("{{", page.find("report-data")));  // every place of the template is filled
}

TEST(Report, SameInputSameBytes) {
  EXPECT_EQ(make_report(small_metrics(), small_placement(), {}), make_report(small_metrics(), small_placement(), {}));
}

TEST(Report, NothingKnownIsAPageToo) {
  EXPECT_NE(make_report(json::object(), nullptr, {}).find("</html>"), std::string::npos);
}

}  // namespace
}  // namespace standin
