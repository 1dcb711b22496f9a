// Which code is running: so that no result of other code is ever taken for what this code would have made.
//
// The linker's build id is a hash of all that it wrote into a binary. We take the ids of the program and of every library that it started
// with (Embree, the C library ...), and the processor's instruction sets, by which such libraries choose among their variants. Whoever
// rebuilds after any change that reaches the binary, or updates a library, has another fingerprint, without having to think of it.
#pragma once

#include "render/base/fingerprint.h"

namespace standin {

/// The same for every run of the same binary with the same libraries on the same kind of processor.
[[nodiscard]] const Fingerprint& build_identity();

}  // namespace standin
