// The command line's grammar, made from the rows of spec_fields() (CLI11; nothing else includes it).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/command_line/commands.h"

namespace standin {

struct ParsedCommand {
  std::function<int(const CommandContext&)> run;  // empty: nothing to run (help or version was printed)
  CommandContext context;
  bool quiet = false;
  int exit_code = 0;  // where there is nothing to run
};

/// Prints help, version and --print-config itself. Throws Failure(kBadUsage, kBadConfig).
[[nodiscard]] ParsedCommand parse_command_line(int argc, char** argv);

}  // namespace standin
