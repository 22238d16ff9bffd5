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
    int least_inliers = 30;      ///< Points of a place found again, at least,
    double least_share = 0.5;    ///< and of those that should be visible,
    double most_sigma_px = 1.2;  ///< which move as one.
    std::size_t most_tried = 8;  ///< Places in a frame, the most alike first.
    /// None of the places is believed when another one of so many, the most alike, agrees nearly as well and
    /// would have the camera elsewhere.
    std::size_t most_rivals = 12;
    double rival_share = 0.7;  ///< Of the points found again, compared with the believed one's.
    double same_way = 0.1;     ///< [m] Poses that differ by less, or by what the places' sigmas explain,
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

  struct Found {
    std::optional<SeenPlace> seen;
    bool disputed = false;  ///< There was one, and it had a rival.
  };
  /// Any of the places within that reach of where the camera is believed to be.
  Found Search(const PlaceMemory& places, const PlaceMemory::Reach& reach, const Sight& sight) const;
  /// Whether another place within that reach agrees nearly as well as what gave T_OC.
  /// @param sigma  [m] Of T_OC.  @param share  Of the points found again.
  bool HasRival(const RigidTransform& T_OC, double sigma, double share, const PlaceMemory& places,
                const PlaceMemory::Reach& reach, const Sight& sight) const;

 private:
  std::optional<SeenPlace> LookAround(const Place& place, const PlaceMemory::Reach& reach,
                                      const Sight& sight) const;
  std::optional<SeenPlace> Agreeing(const Place& place, std::optional<LandmarkTracker::Result> result) const;

  LandmarkTracker tracker_;
  PinholeCamera small_camera_;
  int small_;  ///< Level.
  Options options_;
};

}  // namespace thalweg::visual_odometry
