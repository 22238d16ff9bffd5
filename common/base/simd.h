#pragma once

/// Before a function: it is compiled for AVX2, too, and the machine it runs on decides. No FMA: results stay
/// the same to the last bit. Sanitizers do not live with such functions.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define THALWEG_SIMD_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define THALWEG_SIMD_CLONES
#endif
