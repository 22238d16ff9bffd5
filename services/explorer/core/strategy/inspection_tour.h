#pragma once

#include <optional>
#include <vector>

#include "services/explorer/core/path/path_search.h"
#include "services/explorer/core/view/inspection.h"

namespace thalweg::explorer {

/// Plans a tour over the fewest and nearest places from which all open surface is inspected, and the place
/// where a frontier is seen; the robot takes its first stop, and plans again.
///
/// A covering tour, as that of Cover (CoverTourSearch): its items are patches of surface, the open facets of
/// one side in a cube of 0.4 m, each for as much as it has; its stops are PlacesToLook, any number of views
/// from each, since turning costs no path. What is not worth its path is left out. The tour should be short
/// and inspect early what is much, as far as the eagerness goes; a frontier counts as much as half a meter of
/// path for each meter that it is seen later. What can be inspected from where the robot stands comes first.
///
/// A stop is taken to inspect a patch if it can inspect the facet in its middle. The previous tour is the
/// first guess, and is kept unless another is clearly better. The same calls give the same views. Threading:
/// one thread owns it.
class InspectionTour {
 public:
  /// Throws std::invalid_argument naming the invalid option.
  explicit InspectionTour(const InspectionOptions& options);

  /// @param views     This moment's.
  /// @param search    Flooded from the robot.
  /// @param T_WB      The robot's pose.
  /// @param frontier  Where the robot would go to see a frontier, if there is one.
  /// @return The view to take next; nothing when the frontier comes first, or nothing is worth its path.
  std::optional<InspectionView> Next(const InspectionViews& views, const PathSearch& search,
                                     const RigidTransform& T_WB, const std::optional<VoxelIndex>& frontier);

 private:
  InspectionOptions options_;
  std::vector<Eigen::Vector3d> formers_W_;  ///< [m] Stops of the previous tour.
};

}  // namespace thalweg::explorer
