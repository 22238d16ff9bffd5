#pragma once

namespace thalweg::internal {
[[noreturn]] void CheckFailed(const char* condition, const char* file, int line);
}

/// Aborts, in release builds too, when our own code violates an invariant. Never use it on outside input.
#define THALWEG_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::thalweg::internal::CheckFailed(#condition, __FILE__, __LINE__))
