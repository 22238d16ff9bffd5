#include <cstdlib>
#include <iostream>
#include <random>

#include "common/dds/bus.h"
#include "common/dds/convert.h"
#include "common/dds/map_replica.h"
#include "common/service/service.h"
#include "common/voxel/for_each_voxel.h"

/// An explorer of your own, in a separate process: it reads map updates and poses, publishes paths, and
/// reports when it is done. This one flies straight to random free positions within 2 m on each axis, and is
/// done after kVisits paths.
///   thalweg run kitchen --without explorer & thalweg-example-outside-explorer --scenario kitchen
namespace {

using namespace thalweg;
namespace topics = dds::topics;
constexpr int kVisits = 30;  // including turns on the spot
using std::chrono_literals::operator""ms;

/// Whether a cube around the robot can move straight through known free space.
bool IsFree(const OccupancyGrid& map, const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W) {
  constexpr int kHalf = 2;  // [voxels] the robot plus some margin
  const int steps = 1 + static_cast<int>((to_W - from_W).norm() / (0.5 * map.voxel_size()));
  for (int k = 0; k <= steps; ++k) {
    const VoxelIndex here = map.IndexOf(from_W + k * (to_W - from_W) / steps);
    const auto is_free = [&](const VoxelIndex& i) { return map.State(i) == VoxelState::kFree; };
    if (!ForEachVoxel(CubeAround(here, kHalf), is_free)) return false;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::stop_token stop = StopOnSignals();
  const ServiceArgs args =
      ParseServiceArgs(argc, argv, "explorer", "visits random free places of the map", Files::kNone);
  const Scenario scenario = LoadScenario(args.scenario, args.overrides);
  dds::Bus bus(BusOptionsFrom(scenario, args, "explorer"));
  const auto path_out = bus.Advertise<topics::Path>();
  const auto status_out = bus.Advertise<topics::ExplorationStatus>();
  const auto request_out = bus.Advertise<topics::MapRequests>();
  dds::MapReplica map;
  std::optional<dds::StampedPose> robot;
  dds::StampedPath path;
  int visits = 0;
  std::mt19937 random(1);

  bus.Subscribe<topics::MapUpdates>([&](const auto& update) {
    if (const auto applied = map.Apply(update); !applied)
      bus.health().Reject<topics::MapUpdates>(applied.error());
  });
  bus.Subscribe<topics::Odometry>([&](const auto& message) {
    if (const auto pose = dds::FromIdl(message)) robot = *pose;
  });
  bus.Subscribe<topics::MotionStatus>([&](const auto& message) {
    const auto of = dds::FromIdl(message.path_stamp());
    if (message.state() != thalweg_msgs::msg::MOTION_DONE || !of || *of != path.stamp || path.T_WBs.empty())
      return;
    path = {};
    ++visits;
  });
  const auto choose = [&]() -> std::vector<RigidTransform> {
    std::uniform_real_distribution<double> offset(-2.0, 2.0), yaw(-3.1, 3.1), pitch(-1.2, 1.2);  // [m], [rad]
    const RigidTransform T_WB = robot->T;
    for (int attempt = 0; attempt < 100; ++attempt) {
      Eigen::Vector3d to_W = T_WB.translation();
      for (double& coordinate : to_W) coordinate += offset(random);
      if (!IsFree(map.grid(), T_WB.translation(), to_W)) continue;
      return {T_WB, MakeTransform(RotationFromYawPitch(yaw(random), 0.0), to_W)};
    }
    const double to_yaw = yaw(random);
    return {T_WB, MakeTransform(RotationFromYawPitch(to_yaw, pitch(random)), T_WB.translation())};
  };
  bus.Every(100ms, [&] {  // ten times a second, or the controller stops
    if (!map.has_map() || !robot || visits == kVisits) return;
    if (path.T_WBs.empty()) path = {bus.Now(), choose()};
    path_out.Write(dds::ToIdl(path));
  });
  bus.EveryWall(500ms, [&] {
    if (map.missing()) request_out.Write(map.MakeRequest(bus.Now(), "outside explorer"));
    thalweg_msgs::msg::ExplorationStatus status;
    status.header(dds::MakeHeader(bus.Now(), dds::kMapFrame));
    status.strategy("outside");
    status.state(visits < kVisits ? thalweg_msgs::msg::EXPLORATION_MOVING
                                  : thalweg_msgs::msg::EXPLORATION_DONE);
    if (visits == kVisits) {
      status.outcome(thalweg_msgs::msg::OUTCOME_OTHER);
      status.stop_reason("enough");
    }
    status.activity(std::to_string(visits) + " places visited");
    status_out.Write(status);
  });
  bus.Spin(stop);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "outside explorer: " << error.what() << '\n';
  return EXIT_FAILURE;
}
