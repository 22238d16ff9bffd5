// A robot for thalweg in C++, complete, with thalweg's own library for DDS (docs/guide/install.md).
//
//   my_robot [DOMAIN]
//
// It stands in a corridor with a crate, publishes its odometry and what its depth camera sees, and moves
// where command/pose says. Replace the corridor by your camera and the jump to the commanded pose by your
// motors. docs/guide/own-robot.md says how to build and run it.
#include <cstdlib>
#include <iostream>

#include "common/dds/bus.h"
#include "common/dds/convert.h"

using namespace thalweg;
namespace topics = dds::topics;
using std::chrono_literals::operator""ms;

const PinholeCamera kCamera = PinholeCamera::FromFieldOfView(120, 90, 1.396);  // 80 degrees
const RigidTransform kT_BC = MakeTransform(BodyFromOptical(), {0, 0, 0});      // looks along the body's x

const Eigen::AlignedBox3d kCorridor(Eigen::Vector3d(-1.0, -0.8, -0.9),
                                    Eigen::Vector3d(4.0, 0.8, 0.9));  // [m] in map
const Eigen::AlignedBox3d kCrate(Eigen::Vector3d(1.5, -0.8, -0.9), Eigen::Vector3d(2.0, -0.1, 0.2));

struct Inside {
  double from, to;
};
/// Between which multiples of `d` a ray from `p` is inside the box, if from < to.
Inside Cross(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& p, const Eigen::Vector3d& d) {
  const Eigen::Array3d a = (box.min() - p).array() / d.array();
  const Eigen::Array3d b = (box.max() - p).array() / d.array();
  return {a.min(b).maxCoeff<Eigen::PropagateNumbers>(), a.max(b).minCoeff<Eigen::PropagateNumbers>()};
}

PointCloud LookAround(const RigidTransform& T_WB) {
  const RigidTransform T_WC = T_WB * kT_BC;
  PointCloud cloud{
      .width_px = kCamera.width_px, .height_px = kCamera.height_px, .points_C = {}, .colors = {}};
  for (int v = 0; v < kCamera.height_px; ++v) {
    for (int u = 0; u < kCamera.width_px; ++u) {
      const Eigen::Vector3d ray_C((u - kCamera.cx) / kCamera.fx, (v - kCamera.cy) / kCamera.fy, 1.0);
      const Eigen::Vector3d ray_W = T_WC.linear() * ray_C;
      const Inside crate = Cross(kCrate, T_WC.translation(), ray_W);
      const bool hit = crate.from < crate.to && crate.from > 0.0;
      const double depth = hit ? crate.from : Cross(kCorridor, T_WC.translation(), ray_W).to;
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
