// A shared library opened on first use: linking libOSMesa or libEGL would cost every process start 20 ms and more, and would make a
// machine without one of them unable to start at all.
#pragma once

#include <string>

namespace standin {

class SharedLibrary {
 public:
  /// Throws Failure(kDeviceUnavailable) naming the file. Never unloaded: graphics drivers keep threads and thread-local state.
  explicit SharedLibrary(const char* file);
  /// Throws Failure(kDeviceUnavailable) naming the function.
  template <typename Function>
  [[nodiscard]] Function function(const char* name) const {
    return reinterpret_cast<Function>(symbol(name));
  }

 private:
  [[nodiscard]] void* symbol(const char* name) const;
  std::string file_;
  void* handle_ = nullptr;
};

}  // namespace standin
