#pragma once

#include <cstddef>
#include <map>

#include "services/explorer/core/map/look_memory.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// The border of known free space, in voxels: occupied voxels and unknown voxels with a free neighbor.
///
/// When there is nothing left to go to and everything was seen, few border voxels are unknown: only those
/// that no view reaches, such as under and behind things. Where the sensor does not measure what is there,
/// because its range is too short or surfaces have too little texture, many voxels were looked at in vain,
/// and setting them aside does not mean that everything was explored.
struct OpenBorder {
  std::size_t surface = 0;  ///< Number of occupied voxels.
  /// Number of unknown voxels by why they were set aside; kNone: too small to matter, or
  /// a frontier that the strategy found not worth the path.
  std::map<AsideReason, std::size_t> unknown;
  /// Those of kOutOfSight that only other unknown space hides, into which the robot looked in vain; see
  /// CandidateSearch::FindHidden. FindOpenBorder leaves it 0.
  std::size_t hidden = 0;

  std::size_t open() const;  ///< Number of all unknown voxels.
  double share() const;      ///< open() as a share of the border, 0 to 1; 0 without a border.
  /// Share of the border that was looked at or visited in vain, to which the robot did not get, or that is
  /// hidden by that. When more of the border is open than surface, all of the open part counts, whatever the
  /// reasons: with so little found, nobody can tell what hides what.
  double missed_share() const;
};

/// Only voxels within the bounds count. O(voxels of the map's box).
OpenBorder FindOpenBorder(const PlanningMap& map, const DenseGrid<std::uint8_t>& set_aside);

}  // namespace thalweg::explorer
