// A self-contained page: the template with styles, the chart library, scripts and data filled in (report.h says what such a page is).
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

namespace standin {

/// `scripts` run one after the other in one scope; they find `data` under the id report-data. Text in `data` may hold anything.
[[nodiscard]] std::string make_page(std::span<const std::string_view> scripts, const nlohmann::json& data);

}  // namespace standin
