#include "services/simulator/adapter/simulator_service.h"

#include <algorithm>

#include "common/base/stopwatch.h"
#include "common/base/text.h"
#include "common/dds/convert.h"

namespace thalweg::simulator {
namespace {

constexpr Duration kLongestTick = std::chrono::milliseconds(20);
constexpr Duration kStatusPeriod = std::chrono::milliseconds(200);
const Duration kCommandLifespan = FromSeconds(SimulatedRobot::kCommandLifespan);

Duration PeriodOf(double rate) {
  return FromSeconds(1.0 / rate);
}

/// Divides the odometry period into equal ticks, none longer than kLongestTick.
Duration TickFor(double odometry_rate) {
  const Duration period = PeriodOf(odometry_rate);
  return period / std::max<std::int64_t>(1, (period + kLongestTick - Duration(1)) / kLongestTick);
}

/// Wall time per tick. Ticks follow one another immediately when time_scale is 0.
Duration WallPeriod(Duration tick, double time_scale) {
  return time_scale > 0.0 ? std::max(Duration(1), FromSeconds(Seconds(tick) / time_scale)) : Duration(1000);
}

}  // namespace

SimulatorService::SimulatorService(const SimulatorOptions& options, World world, dds::Bus& bus)
    : options_(options),
      world_(std::move(world)),
      bus_(bus),
      tick_(TickFor(options.odometry_rate)),
      robot_(world_, options.robot, options.T_WB_start),
      depth_sensor_(options.depth_sensor, options.noise_seed),
      odometry_due_(PeriodOf(options.odometry_rate)),
      depth_due_(PeriodOf(options.depth_sensor.rate)),
      stereo_due_(PeriodOf(options.stereo_camera ? options.stereo_camera->rate : 1.0)),
      status_due_(kStatusPeriod),
      wall_at_status_(std::chrono::steady_clock::now()),
      clock_out_(bus.Advertise<dds::topics::Clock>()),
      status_out_(bus.Advertise<dds::topics::SimulationStatus>()),
      cameras_([this](const Shot& shot) { Capture(shot); }) {
  if (options.depth_enabled) points_out_ = bus.Advertise<dds::topics::DepthPoints>();
  if (options.is_odometry) {
    odometry_out_ = bus.Advertise<dds::topics::Odometry>();
    transforms_out_ = bus.Advertise<dds::topics::Transforms>();
  } else {
    true_odometry_out_ = bus.Advertise<dds::topics::TrueOdometry>();
    bus.Subscribe<dds::topics::Odometry>([this](const auto& message) {
      const auto pose = dds::FromIdl(message);
      if (!pose) return bus_.health().Reject<dds::topics::Odometry>(pose.error());
      believed_.Believe(pose->stamp, pose->T);
    });
  }
  if (options.stereo_camera) {
    stereo_rig_.emplace(*options.stereo_camera, options.noise_seed);
    left_out_ = bus.Advertise<dds::topics::LeftImage>();
    right_out_ = bus.Advertise<dds::topics::RightImage>();
    left_info_out_ = bus.Advertise<dds::topics::LeftCameraInfo>();
    right_info_out_ = bus.Advertise<dds::topics::RightCameraInfo>();
  }
  bus.Subscribe<dds::topics::PoseCommand>([this](const auto& message) { OnCommand(message); });
  bus.EveryWall(WallPeriod(tick_, options.time_scale), [this] { Tick(); });
}

void SimulatorService::OnCommand(const geometry_msgs::msg::PoseStamped& message) {
  const auto command = dds::FromIdl(message);
  if (!command) return bus_.health().Reject<dds::topics::PoseCommand>(command.error());
  const Duration age = now_ - command->stamp;
  if (command->stamp != Time{} && age > kCommandLifespan) {
    return bus_.health().Drop<dds::topics::PoseCommand>("it is " + NumberText(Seconds(age)) + " s old");
  }
  robot_.Command(believed_.TrueOf(command->T));
}

void SimulatorService::Tick() {
  const Time next = now_ + tick_;
  const Shot shot{next, {}, points_out_ && depth_due_.Due(next), stereo_rig_ && stereo_due_.Due(next)};
  const bool capture = shot.depth || shot.stereo;
  const bool parts_move = !world_.parts().empty();  // never while a camera looks at them
  if ((capture || parts_move) && cameras_.busy()) return;
  now_ = next;
  bus_.SetNow(now_);
  if (parts_move) world_.MoveParts(Seconds(tick_), options_.robot, robot_.T_WB().translation());
  robot_.Step(Seconds(tick_));
  if (true_odometry_out_) believed_.Note(now_, robot_.T_WB());

  rosgraph_msgs::msg::Clock clock;
  clock.clock(dds::ToIdl(now_));
  clock_out_.Write(clock);
  if (odometry_due_.Due(now_)) PublishPose();
  if (capture) {
    if (shot.depth) depth_due_.Done(now_);
    if (shot.stereo) stereo_due_.Done(now_);
    cameras_.Take({now_, robot_.T_WB(), shot.depth, shot.stereo});
  }
  if (status_due_.Due(now_) || robot_.collisions() != published_collisions_) PublishStatus();
}

void SimulatorService::PublishPose() {
  odometry_due_.Done(now_);
  const auto message = dds::OdometryToIdl(now_, robot_.T_WB(), robot_.v_WB_B(), robot_.w_WB_B());
  if (true_odometry_out_) {
    true_odometry_out_->Write(message);
    return;
  }
  odometry_out_->Write(message);
  transforms_out_->Write(dds::TransformsToIdl(now_, robot_.T_WB(), options_.robot.T_BC));
}

void SimulatorService::PublishStatus() {
  status_due_.Done(now_);
  published_collisions_ = robot_.collisions();
  thalweg_msgs::msg::SimulationStatus status;
  status.header(dds::MakeHeader(now_, dds::kMapFrame));
  status.map_from_body_true(dds::ToIdl(robot_.T_WB()));
  status.true_collisions(robot_.collisions());
  status.clearance_m(robot_.clearance());
  status.least_clearance_m(robot_.least_clearance());
  status.distance_m(robot_.distance());
  status.time_scale(MeasureTimeScale());
  status_out_.Write(status);
}

double SimulatorService::MeasureTimeScale() {
  const auto wall = std::chrono::steady_clock::now();
  const double passed = Seconds(wall - wall_at_status_);
  const double simulated = Seconds(now_ - now_at_status_);
  wall_at_status_ = wall;
  now_at_status_ = now_;
  return passed > 0.0 ? simulated / passed : 0.0;
}

void SimulatorService::Capture(const Shot& shot) {
  if (shot.depth) CaptureDepth(shot);
  if (shot.stereo) CaptureStereo(shot);
}

void SimulatorService::CaptureDepth(const Shot& shot) {
  const Stopwatch watch;
  const PointCloud cloud = depth_sensor_.Capture(world_, shot.T_WB * options_.robot.T_BC);
  points_out_->Write(dds::ToIdl(shot.stamp, cloud));
  bus_.Post([this, duration = watch.Milliseconds()] { bus_.health().Timed("depth", duration); });
}

void SimulatorService::CaptureStereo(const Shot& shot) {
  const Stopwatch watch;
  StereoPair pair = stereo_rig_->Capture(world_, shot.T_WB * options_.robot.T_BC);
  const StereoRigModel& model = stereo_rig_->model();
  const auto to_message = [&](RenderedImage& image) {
    return dds::ToIdl(shot.stamp, dds::kCameraFrame, image.width_px, image.height_px,
                      image.channels == 1 ? "mono8" : "rgb8", std::move(image.data));
  };
  left_info_out_->Write(dds::ToIdl(shot.stamp, model.camera, 0.0));
  right_info_out_->Write(dds::ToIdl(shot.stamp, model.camera, model.baseline));
  left_out_->Write(to_message(pair.left));
  right_out_->Write(to_message(pair.right));
  bus_.Post([this, duration = watch.Milliseconds()] { bus_.health().Timed("stereo", duration); });
}

}  // namespace thalweg::simulator
