// One row per error word: its stable name, the exit code of the command line and the HTTP status of the service.
#pragma once

#include <string_view>

#include "render/base/error.h"

namespace standin {

struct ErrorRow {
  ErrorWord word;
  std::string_view name;  // stable; scripts and tests rely on it
  int exit_code;          // 2: bad usage or input; 3: internal or environment failure
  int http_status;
};

[[nodiscard]] const ErrorRow& error_row(ErrorWord word);
/// The word of that name; kInternal for names of other versions.
[[nodiscard]] ErrorWord word_named(std::string_view name);

}  // namespace standin
