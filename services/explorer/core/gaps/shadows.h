#pragma once

#include <cstdint>

#include "common/voxel/dense_grid.h"
#include "services/explorer/core/gaps/gap_tracker.h"

namespace thalweg::explorer {

/// A cell of the plane that a driving robot knows.
enum class PlaneCell : std::uint8_t {
  kWall,    ///< Ends lines of sight, and lies in no shadow; also what is unknown and nothing to go and see.
  kUnseen,  ///< Unknown, and to be seen: ends lines of sight, and may be hidden.
  kFree,    ///< Known to be free.
};

/// The ideal gap sensor, by cells: what the gaps in sight hide, each a shadow of its own.
///
/// In sight is a cell if the straight line from the robot's crosses nothing but free cells. The others that
/// are no walls are hidden, and their connected components are the shadows. Free cells are connected where
/// they have an edge in common; unseen ones also where they have a corner in common, since the rim of what
/// was seen runs across cells like stairs.
/// @param plane  A box of height 1 at z = 0.
/// @param least  Smaller shadows without an unseen cell are left out: they come from the cutting of walls
///               into cells.
/// @return       As GapTracker::Update takes it. O(cells that are no walls x length of a line of sight).
DenseGrid<int> FindShadows(const DenseGrid<PlaneCell>& plane, const VoxelIndex& robot, std::size_t least);

}  // namespace thalweg::explorer
