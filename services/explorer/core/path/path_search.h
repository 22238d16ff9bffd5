#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// Shortest paths over the traversable voxels of a planning map, 26-connected.
///
/// Steps cost 100, 141 and 173 hundredths of a voxel. Flood() is Dijkstra's algorithm with a circular bucket
/// queue [Dial: Algorithm 360, CACM 12(11), 1969], O(voxels); FindPath() is A* with the octile distance. Both
/// find paths of the same cost.
/// Threading: one thread owns a search.
class PathSearch {
 public:
  static constexpr std::uint32_t kUnreached = std::numeric_limits<std::uint32_t>::max();

  /// A traversable voxel that the robot can reach in a straight line, and the cost of getting there.
  struct Entry {
    VoxelIndex voxel;
    std::uint32_t cost = 0;
  };
  using Start = std::vector<Entry>;

  /// How far a robot may move straight through voxels that are not traversable, because it stands too near to
  /// an obstacle.
  struct Exemption {
    double reach = 0.3;  ///< [m]
    /// Allows this even from a traversable position, because that leads nowhere; the body must then not touch
    /// unknown space either.
    bool from_pocket = false;
  };
  /// The voxel in which the robot stands, if that is traversable. Otherwise, every traversable voxel within
  /// the exemption's reach to which the robot can move in a straight line, while its body touches no occupied
  /// voxel that it does not touch now, comes no nearer to those that it does than it is to the nearest
  /// (PlanningMap::ClearToLeave), and crosses no unknown voxel; on a plane, its camera's line of sight
  /// crosses none. A controller that checks paths for what the body newly touches therefore has no objection.
  static Start StartAt(const PlanningMap& map, const Eigen::Vector3d& p_W, double radius,
                       const Exemption& exemption);
  /// Splits a start into parts that are not connected, ordered by how much can be reached from them, most
  /// first. In the smaller ones, a robot that was let out of a tight place would be shut in again.
  static std::vector<Start> Parts(const PlanningMap& map, const Start& start);

  /// Computes the costs from the start to everything that can be reached from it.
  /// @param wanted  Voxels in the map's box: the search may end once it knows their costs, and the costs of
  /// other voxels are then unreliable. Empty = all.
  void Flood(const PlanningMap& map, const Start& start, std::span<const VoxelIndex> wanted = {});

  const DenseGrid<std::uint32_t>& costs() const { return costs_; }  ///< Over the map's box.
  std::uint32_t Cost(const VoxelIndex& i) const { return costs_.Get(i, kUnreached); }
  bool Reached(const VoxelIndex& i) const { return Cost(i) != kUnreached; }
  double Length(const VoxelIndex& i) const { return Cost(i) * 0.01 * voxel_size_; }  ///< [m]
  std::size_t reached_count() const { return reached_; }
  const Start& start() const { return start_; }
  /// The flood's shortest path from an entry to a reached voxel, including both.
  std::vector<VoxelIndex> PathTo(const VoxelIndex& goal) const;
  /// The same as points [m]: from `p_W`, where the flood began, through the centers of the path's voxels.
  std::vector<Eigen::Vector3d> PathFrom(const PlanningMap& map, const Eigen::Vector3d& p_W,
                                        const VoxelIndex& goal) const;

  /// Finds a shortest path to a single goal; empty when there is none. If `cost` is given, it receives the
  /// path's cost.
  static std::optional<std::vector<VoxelIndex>> FindPath(const PlanningMap& map, const Start& start,
                                                         const VoxelIndex& goal,
                                                         std::uint32_t* cost = nullptr);

 private:
  static constexpr std::size_t kBuckets = 256;  ///< More than the most expensive step.
  struct Step {
    std::uint32_t to;  ///< Offset of a voxel,
    std::uint32_t by;  ///< and the step to it; 26 = it is an entry.
  };

  DenseGrid<std::uint32_t> costs_;
  std::array<std::vector<Step>, kBuckets> buckets_;  ///< Empty between floods.
  Start start_;
  double voxel_size_ = 0.0;
  std::size_t reached_ = 0;
};

/// Straightens a path: removes every point that can be removed such that the remaining segments keep
/// `clearance` from occupied and unknown voxels wherever the path itself did. The first and last point stay.
std::vector<Eigen::Vector3d> PullStraight(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W,
                                          double clearance);

/// As PullStraight, but where the path keeps more than `clearance`, the new segments keep as much as it does,
/// up to `comfort`.
std::vector<Eigen::Vector3d> PullStraightWithin(const PlanningMap& map,
                                                const std::vector<Eigen::Vector3d>& path_W, double clearance,
                                                double comfort);

}  // namespace thalweg::explorer
