#pragma once

#include <array>
#include <cstdint>

namespace thalweg::explorer {

/// Costs of a step between neighbors that differ along 0, 1, 2 or 3 axes: lengths in hundredths of an edge.
inline constexpr std::array<std::uint32_t, 4> kStepCost = {0, 100, 141, 173};

}  // namespace thalweg::explorer
