#pragma once

#include <vector>

#include "common/geometry/robot_model.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// A target voxel (frontier.h) that a sensor at some place could see.
struct Sighting {
  VoxelIndex voxel;
  Eigen::Vector3d offset_W;  ///< [m] from the sensor to the voxel's centre
};

/// The target voxels within `range` of a place and in plain sight from it, whatever the sensor's
/// direction.
std::vector<Sighting> SightingsFrom(const PlanningMap& map, const Eigen::Vector3d& p_W, double range);

/// Evenly spread unit vectors [Fibonacci lattice on the sphere].
std::vector<Eigen::Vector3d> SpreadDirections(std::size_t count);

/// A voxel that a ray from the centre of voxel 0 crosses.
struct RayStep {
  VoxelIndex offset;
  double distance;  ///< [m] between the centres of the two
};
/// Rays in SpreadDirections from the centre of voxel 0, which itself is left out: as many rays go out from so
/// many voxels that setting them up costs more than following them.
std::vector<std::vector<RayStep>> SpreadRays(std::size_t count, double range, double voxel_size);

/// A direction to look in, and what it shows.
struct View {
  Eigen::Matrix3d R_WB;
  std::size_t count = 0;     ///< Sightings in the image that were counted.
  std::size_t required = 0;  ///< Of these, the required ones.
};

/// Chooses among 16 headings and 7 elevations, 25 deg apart, the one that shows most; a level robot has only
/// the headings.
class ViewPlanner {
 public:
  ViewPlanner(const PinholeCamera& camera, const Eigen::Matrix3d& R_BC, bool level = false);

  const std::vector<Eigen::Matrix3d>& candidates() const { return candidates_; }  ///< R_WB
  /// Whether some view shows what lies in that direction.
  bool CanShow(const Eigen::Vector3d& offset_W) const;

  /// Whether a camera at `eye_W` could have a voxel's center in view, turned as it may be: within `range`
  /// [m], in the image of some view, and in plain sight.
  bool CanSee(const PlanningMap& map, const Eigen::Vector3d& eye_W, const Eigen::Vector3d& center_W,
              double range) const {
    const Eigen::Vector3d offset_W = center_W - eye_W;
    return offset_W.norm() <= range && CanShow(offset_W) && map.InSight(eye_W, center_W);
  }

  /// Whether a sensor with that orientation has the sighting in its image.
  bool Shows(const Eigen::Matrix3d& R_WB, const Sighting& sighting) const {
    return camera_.Sees((R_WB * R_BC_).transpose() * sighting.offset_W);
  }

  /// The view with most counted sightings among those that show as many required ones as any view does.
  /// @param counts    Of each sighting: whether it counts.
  /// @param required  Of each sighting: whether the view is there for it. Empty = none is.
  /// @param R_WB      The present orientation: of equal views the one nearest to it is taken.
  View Best(const std::vector<Sighting>& sightings, const std::vector<bool>& counts,
            const std::vector<bool>& required, const Eigen::Matrix3d& R_WB) const;

 private:
  PinholeCamera camera_;
  Eigen::Matrix3d R_BC_;
  bool level_;
  std::vector<Eigen::Matrix3d> candidates_;  ///< R_WB
};

}  // namespace thalweg::explorer
