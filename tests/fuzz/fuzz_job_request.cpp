// What a job is described by: a body of POST /v1/jobs (JSON), or a configuration file (TOML), whichever the input looks like.
#include <nlohmann/json.hpp>

#include "server/job/job_spec.h"
#include "server/service/job_request.h"
#include "server/service/work_folder.h"
#include "tests/fuzz/input_file.h"
#include "tests/fuzz/mutation.h"

namespace standin::fuzz {
namespace {

using nlohmann::json;

// What was taken must come back the same: a worker reads it from a file.
void follow(const JobRequest& request) {
  CommandArguments arguments;
  apply_arguments(request.kind, request.arguments, arguments);
  require(to_json(spec_from_json(to_json(request.spec, false)), false) == to_json(request.spec, false), "settings survive being written");
  const WorkOrder order{request.kind, request.spec, request.arguments, {}};
  const json written = json::parse(to_json(order).dump(-1, ' ', false, json::error_handler_t::replace));
  require(to_json(work_order_from_json(written)) == to_json(order), "an order survives being written");
}

void read_body(std::string_view text) {
  const json body = json::parse(text, nullptr, false);
  if (body.is_discarded()) return;
  JobRequest request;
  if (read_or_refused([&] { request = parse_job_request(body); })) follow(request);
}

void read_toml(std::string_view text) {
  const auto file = input_folder().write("job.toml", text);
  JobSpec spec;
  if (!read_or_refused([&] { read_config(spec, file); })) return;
  (void)techniques_of(spec);
  require(to_json(spec_from_json(to_json(spec, false)), false) == to_json(spec, false), "settings survive being written");
}

}  // namespace
}  // namespace standin::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace standin::fuzz;
  const std::string_view text = view_of(data, size);
  if (text.starts_with('{'))
    read_body(text);
  else
    read_toml(text);
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most_bytes, unsigned seed) {
  return standin::fuzz::mutate({data, size, most_bytes}, seed, standin::fuzz::mutated_json);
}
