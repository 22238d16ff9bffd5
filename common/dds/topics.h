#pragma once

#include <geometry_msgs.h>
#include <nav_msgs.h>
#include <octomap_msgs.h>
#include <rcl_interfaces.h>
#include <rosgraph_msgs.h>
#include <sensor_msgs.h>
#include <stereo_msgs.h>
#include <tf2_msgs.h>
#include <thalweg_msgs.h>
#include <trajectory_msgs.h>
#include <visualization_msgs.h>

#include <cstdint>
#include <tuple>

namespace thalweg::dds {

/// The delivery guarantees of a topic. QoS is decided only here; Bus translates it into Fast DDS policies.
enum class Delivery {
  /// Reliable, volatile, the last 8: images and clouds; a handler that is late gets the newest. Written
  /// asynchronously. A reader accepts best effort where a writer offers no more, as many drivers do.
  kStream,
  /// Volatile, the last 100: poses, of which each helps but none is essential. Written reliably, for readers
  /// that ask for it; read as best effort, so that a lost one does not hold up the next.
  kSamples,
  /// Reliable, volatile, the last 200 in order: map updates, operators' commands. Written asynchronously.
  kLog,
  kState,  ///< Reliable, transient local, newest only: late joiners get the latest.
  kDiary,  ///< Reliable, transient local, the last 100 of each writer: late joiners learn what went before.
  /// Reliable, volatile, newest only, deadline 0.25 s, lifespan 0.5 s: the robot stops when its commander is
  /// silent.
  kCommand,
  /// Reliable, volatile, every sample in order; Write returns false while 512 are unacknowledged. For frames
  /// of a link, which are small, and of which none may be replaced.
  kFrames,
};

/// How many participants may publish on a topic at a time.
enum class Writers {
  kOne,  ///< A reader uses one writer, and refuses the samples of others while that one is active.
  kMany,
};

/// Whether a recorded topic is played again when the user names no topics.
enum class Replay {
  kByDefault,
  /// Services that run now would act on what was meant for those of the recording: a robot moves, an explorer
  /// carries out a command, a mapper takes the health of its recorded namesake for a second copy and ends.
  kOnlyIfNamed,
};
/// The most bytes of a message, as it travels, where its topic does not state another limit: a longer one is
/// refused before it is decoded.
inline constexpr std::uint32_t kMostBytes = 1U << 20;
/// The same for images and clouds: 8 million pixels of 4 bytes, or a million points of 32.
inline constexpr std::uint32_t kMostImageBytes = 32U << 20;
/// The same for maps: a full copy with 20 million voxels is smaller.
inline constexpr std::uint32_t kMostMapBytes = 128U << 20;

/// Every topic of the system, listed only here. On the wire a topic's name is "rt/" + kName, as in ROS 2.
namespace topics {

struct Clock {
  using Message = rosgraph_msgs::msg::Clock;
  static constexpr auto kName = "clock";
  static constexpr auto kDelivery = Delivery::kSamples;
};
struct Transforms {
  using Message = tf2_msgs::msg::TFMessage;
  static constexpr auto kName = "tf";
  static constexpr auto kDelivery = Delivery::kSamples;
  static constexpr auto kWriters = Writers::kMany;
};
/// The transforms that do not change: reliable and for late joiners, as tf2 asks.
struct StaticTransforms {
  using Message = tf2_msgs::msg::TFMessage;
  static constexpr auto kName = "tf_static";
  static constexpr auto kDelivery = Delivery::kState;
  static constexpr auto kWriters = Writers::kMany;
};
struct Odometry {
  using Message = nav_msgs::msg::Odometry;
  static constexpr auto kName = "odometry";
  static constexpr auto kDelivery = Delivery::kSamples;
};
/// The simulator's odometry when another service publishes `odometry`.
struct TrueOdometry {
  using Message = nav_msgs::msg::Odometry;
  static constexpr auto kName = "simulator/odometry";
  static constexpr auto kDelivery = Delivery::kSamples;
};
/// Poses from outside the system; a scenario may give another name.
struct OutsideOdometry {
  using Message = nav_msgs::msg::Odometry;
  static constexpr auto kName = "outside/odometry";
  static constexpr auto kDelivery = Delivery::kSamples;
};
struct OutsidePose {
  using Message = geometry_msgs::msg::PoseStamped;
  static constexpr auto kName = "outside/pose";
  static constexpr auto kDelivery = Delivery::kSamples;
};
struct OdometryStatus {
  using Message = thalweg_msgs::msg::OdometryStatus;
  static constexpr auto kName = "odometry/status";
  static constexpr auto kDelivery = Delivery::kState;
};
/// services/mapper/README.md explains how rays without a return are encoded.
struct DepthPoints {
  using Message = sensor_msgs::msg::PointCloud2;
  static constexpr auto kName = "depth/points";
  static constexpr auto kDelivery = Delivery::kStream;
  static constexpr auto kMostBytes = kMostImageBytes;
};
/// Instead of DepthPoints, with the camera's calibration: see FromIdl of a DepthImage in convert.h.
struct DepthImage {
  using Message = sensor_msgs::msg::Image;
  static constexpr auto kName = "depth/image";
  static constexpr auto kDelivery = Delivery::kStream;
  static constexpr auto kMostBytes = kMostImageBytes;
};
struct DepthCameraInfo {
  using Message = sensor_msgs::msg::CameraInfo;
  static constexpr auto kName = "depth/camera_info";
  static constexpr auto kDelivery = Delivery::kStream;
};
struct LeftImage {
  using Message = sensor_msgs::msg::Image;
  static constexpr auto kName = "stereo/left/image_raw";
  static constexpr auto kDelivery = Delivery::kStream;
  static constexpr auto kMostBytes = kMostImageBytes;
};
struct RightImage {
  using Message = sensor_msgs::msg::Image;
  static constexpr auto kName = "stereo/right/image_raw";
  static constexpr auto kDelivery = Delivery::kStream;
  static constexpr auto kMostBytes = kMostImageBytes;
};
struct LeftCameraInfo {
  using Message = sensor_msgs::msg::CameraInfo;
  static constexpr auto kName = "stereo/left/camera_info";
  static constexpr auto kDelivery = Delivery::kStream;
};
struct RightCameraInfo {
  using Message = sensor_msgs::msg::CameraInfo;
  static constexpr auto kName = "stereo/right/camera_info";
  static constexpr auto kDelivery = Delivery::kStream;
};
struct Disparity {
  using Message = stereo_msgs::msg::DisparityImage;
  static constexpr auto kName = "stereo/disparity";
  static constexpr auto kDelivery = Delivery::kStream;
  static constexpr auto kMostBytes = kMostImageBytes;
};
struct MapUpdates {
  using Message = thalweg_msgs::msg::MapUpdate;
  static constexpr auto kName = "map/updates";
  static constexpr auto kDelivery = Delivery::kLog;
  static constexpr auto kMostBytes = kMostMapBytes;
};
struct MapRequests {
  using Message = thalweg_msgs::msg::MapRequest;
  static constexpr auto kName = "map/requests";
  static constexpr auto kDelivery = Delivery::kLog;
  static constexpr auto kWriters = Writers::kMany;
  static constexpr auto kReplay = Replay::kOnlyIfNamed;
};
struct Octomap {
  using Message = octomap_msgs::msg::Octomap;
  static constexpr auto kName = "map/octomap";
  static constexpr auto kDelivery = Delivery::kState;
  static constexpr auto kMostBytes = kMostImageBytes;
};
/// The centers of the occupied voxels, colored by height, for tools that know no other map; published only
/// while somebody listens.
struct OccupiedPoints {
  using Message = sensor_msgs::msg::PointCloud2;
  static constexpr auto kName = "map/occupied";
  static constexpr auto kDelivery = Delivery::kState;
  static constexpr auto kMostBytes = kMostMapBytes;
};
/// The centers of the occupied voxels whose color the sensor has measured, in its mean; published only while
/// somebody listens.
struct ColoredPoints {
  using Message = sensor_msgs::msg::PointCloud2;
  static constexpr auto kName = "map/colored";
  static constexpr auto kDelivery = Delivery::kState;
  static constexpr auto kMostBytes = kMostMapBytes;
};
/// The mesh of all that was seen, as numbered updates.
struct SurfaceUpdates {
  using Message = thalweg_msgs::msg::SurfaceUpdate;
  static constexpr auto kName = "surface/updates";
  static constexpr auto kDelivery = Delivery::kLog;
  static constexpr auto kMostBytes = kMostMapBytes;
};
struct SurfaceRequests {
  using Message = thalweg_msgs::msg::MapRequest;
  static constexpr auto kName = "surface/requests";
  static constexpr auto kDelivery = Delivery::kLog;
  static constexpr auto kWriters = Writers::kMany;
  static constexpr auto kReplay = Replay::kOnlyIfNamed;
};
struct SurfaceStatus {
  using Message = thalweg_msgs::msg::SurfaceStatus;
  static constexpr auto kName = "surface/status";
  static constexpr auto kDelivery = Delivery::kState;
};
/// Where the surface is torn.
struct SurfaceRifts {
  using Message = thalweg_msgs::msg::SurfaceRifts;
  static constexpr auto kName = "surface/rifts";
  static constexpr auto kDelivery = Delivery::kState;
};
/// The same for tools that know no type of ours, with the lines; published only while somebody listens.
struct RiftMarkers {
  using Message = visualization_msgs::msg::MarkerArray;
  static constexpr auto kName = "surface/rift_markers";
  static constexpr auto kDelivery = Delivery::kState;
  static constexpr auto kMostBytes = kMostImageBytes;
};
struct Path {
  using Message = nav_msgs::msg::Path;
  static constexpr auto kName = "explorer/path";
  static constexpr auto kDelivery = Delivery::kCommand;
};
struct ExplorationStatus {
  using Message = thalweg_msgs::msg::ExplorationStatus;
  static constexpr auto kName = "explorer/status";
  static constexpr auto kDelivery = Delivery::kState;
};
/// The frontiers from which the explorer chose its last plan.
struct Frontiers {
  using Message = thalweg_msgs::msg::FrontierList;
  static constexpr auto kName = "explorer/frontiers";
  static constexpr auto kDelivery = Delivery::kState;
};
/// The same for tools that know no type of ours; published only while somebody listens.
struct FrontierMarkers {
  using Message = visualization_msgs::msg::MarkerArray;
  static constexpr auto kName = "explorer/frontier_markers";
  static constexpr auto kDelivery = Delivery::kState;
};
/// The potential over free space, if the strategy computes one; published only while somebody listens.
struct Field {
  using Message = sensor_msgs::msg::PointCloud2;
  static constexpr auto kName = "explorer/field";
  static constexpr auto kDelivery = Delivery::kStream;
  static constexpr auto kMostBytes = kMostImageBytes;
};
/// Centers of the voxels that the strategy has sealed: explored dead ends that its potential does without.
/// Published with the field, while somebody listens.
struct Sealed {
  using Message = sensor_msgs::msg::PointCloud2;
  static constexpr auto kName = "explorer/sealed";
  static constexpr auto kDelivery = Delivery::kStream;
  static constexpr auto kMostBytes = kMostImageBytes;
};
/// The strategy's path, before it is shortened and moved away from walls to become `explorer/path`.
struct Streamline {
  using Message = nav_msgs::msg::Path;
  static constexpr auto kName = "explorer/streamline";
  static constexpr auto kDelivery = Delivery::kState;
};
/// What an operator wants while the robot explores. Volatile: a command is not repeated to a late joiner.
struct OperatorCommands {
  using Message = thalweg_msgs::msg::OperatorCommand;
  static constexpr auto kName = "operator/command";
  static constexpr auto kDelivery = Delivery::kLog;
  static constexpr auto kWriters = Writers::kMany;
  static constexpr auto kReplay = Replay::kOnlyIfNamed;
};
struct CommandReplies {
  using Message = thalweg_msgs::msg::CommandReply;
  static constexpr auto kName = "operator/reply";
  static constexpr auto kDelivery = Delivery::kLog;
  static constexpr auto kWriters = Writers::kMany;
  static constexpr auto kReplay = Replay::kOnlyIfNamed;
};
struct PoseCommand {
  using Message = geometry_msgs::msg::PoseStamped;
  static constexpr auto kName = "command/pose";
  static constexpr auto kDelivery = Delivery::kCommand;
};
struct VelocityCommand {
  using Message = geometry_msgs::msg::Twist;
  static constexpr auto kName = "command/velocity";
  static constexpr auto kDelivery = Delivery::kCommand;
};
/// VelocityCommand with a stamp, in the body's frame, for bases that want one.
struct StampedVelocityCommand {
  using Message = geometry_msgs::msg::TwistStamped;
  static constexpr auto kName = "command/velocity_stamped";
  static constexpr auto kDelivery = Delivery::kCommand;
};
/// How the robot is to move from now to where it stands again, for controllers that want to know what comes;
/// published only while somebody listens.
struct Trajectory {
  using Message = trajectory_msgs::msg::MultiDOFJointTrajectory;
  static constexpr auto kName = "command/trajectory";
  static constexpr auto kDelivery = Delivery::kCommand;
};
struct MotionStatus {
  using Message = thalweg_msgs::msg::MotionStatus;
  static constexpr auto kName = "controller/status";
  static constexpr auto kDelivery = Delivery::kState;
};
struct SimulationStatus {
  using Message = thalweg_msgs::msg::SimulationStatus;
  static constexpr auto kName = "simulator/status";
  static constexpr auto kDelivery = Delivery::kState;
};
struct Health {
  using Message = thalweg_msgs::msg::ServiceHealth;
  static constexpr auto kName = "health";
  static constexpr auto kDelivery = Delivery::kSamples;
  static constexpr auto kWriters = Writers::kMany;
  static constexpr auto kReplay = Replay::kOnlyIfNamed;
};

/// The log lines of all services, where the tools of ROS 2 look for them.
struct Log {
  using Message = rcl_interfaces::msg::Log;
  static constexpr auto kName = "rosout";
  static constexpr auto kDelivery = Delivery::kDiary;
  static constexpr auto kWriters = Writers::kMany;
  static constexpr std::uint32_t kMostBytes = 1U << 16;
};

/// What `thalweg replay` is to do: an operator's tool -> replay.
struct ReplayCommands {
  using Message = thalweg_msgs::msg::ReplayCommand;
  static constexpr auto kName = "replay/command";
  static constexpr auto kDelivery = Delivery::kLog;
  static constexpr auto kWriters = Writers::kMany;
  static constexpr auto kReplay = Replay::kOnlyIfNamed;
};
/// Where `thalweg replay` is in its recording.
struct ReplayStatus {
  using Message = thalweg_msgs::msg::ReplayStatus;
  static constexpr auto kName = "replay/status";
  static constexpr auto kDelivery = Delivery::kState;
  static constexpr auto kReplay = Replay::kOnlyIfNamed;
};
/// Frames of a link, from the robot and to it. In a domain of the link's own.
struct LinkUp {
  using Message = thalweg_msgs::msg::LinkFrame;
  static constexpr auto kName = "link/up";
  static constexpr auto kDelivery = Delivery::kFrames;
};
struct LinkDown {
  using Message = thalweg_msgs::msg::LinkFrame;
  static constexpr auto kName = "link/down";
  static constexpr auto kDelivery = Delivery::kFrames;
};

/// All of them, e.g. for tools that offer every topic.
using All =
    std::tuple<Clock, Transforms, StaticTransforms, Odometry, TrueOdometry, OutsideOdometry, OutsidePose,
               OdometryStatus, DepthPoints, DepthImage, DepthCameraInfo, LeftImage, RightImage,
               LeftCameraInfo, RightCameraInfo, Disparity, MapUpdates, MapRequests, Octomap, OccupiedPoints,
               ColoredPoints, SurfaceUpdates, SurfaceRequests, SurfaceStatus, SurfaceRifts, RiftMarkers, Path,
               ExplorationStatus, Frontiers, FrontierMarkers, Field, Sealed, Streamline, OperatorCommands,
               CommandReplies, PoseCommand, VelocityCommand, StampedVelocityCommand, Trajectory, MotionStatus,
               SimulationStatus, Health, Log, LinkUp, LinkDown, ReplayCommands, ReplayStatus>;

}  // namespace topics

/// Frame names on the wire [REP 105]. The odometry frame coincides with the map frame, since nothing corrects
/// drift.
inline constexpr auto kMapFrame = "map";                      // W
inline constexpr auto kOdometryFrame = "odom";                // O
inline constexpr auto kBodyFrame = "base_link";               // B
inline constexpr auto kCameraFrame = "camera_optical_frame";  // C

template <class Topic>
using MessageOf = typename Topic::Message;

/// One, where the topic does not state it.
template <class Topic>
constexpr Writers WritersOf() {
  if constexpr (requires { Topic::kWriters; }) return Topic::kWriters;
  return Writers::kOne;
}
template <class Topic>
constexpr std::uint32_t MostBytesOf() {
  if constexpr (requires { Topic::kMostBytes; }) return Topic::kMostBytes;
  return kMostBytes;
}

/// By default, where the topic does not state it, except for commands.
template <class Topic>
constexpr Replay ReplayOf() {
  if constexpr (requires { Topic::kReplay; }) return Topic::kReplay;
  // Frames mean something only to the link for which they were written.
  constexpr bool kIsFrames = Topic::kDelivery == Delivery::kFrames;
  return kIsFrames || Topic::kDelivery == Delivery::kCommand ? Replay::kOnlyIfNamed : Replay::kByDefault;
}

}  // namespace thalweg::dds
