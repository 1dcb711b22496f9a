#include "server/report/page.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "embedded_page.h"

namespace standin {
namespace {

using nlohmann::json;

/// JSON inside a script element: no "<" may appear, or "</script>" and "<!--" in a name would end or change it. Bytes that are not UTF-8
/// become U+FFFD.
std::string script_safe(const json& data) {
  std::string safe;
  for (const char c : data.dump(-1, ' ', false, json::error_handler_t::replace)) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

std::string one_script(std::span<const std::string_view> parts) {
  std::string script = "\"use strict\";\n(() => {\n";
  for (const auto part : parts) script.append(part).append("\n");
  return script + "})();\n";
}

/// One pass over the template, so that text which is filled in is never searched for places to fill.
std::string fill_template(std::string_view page, const std::vector<std::pair<std::string_view, std::string>>& values) {
  std::string result;
  while (true) {
    const std::size_t open = page.find("{{");
    result.append(page.substr(0, open));
    if (open == std::string_view::npos) return result;
    const std::size_t close = page.find("}}", open);
    const std::string_view name = page.substr(open + 2, close - open - 2);
    result += std::find_if(values.begin(), values.end(), [&](const auto& value) { return value.first == name; })->second;
    page.remove_prefix(close + 2);
  }
}

}  // namespace

std::string make_page(std::span<const std::string_view> scripts, const json& data) {
  return fill_template(embedded::template_html, {{"chart_css", std::string(embedded::chart_css)},
                                                 {"style_css", std::string(embedded::style_css)},
                                                 {"chart_js", std::string(embedded::chart_js)},
                                                 {"script", one_script(scripts)},
                                                 {"data", script_safe(data)}});
}

}  // namespace standin
