#pragma once

#include <cstddef>
#include <map>

#include "services/explorer/core/map/look_memory.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// What the space that is known to be free ends at, in voxels beside a free one: surfaces, and what is
/// unknown. When nothing is left to go to the latter are few where all was seen, but for those that nobody
/// can look at, under and behind things. Where the sensor does not measure what there is, since its range is
/// too short or surfaces are too smooth, many were seen in vain, and to have set them aside does not mean
/// that all was explored.
struct OpenBorder {
  std::size_t surface = 0;                     ///< Occupied ones.
  std::map<AsideReason, std::size_t> unknown;  ///< By why they were set aside; kNone: too small to matter.

  std::size_t open() const;  ///< All unknown ones.
  double share() const;      ///< Of the border that is open, 0 to 1; 0 without a border.
  /// Of the border that was seen in vain: looked at or visited. Where more is open than surface it is all
  /// that is open, whatever the reasons: so little was found that nobody can tell what is hidden from what.
  double missed_share() const;
};

/// Within the bounds. O(voxels of the map's box).
OpenBorder FindOpenBorder(const PlanningMap& map, const DenseGrid<std::uint8_t>& set_aside);

}  // namespace thalweg::explorer
