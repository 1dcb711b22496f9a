#include "render/device/shared_library.h"

#include <dlfcn.h>

#include "render/base/error.h"

namespace standin {

SharedLibrary::SharedLibrary(const char* file) : file_(file), handle_(dlopen(file, RTLD_NOW | RTLD_LOCAL)) {
  if (handle_ == nullptr) throw Failure(ErrorWord::kDeviceUnavailable, "cannot load " + file_ + ": " + dlerror());
}

void* SharedLibrary::symbol(const char* name) const {
  void* address = dlsym(handle_, name);
  if (address == nullptr) throw Failure(ErrorWord::kDeviceUnavailable, file_ + " has no function " + name);
  return address;
}

}  // namespace standin
