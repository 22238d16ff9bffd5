// A robot for thalweg in C++, complete, with thalweg's own library for DDS (docs/guide/install.md).
//
//   my_robot [DOMAIN]
//
// It publishes its odometry and what its depth camera sees, and moves where command/pose says. Replace the
// corridor by your camera and the jump to the commanded pose by your motors. docs/guide/own-robot.md says how
// to build and run it.
#include <cstdlib>
#include <iostream>

#include "common/dds/bus.h"
#include "common/dds/convert.h"
#include "corridor.h"

using namespace thalweg;
namespace topics = dds::topics;
using std::chrono_literals::operator""ms;

const PinholeCamera kCamera = PinholeCamera::FromFieldOfView(120, 90, 1.396);  // 80 degrees

PointCloud LookAround(const RigidTransform& T_WB) {
  const Eigen::Vector3d p_W = T_WB.translation();
  const Eigen::Quaterniond q_WB(T_WB.linear());
  PointCloud cloud{
      .width_px = kCamera.width_px, .height_px = kCamera.height_px, .points_C = {}, .colors = {}};
  for (int v = 0; v < kCamera.height_px; ++v) {
    for (int u = 0; u < kCamera.width_px; ++u) {
      const Eigen::Vector3d ray_C((u - kCamera.cx) / kCamera.fx, (v - kCamera.cy) / kCamera.fy, 1.0);
      const double depth = CorridorDepth(p_W.data(), q_WB.coeffs().data(), ray_C.x(), ray_C.y());
      cloud.points_C.push_back((depth * ray_C).cast<float>());  // NaN where a camera measured nothing
    }
  }
  return cloud;
}

int main(int argc, char** argv) try {
  dds::Bus bus({.name = "my_robot", .domain = argc > 1 ? std::atoi(argv[1]) : 0});  // follows the wall clock
  const auto odometry_out = bus.Advertise<topics::Odometry>();
  const auto points_out = bus.Advertise<topics::DepthPoints>();
  RigidTransform T_WB = RigidTransform::Identity();
  bus.Subscribe<topics::PoseCommand>([&](const auto& message) {
    const auto command = dds::FromIdl(message);  // checked: frame, finite, a unit quaternion
    if (!command) return bus.health().Reject<topics::PoseCommand>(command.error());
    T_WB = command->T;
  });
  bus.EveryWall(20ms, [&] {
    odometry_out.Write(dds::OdometryToIdl(bus.Now(), T_WB, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()));
  });
  bus.EveryWall(200ms, [&] { points_out.Write(dds::ToIdl(bus.Now(), LookAround(T_WB))); });
  bus.Spin({});
} catch (const std::exception& error) {
  std::cerr << "my_robot: " << error.what() << '\n';
  return EXIT_FAILURE;
}
