#include "server/job/job_files.h"

#include "render/base/sha256.h"
#include "render/base/staged_file.h"

namespace standin {

using nlohmann::json;

std::string fingerprint(const char* kind, const JobFiles& files, const JobSpec& spec, const json& more) {
  json named = {{"kind", kind},
                {"scene", sha256_hex(read_file(files.scene))},
                {"target", sha256_hex(read_file(files.target))},
                {"spec", to_json(spec, true)}};
  named.update(more);
  return named.dump();
}

std::string inputs_json(const JobFiles& files) {
  return json({{"scene", std::filesystem::absolute(files.scene).string()}, {"target", std::filesystem::absolute(files.target).string()}})
      .dump();
}

}  // namespace standin
