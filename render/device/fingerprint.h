// What a target file says about the machine beside GL_RENDERER and GL_VERSION: another processor model is a warning, not an error.
#pragma once

#include <string>

namespace standin {

/// Model name from /proc/cpuinfo; the instruction set's name where that has none; never empty.
[[nodiscard]] std::string processor_name();

}  // namespace standin
