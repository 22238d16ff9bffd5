#define THALWEG_FIELD_ISA avx2
#include "services/explorer/core/field/kernels_impl.h"
