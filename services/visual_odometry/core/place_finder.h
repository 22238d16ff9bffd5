#pragma once

#include <optional>

#include "services/visual_odometry/core/landmark_tracker.h"
#include "services/visual_odometry/core/place_memory.h"
#include "services/visual_odometry/core/rotation_prediction.h"

namespace thalweg::visual_odometry {

/// A place recognized in a frame.
struct SeenPlace {
  const Place* place;
  LandmarkTracker::Result result;  ///< Relative to the place.

  RigidTransform T_OC() const { return place->pose.T_OC * result.pose.T_CK.inverse(); }
};

/// Recognizes places: either one that should be in view, or, for a camera whose pose is hardly known, any
/// that resembles its image.
///
/// Threading: stateless, may be used on any thread.
class PlaceFinder {
 public:
  struct Options {
    int least_inliers = 30;       ///< Smallest number of a place's points found again.
    double least_share = 0.5;     ///< Smallest share among those that should be visible.
    double most_sigma_px = 1.2;   ///< Largest residual of their common rigid motion.
    std::size_t most_tried = 10;  ///< Number of places tried per frame, the most similar first.
    /// No place is accepted if another agrees nearly as well but implies a different camera pose.
    /// Smallest share of points found again, relative to the best one's, for a rival.
    double rival_share = 0.7;
    /// [m] Poses that differ by less, or by what their sigmas explain, are the same,
    double same_position = 0.1;
    double same_turn = 0.1;  ///< [rad] likewise for orientation.
  };
  PlaceFinder(const LandmarkTracker& tracker, const PinholeCamera& camera, const Levels& levels,
              const Options& options)
      : tracker_(tracker),
        small_camera_(ScaledDown(camera, levels.small)),
        small_(levels.small),
        options_(options) {}

  /// A frame, and what is known before searching it.
  struct Sight {
    const Frame& frame;
    bool use_right;              ///< Whether the right image can be used.
    double sigma_px;             ///< Standard deviation of the measurements so far.
    const RigidTransform& T_OC;  ///< Current estimate of the camera's pose.
  };
  /// Searches the given place where it should appear.
  std::optional<SeenPlace> Look(const Place& place, const Sight& sight) const;

  /// A candidate for the camera's pose, with the share of points found again that supports it.
  struct Belief {
    RigidTransform T_OC;
    Matrix6d covariance;
    double share;
  };
  struct Found {
    std::optional<SeenPlace> seen;  ///< The best place; nothing if the best is `own` or nothing agrees.
    bool disputed = false;          ///< Whether a different candidate agrees nearly as well.
  };
  /// Tries the places within reach of the estimated camera pose and compares them with each other.
  /// @param own  Candidate obtained without places; may be null.
  Found Search(const PlaceMemory& places, const PlaceMemory::Reach& reach, const Sight& sight,
               const Belief* own) const;

 private:
  std::optional<SeenPlace> LookAround(const Place& place, const PlaceMemory::Reach& reach,
                                      const Sight& sight) const;
  bool Same(const Belief& a, const Belief& b) const;
  std::optional<SeenPlace> Agreeing(const Place& place, std::optional<LandmarkTracker::Result> result) const;

  LandmarkTracker tracker_;
  PinholeCamera small_camera_;
  int small_;  ///< Pyramid level of the small images.
  Options options_;
};

}  // namespace thalweg::visual_odometry
