// TOML configuration files, through toml++ (the only file that includes it).
#include <toml++/toml.h>

#include <fstream>
#include <sstream>

#include "render/base/error.h"
#include "server/job/job_spec.h"

namespace standin {

void read_config(JobSpec& spec, const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw Failure(ErrorWord::kFileMissing, "configuration file " + file.string() + " cannot be read");
  toml::table table;
  try {
    table = toml::parse(stream, file.string());
  } catch (const toml::parse_error& error) {
    std::ostringstream sentence;
    sentence << file.string() << ":" << error.source().begin.line << ":" << error.source().begin.column << ": " << error.description();
    throw Failure(ErrorWord::kBadConfig, sentence.str());
  }
  std::ostringstream text;
  text << toml::json_formatter{table};
  read_object_into(spec, nlohmann::json::parse(text.str()), file.string() + ": ");
}

}  // namespace standin
