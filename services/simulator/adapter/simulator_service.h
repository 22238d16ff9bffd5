#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "common/dds/bus.h"
#include "services/simulator/adapter/camera_thread.h"
#include "services/simulator/adapter/options.h"
#include "services/simulator/core/believed_frame.h"
#include "services/simulator/core/robot.h"

namespace thalweg::simulator {

/// Stands in for the robot and its world: generates the time of the run, executes pose commands, and
/// publishes what the sensors measure together with the ground truth. When another service computes the
/// odometry, the robot executes commands in the frame of that odometry, because a real robot would know no
/// other pose. Simulated time starts when the bus first spins.
///
/// Simulated time advances in equal ticks. It waits for a camera that is still rendering, so that sensors
/// keep their rates in simulated time however slow the machine is. In a world with parts that move, every
/// tick waits, so that a picture shows all of them where they are at its stamp.
class SimulatorService {
 public:
  /// @param bus  Must have ClockSource::kOwn, because this service is the source of simulated time.
  SimulatorService(const SimulatorOptions& options, World world, dds::Bus& bus);

  const SimulatedRobot& robot() const { return robot_; }

 private:
  void OnCommand(const geometry_msgs::msg::PoseStamped& message);
  void Tick();
  void PublishPose();
  void PublishStatus();
  void Capture(const Shot& shot);
  void CaptureDepth(const Shot& shot);
  void CaptureStereo(const Shot& shot);
  double MeasureTimeScale();

  /// A periodic event in simulated time that is first due at the first tick.
  class Schedule {
   public:
    explicit Schedule(Duration period) : period_(period) {}
    bool Due(Time now) const { return now >= next_; }
    void Done(Time now) {
      if (next_ == Time{}) next_ = now;
      while (next_ <= now) next_ += period_;
    }

   private:
    Duration period_;
    Time next_{};
  };

  SimulatorOptions options_;
  World world_;
  dds::Bus& bus_;
  Duration tick_;
  Time now_{};
  SimulatedRobot robot_;
  BelievedFrame believed_;
  DepthSensor depth_sensor_;
  std::optional<StereoRig> stereo_rig_;
  Schedule odometry_due_;
  Schedule depth_due_;
  Schedule stereo_due_;
  Schedule status_due_;
  std::uint32_t published_collisions_ = 0;
  std::chrono::steady_clock::time_point wall_at_status_;
  Time now_at_status_{};

  dds::Bus::Publisher<dds::topics::Clock> clock_out_;
  std::optional<dds::Bus::Publisher<dds::topics::Odometry>> odometry_out_;
  std::optional<dds::Bus::Publisher<dds::topics::Transforms>> transforms_out_;
  std::optional<dds::Bus::Publisher<dds::topics::TrueOdometry>> true_odometry_out_;
  std::optional<dds::Bus::Publisher<dds::topics::DepthPoints>> points_out_;
  dds::Bus::Publisher<dds::topics::SimulationStatus> status_out_;
  std::optional<dds::Bus::Publisher<dds::topics::LeftImage>> left_out_;
  std::optional<dds::Bus::Publisher<dds::topics::RightImage>> right_out_;
  std::optional<dds::Bus::Publisher<dds::topics::LeftCameraInfo>> left_info_out_;
  std::optional<dds::Bus::Publisher<dds::topics::RightCameraInfo>> right_info_out_;
  CameraThread cameras_;  ///< Declared last, so that it stops before the members it uses.
};

}  // namespace thalweg::simulator
