#pragma once

#include <optional>

#include "services/visual_odometry/core/landmark_tracker.h"
#include "services/visual_odometry/core/place_memory.h"
#include "services/visual_odometry/core/rotation_prediction.h"

namespace thalweg::visual_odometry {

/// A place that a frame shows again.
struct SeenPlace {
  const Place* place;
  LandmarkTracker::Result result;  ///< Against the place.

  RigidTransform T_OC() const { return place->pose.T_OC * result.pose.T_CK.inverse(); }
};

/// Finds places again: one that should be in sight, or, by a camera that hardly knows where it is, any that
/// looks like what it sees. Threading: const, so any.
class PlaceFinder {
 public:
  struct Options {
    int least_inliers = 30;       ///< Points of a place found again, at least,
    double least_share = 0.5;     ///< and of those that should be visible,
    double most_sigma_px = 1.2;   ///< which move as one.
    std::size_t most_tried = 10;  ///< Places in a frame, the most alike.
    /// None is believed when another one agrees nearly as well and would have the camera elsewhere.
    double rival_share = 0.7;  ///< Of the points found again, compared with the best one's.
    double same_way = 0.1;     ///< [m] Poses that differ by less, or by what their sigmas explain,
    double same_turn = 0.1;    ///< [rad] are the same.
  };
  PlaceFinder(const LandmarkTracker& tracker, const PinholeCamera& camera, const Levels& levels,
              const Options& options)
      : tracker_(tracker),
        small_camera_(ScaledDown(camera, levels.small)),
        small_(levels.small),
        options_(options) {}

  /// A frame, and what is known without it.
  struct Sight {
    const Frame& frame;
    bool use_right;              ///< Whether the right image shows anything.
    double sigma_px;             ///< Of the measurements so far.
    const RigidTransform& T_OC;  ///< Where the camera is believed to be.
  };
  /// That place, where it should be.
  std::optional<SeenPlace> Look(const Place& place, const Sight& sight) const;

  /// What the camera's pose may be, and the share of points found again that speaks for it.
  struct Belief {
    RigidTransform T_OC;
    Matrix6d covariance;
    double share;
  };
  struct Found {
    std::optional<SeenPlace> seen;  ///< What agrees best; nothing when that is `own`, or nothing does.
    bool disputed = false;          ///< Something else agrees nearly as well.
  };
  /// The places within that reach of where the camera is believed to be, compared with each other.
  /// @param own  What it would be without them; may be null.
  Found Search(const PlaceMemory& places, const PlaceMemory::Reach& reach, const Sight& sight,
               const Belief* own) const;

 private:
  std::optional<SeenPlace> LookAround(const Place& place, const PlaceMemory::Reach& reach,
                                      const Sight& sight) const;
  bool Same(const Belief& a, const Belief& b) const;
  std::optional<SeenPlace> Agreeing(const Place& place, std::optional<LandmarkTracker::Result> result) const;

  LandmarkTracker tracker_;
  PinholeCamera small_camera_;
  int small_;  ///< Level.
  Options options_;
};

}  // namespace thalweg::visual_odometry
