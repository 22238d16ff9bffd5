#define THALWEG_STEREO_ISA avx2
#include "services/stereo/core/kernels_impl.h"
