#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "common/dds/bus.h"
#include "common/dds/cloud_placement.h"
#include "common/dds/convert.h"
#include "common/dds/depth_images.h"
#include "common/geometry/cloud_camera.h"
#include "common/geometry/pose_continuity.h"

namespace thalweg::dds {

/// Organized clouds, each with the camera that took it and the pose of the body at its stamp: from clouds or
/// depth images, and odometry.
///
/// Refused and counted: poses that jump, see PoseContinuity; clouds that are not organized, or not of one
/// pinhole camera; those of another camera, until it has stayed. A cloud waits until odometry has reached its
/// stamp; of more than kMaxWaiting the oldest is dropped.
///
/// Threading: the bus's thread.
class PlacedViews {
 public:
  static constexpr std::size_t kMaxWaiting = 8;

  struct View {
    StampedCloud stamped;
    PinholeCamera camera;
    const char* topic;  ///< From which it came.
    RigidTransform T_WB = {};
  };

  /// @param bus       Must outlive the object.
  /// @param infinity  What the sensor means by a depth of +infinity.
  /// @param continuity  What poses may do.
  PlacedViews(Bus& bus, Infinity infinity, const PoseContinuity::Options& continuity)
      : bus_(bus),
        infinity_(infinity),
        placement_(bus.health()),
        continuity_(continuity),
        depth_images_(bus, infinity) {}

  /// Adds a pose of odometry.
  void AddPose(const StampedPose& pose);

  void Add(const sensor_msgs::msg::PointCloud2& message);
  void Add(const sensor_msgs::msg::Image& message) { AddDepth(message); }
  void Add(const sensor_msgs::msg::CameraInfo& message) { AddDepth(message); }

  /// Takes the views whose pose is known by now, oldest first.
  std::vector<View> Take();

 private:
  template <class Message>
  void AddDepth(const Message& message);
  /// @param stated  The camera, if it is stated beside the cloud.
  void Add(StampedCloud cloud, const std::optional<PinholeCamera>& stated, const char* topic);
  /// The camera that took a cloud; nothing if the cloud is refused, which is counted.
  std::optional<PinholeCamera> CameraFor(const PointCloud& cloud, const std::optional<PinholeCamera>& stated,
                                         const char* topic);

  Bus& bus_;
  Infinity infinity_;
  CloudPlacement placement_;
  PoseContinuity continuity_;
  DepthImages depth_images_;
  SteadyCamera camera_;
  std::deque<View> waiting_;  ///< For their poses.
};

}  // namespace thalweg::dds
