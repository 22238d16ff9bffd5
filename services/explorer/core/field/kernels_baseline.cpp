#define THALWEG_FIELD_ISA baseline
#include "services/explorer/core/field/kernels_impl.h"
