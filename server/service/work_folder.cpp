#include "server/service/work_folder.h"

#include <algorithm>
#include <array>

#include "render/base/error.h"

namespace standin {

namespace fs = std::filesystem;
using nlohmann::json;

json to_json(const WorkOrder& order) {
  return {{"kind", kind_name(order.kind)},
          {"spec", to_json(order.spec, false)},
          {"arguments", order.arguments},
          {"limits", to_json(order.limits)}};
}

WorkOrder work_order_from_json(const json& object) {
  WorkOrder order;
  const std::string kind = object.at("kind");
  while (kind_name(order.kind) != kind) order.kind = static_cast<JobKind>(static_cast<int>(order.kind) + 1);
  order.spec = spec_from_json(object.at("spec"));
  order.arguments = object.at("arguments");
  order.limits = worker_limits_from_json(object.at("limits"));
  return order;
}

fs::path input_file(const fs::path& folder, const std::string& role) {
  const fs::path place = folder / "inputs" / role;
  if (!fs::is_directory(place)) return {};
  for (const auto& entry : fs::directory_iterator(place)) return entry.path();
  return {};
}

std::string harmless_name(const std::string& name, const std::string& otherwise) {
  constexpr std::size_t kMostBytes = 120;
  std::string result = name.substr(name.find_last_of("/\\") + 1);
  std::erase_if(result, [](unsigned char c) { return c < 32 || c == 127; });
  result = json::parse(json(result).dump(-1, ' ', false, json::error_handler_t::replace));  // as UTF-8
  while (result.starts_with('.')) result.erase(0, 1);
  if (result.size() > kMostBytes) result.erase(0, result.size() - kMostBytes);
  while (!result.empty() && (static_cast<unsigned char>(result.front()) & 0xC0) == 0x80) result.erase(0, 1);  // the rest of a cut character
  return result.empty() ? otherwise : result;
}

}  // namespace standin
