#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "common/base/time.h"
#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/map/frontier.h"
#include "services/explorer/core/path/path_search.h"
#include "services/explorer/core/view/goal_finder.h"

namespace thalweg::explorer {

/// How long a robot that watches such a way looks before it decides again.
inline constexpr Duration kBetweenLooksAtShutWay = std::chrono::seconds(1);

/// Finds ways that were open and are shut now, such as a door that somebody has closed: space that the robot
/// could once reach, which is still free, but no longer connected with it. In a world that does not change
/// there is none, apart from what a noisy sensor took for a gap.
/// Threading: one thread owns it.
class ShutWays {
 public:
  struct Options {
    FrontierOptions frontier;
    double look_range;  ///< [m]
    double voxel_size;  ///< [m]
    Duration patience;  ///< The robot watches a way for so long before it gives up; 0 = none is found.
  };
  explicit ShutWays(const Options& options);

  /// A way that is shut.
  struct Way {
    VoxelIndex bar;        ///< An occupied voxel in the way, nearest to where the robot can get.
    std::size_t unknowns;  ///< Frontier voxels that could be seen if it were open.
  };

  void Clear();
  /// Remembers what the robot can reach now. O(voxels of the map's box).
  /// @param search  Flooded from the robot.
  void Note(const PathSearch& search);
  /// The ways behind which something is left to see that no reachable place sees, nearest to the robot first.
  /// O(voxels of the map's box), for each piece of space that is cut off.
  std::vector<Way> Find(const Knowledge& knowledge, const PathSearch& search) const;

  /// Whether a way is to be watched, or goes on being watched; not one that was watched in vain.
  bool MayWatch(const Way& way) const;
  /// The robot watches a way from near. A way that it has watched for too long is given up.
  void Watch(const Way& way, Time now);
  void GiveUp(const Way& way);
  /// A robot that was on its way to watch did not get there: after the second time the way is given up.
  void DidNotGetTo(const VoxelIndex& bar);
  void ShiftTimes(Duration back);

 private:
  /// Whether one of the bars is of the same way.
  bool Holds(const std::vector<VoxelIndex>& bars, const VoxelIndex& of) const;

  Options options_;
  GoalFinder goal_finder_;
  DenseGrid<std::uint8_t> reached_;  ///< Nonzero where the robot could once get.
  struct Watched {
    VoxelIndex bar;
    Time since;
  };
  std::optional<Watched> watched_;
  std::vector<VoxelIndex> not_got_to_;
  std::vector<VoxelIndex> given_up_;
};

}  // namespace thalweg::explorer
