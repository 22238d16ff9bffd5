#define THALWEG_STEREO_ISA baseline
#include "services/stereo/core/kernels_impl.h"
