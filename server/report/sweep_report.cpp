#include "server/report/sweep_report.h"

#include <array>

#include "embedded_page.h"
#include "server/report/page.h"

namespace standin {

std::string make_sweep_report(const nlohmann::json& sweep) {
  constexpr std::array kScripts = {embedded::text_js, embedded::charts_js, embedded::sections_js, embedded::sweep_js};
  return make_page(kScripts, sweep);
}

}  // namespace standin
