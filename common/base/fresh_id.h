#pragma once

#include <cstdint>

namespace thalweg {

/// 64 bits from the system's source of randomness: differs for each call of all processes.
std::uint64_t FreshId();

}  // namespace thalweg
