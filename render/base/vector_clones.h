// Inner loops over rows of numbers, compiled once for each generation of processors and chosen when the program starts.
//
// The program runs on every x86-64 of the last fifteen years (CMakeLists.txt), whose registers hold two numbers; today's hold four or
// eight. A function so marked is compiled for each. Its results do not depend on which of them runs: no operation is contracted
// (-ffp-contract=off) or reordered, so sums over a row must be kept per lane and added up in order.
#pragma once

#include <cstdlib>  // __GLIBC__

// GCC on Linux alone. Under a sanitizer the choice would run before its runtime is ready.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && __GNUC__ >= 12 && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define STANDIN_VECTOR_CLONES __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define STANDIN_VECTOR_CLONES
#endif
