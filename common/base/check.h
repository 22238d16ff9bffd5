#pragma once

namespace thalweg::internal {
[[noreturn]] void CheckFailed(const char* condition, const char* file, int line);
}

/// Aborts, in release too, when our own code broke its promise. Never for input from outside.
#define THALWEG_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::thalweg::internal::CheckFailed(#condition, __FILE__, __LINE__))
