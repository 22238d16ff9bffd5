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
/// queue [Dial: Algorithm 360, CACM 12(11), 1969], O(voxels); FindPath() is A* with the octile distance.
/// Both find paths of the same cost.
/// Threading: one thread owns a search.
class PathSearch {
 public:
  static constexpr std::uint32_t kUnreached = std::numeric_limits<std::uint32_t>::max();

  /// A traversable voxel to which the robot can go straight, and the cost of getting there.
  struct Entry {
    VoxelIndex voxel;
    std::uint32_t cost = 0;
  };
  using Start = std::vector<Entry>;

  /// The voxel in which the robot stands, when that is traversable. A robot that stands too near to something
  /// may leave in a straight line for any traversable voxel within the exemption's reach, as long as it comes
  /// no nearer to an occupied voxel than min(radius, its present distance) and crosses nothing unknown; on a
  /// plane its camera crosses nothing unknown.
  struct Exemption {
    double reach = 0.3;        ///< [m]
    bool from_pocket = false;  ///< Also from where it could go on, because that leads nowhere; the body then
                               ///< must not touch anything unknown either.
  };
  static Start StartAt(const PlanningMap& map, const Eigen::Vector3d& p_W, double radius,
                       const Exemption& exemption);
  /// The same in parts that are not connected, first the one from which the most can be reached: in the
  /// others a robot that was let out of a tight place would be shut in again.
  static std::vector<Start> Parts(const PlanningMap& map, const Start& start);

  /// Costs from the start to all that can be reached from it.
  /// @param wanted  Voxels of the map's box: the search may end once it has their costs, and the costs of
  ///                others are then unreliable. Empty = all.
  void Flood(const PlanningMap& map, const Start& start, std::span<const VoxelIndex> wanted = {});

  const DenseGrid<std::uint32_t>& costs() const { return costs_; }  ///< Over the map's box.
  std::uint32_t Cost(const VoxelIndex& i) const { return costs_.Get(i, kUnreached); }
  bool Reached(const VoxelIndex& i) const { return Cost(i) != kUnreached; }
  double Length(const VoxelIndex& i) const { return Cost(i) * 0.01 * voxel_size_; }  ///< [m]
  std::size_t reached_count() const { return reached_; }
  const Start& start() const { return start_; }
  /// The flood's shortest path from an entry to a reached voxel, both included.
  std::vector<VoxelIndex> PathTo(const VoxelIndex& goal) const;

  /// A shortest path for one goal alone; nothing when there is none. `cost`, when given, gets its cost.
  static std::optional<std::vector<VoxelIndex>> FindPath(const PlanningMap& map, const Start& start,
                                                         const VoxelIndex& goal,
                                                         std::uint32_t* cost = nullptr);

 private:
  static constexpr std::size_t kBuckets = 256;  ///< More than the dearest step.
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

/// Pulls a path straight: leaves out every point that can be, the segments that remain keeping `clearance`
/// from occupied and unknown voxels wherever the path itself did. First and last point stay.
std::vector<Eigen::Vector3d> PullStraight(const PlanningMap& map, const std::vector<Eigen::Vector3d>& path_W,
                                          double clearance);

/// The same, but where the path keeps more than `clearance`, up to `comfort`, the segments that replace it
/// do, too.
std::vector<Eigen::Vector3d> PullStraightWithin(const PlanningMap& map,
                                                const std::vector<Eigen::Vector3d>& path_W, double clearance,
                                                double comfort);

}  // namespace thalweg::explorer
