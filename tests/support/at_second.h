#pragma once

#include "common/base/time.h"

namespace thalweg::test {

inline Time AtSecond(double second) {
  return Time{FromSeconds(second)};
}

}  // namespace thalweg::test
