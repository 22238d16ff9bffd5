#pragma once

#include <cstdint>

#if defined(__CUDACC__)
#include <vector_types.h>
#endif

/// What every body of a kernel needs. Bodies are written once: nvcc compiles them for the device, any other
/// compiler for the CPU, where the tests compare them with the solver of the CPU. nvcc 11 knows C++17, so
/// these headers keep to it.
#if defined(__CUDACC__)
#define THALWEG_PORTABLE __host__ __device__ inline
#else
#define THALWEG_PORTABLE inline
#endif

namespace thalweg::explorer::field::device {

/// Counts and numbers of cells, nodes and entries.
using Index = std::uint32_t;
constexpr Index kNoNode = 0xFFFFFFFFU;

/// Eight values side by side, which on a device are read and written 16 bytes at a time.
/// @param values  Aligned to the eight.
THALWEG_PORTABLE void LoadEight(const float* values, float out[8]) {
#if defined(__CUDA_ARCH__)
  const float4 low = reinterpret_cast<const float4*>(values)[0];
  const float4 high = reinterpret_cast<const float4*>(values)[1];
  out[0] = low.x, out[1] = low.y, out[2] = low.z, out[3] = low.w;
  out[4] = high.x, out[5] = high.y, out[6] = high.z, out[7] = high.w;
#else
  for (int k = 0; k < 8; ++k) out[k] = values[k];
#endif
}
THALWEG_PORTABLE void StoreEight(const float in[8], float* values) {
#if defined(__CUDA_ARCH__)
  reinterpret_cast<float4*>(values)[0] = make_float4(in[0], in[1], in[2], in[3]);
  reinterpret_cast<float4*>(values)[1] = make_float4(in[4], in[5], in[6], in[7]);
#else
  for (int k = 0; k < 8; ++k) values[k] = in[k];
#endif
}
THALWEG_PORTABLE void LoadEight(const std::uint8_t* values, std::uint8_t out[8]) {
#if defined(__CUDA_ARCH__)
  const uint2 packed = *reinterpret_cast<const uint2*>(values);
  for (int k = 0; k < 4; ++k) {
    out[k] = static_cast<std::uint8_t>(packed.x >> (8 * k));
    out[k + 4] = static_cast<std::uint8_t>(packed.y >> (8 * k));
  }
#else
  for (int k = 0; k < 8; ++k) out[k] = values[k];
#endif
}

}  // namespace thalweg::explorer::field::device
