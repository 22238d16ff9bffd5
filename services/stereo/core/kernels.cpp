#include "services/stereo/core/kernels.h"

namespace thalweg::stereo {

namespace baseline {
extern const Kernels kKernels;
}
#ifdef THALWEG_STEREO_AVX2
namespace avx2 {
extern const Kernels kKernels;
}
#endif

const Kernels& BestKernels() {
#ifdef THALWEG_STEREO_AVX2
  static const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt");
  if (has_avx2) return avx2::kKernels;
#endif
  return baseline::kKernels;
}

const Kernels& BaselineKernels() {
  return baseline::kKernels;
}

}  // namespace thalweg::stereo
