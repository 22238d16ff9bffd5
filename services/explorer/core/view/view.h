#pragma once

#include <vector>

#include "common/base/bit_table.h"
#include "common/geometry/robot_model.h"
#include "services/explorer/core/map/planning_map.h"

namespace thalweg::explorer {

/// A target voxel (frontier.h) that a sensor at some position could see.
struct Sighting {
  VoxelIndex voxel;
  Eigen::Vector3d offset_W;  ///< [m] From the sensor to the voxel's center.
};

/// The target voxels within `range` of a position and in clear line of sight, whatever the sensor's
/// orientation.
std::vector<Sighting> SightingsFrom(const PlanningMap& map, const Eigen::Vector3d& p_W, double range);

/// A voxel crossed by a ray from the center of voxel 0.
struct RayStep {
  VoxelIndex offset;
  double distance;  ///< [m] Between the centers of the two voxels.
};
/// Rays along SpreadDirections from the center of voxel 0, which itself is left out. Computed once and reused
/// for many voxels, because setting rays up costs more than following them.
std::vector<std::vector<RayStep>> SpreadRays(std::size_t count, double range, double voxel_size);

/// An orientation to look in, and what it shows.
struct View {
  Eigen::Matrix3d R_WB;
  std::size_t count = 0;     ///< Number of counted sightings in the image.
  std::size_t required = 0;  ///< Number of required ones among them.
};

/// Chooses the view that shows most among 16 headings and 7 elevations, 25 deg apart. A level robot has the
/// headings only, one with a gimbal elevations from its lowest to its highest, at most as far apart.
class ViewPlanner {
 public:
  ViewPlanner(const PinholeCamera& camera, const RobotModel& robot);

  const RobotModel& robot() const { return robot_; }
  const std::vector<Eigen::Matrix3d>& candidates() const { return candidates_; }  ///< R_WB
  /// R_WB of the candidates, or of fewer that leave out no direction: for a robot that turns freely, with a
  /// camera that is wide enough, every other heading and elevation.
  const std::vector<Eigen::Matrix3d>& sparse() const { return sparse_; }
  /// A row for each of sparse(): which of the offsets [m] from the sensor it shows.
  BitTable ShownBySparse(const std::vector<Eigen::Vector3d>& offsets_W) const;
  /// Whether some view shows what lies in that direction.
  bool CanShow(const Eigen::Vector3d& offset_W) const;

  /// Whether a camera at `eye_W`, in any of the views, could see a voxel's center: within `range` [m], inside
  /// the image, and in clear line of sight.
  bool CanSee(const PlanningMap& map, const Eigen::Vector3d& eye_W, const Eigen::Vector3d& center_W,
              double range) const {
    const Eigen::Vector3d offset_W = center_W - eye_W;
    return offset_W.norm() <= range && CanShow(offset_W) && map.InSight(eye_W, center_W);
  }

  /// What a sensor with one orientation has in its image.
  class Image {
   public:
    Image(const PinholeCamera& camera, const Eigen::Matrix3d& R_WC)
        : camera_(camera), R_CW_(R_WC.transpose()) {}
    /// @param offset_W  [m] From the sensor.
    bool Shows(const Eigen::Vector3d& offset_W) const { return camera_.Sees(R_CW_ * offset_W); }

   private:
    const PinholeCamera& camera_;
    Eigen::Matrix3d R_CW_;
  };
  /// Refers to the planner.
  Image ImageAt(const Eigen::Matrix3d& R_WB) const { return {camera_, R_WB * R_BC_}; }
  /// The direction of the sensor's optical axis, of unit length.
  Eigen::Vector3d AxisAt(const Eigen::Matrix3d& R_WB) const { return R_WB * R_BC_.col(2); }

  /// Whether a sensor with that orientation has the sighting in its image.
  bool Shows(const Eigen::Matrix3d& R_WB, const Sighting& sighting) const {
    return ImageAt(R_WB).Shows(sighting.offset_W);
  }

  /// The view with the most counted sightings among those that show the most required ones.
  /// @param counts    Whether each sighting counts.
  /// @param required  Whether each sighting is required. Empty = none is.
  /// @param R_WB      The present orientation; of equal views the one nearest to it is chosen.
  View Best(const std::vector<Sighting>& sightings, const std::vector<bool>& counts,
            const std::vector<bool>& required, const Eigen::Matrix3d& R_WB) const;

 private:
  /// As Image::Shows; most of what is outside the image is outside the cone around it, too.
  /// @param length  [m] Norm of the offset.
  bool InImage(const Eigen::Matrix3d& R_WC, const Eigen::Vector3d& offset_W, double length) const {
    return R_WC.col(2).dot(offset_W) >= least_cosine_ * length && Image(camera_, R_WC).Shows(offset_W);
  }

  PinholeCamera camera_;
  RobotModel robot_;
  Eigen::Matrix3d R_BC_;
  std::vector<Eigen::Matrix3d> candidates_;  ///< R_WB; the headings of the lowest elevation, of the next, ...
  std::vector<Eigen::Matrix3d> sparse_;
  std::vector<Eigen::Matrix3d> cameras_;         ///< R_WC of each candidate,
  std::vector<Eigen::Matrix3d> sparse_cameras_;  ///< and of each of sparse_.
  double least_cosine_;  ///< Between the optical axis and what is in the image, less what rounding may do.
};

}  // namespace thalweg::explorer
