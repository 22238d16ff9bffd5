#pragma once

/// Placed before a function, also compiles it for AVX2; the version is chosen at run time for the machine.
/// FMA is left out, so that both versions give bitwise equal results. Disabled under sanitizers, which do not
/// support function multiversioning.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define THALWEG_SIMD_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define THALWEG_SIMD_CLONES
#endif
