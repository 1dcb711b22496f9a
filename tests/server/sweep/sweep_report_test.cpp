#include "server/report/sweep_report.h"

#include <gtest/gtest.h>

#include <regex>

#include "tests/server/sweep/points.h"

namespace standin {
namespace {

using nlohmann::json;

json data_of(const std::string& page) {
  const std::string open = "id=\"report-data\">";
  const std::size_t begin = page.find(open) + open.size();
  return json::parse(page.substr(begin, page.find("</script", begin) - begin));
}

TEST(SweepReport, CarriesTheNumbersAndAsksForNothingOutside) {
  const json sweep = test::sweep_json({test::point(10, 5000), test::point(16, 1200)});
  const std::string page = make_sweep_report(sweep);
  EXPECT_EQ(data_of(page), sweep);
  EXPECT_NE(page.find("buildSweepPage"), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=\"(https?:|//|[a-z]+\\.)")));
}

TEST(SweepReport, HostileNamesStayText) {
  json sweep = test::sweep_json({test::point(10, 5000)});
  sweep["scene"]["name"] = "</script><script>alert(1)</script>{{data}}";
  const std::string page = make_sweep_report(sweep);
  EXPECT_EQ(data_of(page), sweep);
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
}

}  // namespace
}  // namespace standin
