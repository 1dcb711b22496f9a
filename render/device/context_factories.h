// The devices behind make_context, one source file each.
#pragma once

#include "render/device/context.h"

namespace standin {

[[nodiscard]] std::unique_ptr<Context> make_osmesa_context(int width, int height);
[[nodiscard]] std::unique_ptr<Context> make_egl_context();

/// glGetString of the current context.
[[nodiscard]] std::string gl_string(const Context& context, unsigned int name);

}  // namespace standin
