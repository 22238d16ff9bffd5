#pragma once

#include <stdexcept>
#include <string>

#include "common/base/text.h"

namespace thalweg {

/// Throws std::invalid_argument unless an option is good.
/// @param what  Names the option, its value and what is allowed.
inline void Require(bool good, const std::string& what) {
  if (!good) throw std::invalid_argument(what);
}

/// The same, with the text "OPTION must be ALLOWED, is VALUE".
inline void Require(bool good, const char* option, double value, const char* allowed) {
  if (good) return;
  throw std::invalid_argument(std::string(option) + " must be " + allowed + ", is " + NumberText(value));
}

}  // namespace thalweg
