// What a sensor without depths before a wall does to an exploration: simulator, mapper and explorer together.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <map>

#include "services/explorer/core/explorer.h"
#include "services/mapper/core/occupancy_map.h"
#include "services/simulator/core/depth_sensor.h"
#include "services/simulator/core/world.h"
#include "tests/support/meshes.h"

namespace thalweg {
namespace {

using explorer::AsideReason;
using explorer::Plan;

constexpr double kWall = 4.03;  // [m] x of the wall that may be blank

/// A room whose far wall may return no measurements, like a surface without texture to a stereo camera. Some
/// voxels at the opposite wall stay unknown as well, although they are measured.
class BlankWall : public testing::TestWithParam<const char*> {
 protected:
  using Box = Eigen::AlignedBox3d;

  struct End {
    std::optional<explorer::Outcome> outcome;
    std::map<AsideReason, std::vector<Eigen::Vector3d>> aside_W;  ///< [m] Centers of voxels.
    std::vector<Eigen::Vector3d> eyes_W;                          ///< [m] Positions of the camera's scans.
  };

  End Explore(bool blank) {
    explorer::Explorer::Options options;
    options.bounds = bounds_;
    options.strategy = explorer::Configure(GetParam());
    explorer::Explorer explorer(options);
    mapper::OccupancyMap map({});
    simulator::DepthSensor sensor({}, 1, /*colors=*/false);
    RigidTransform T_WB = MakeTransform(Eigen::Matrix3d::Identity(), {1.0, 1.5, 1.2});
    Time now{};
    std::vector<Eigen::Vector3d> eyes_W;
    const auto scan = [&] {
      now += std::chrono::seconds(1);
      explorer.Move(T_WB);
      const RigidTransform T_WC = T_WB * options.robot.T_BC;
      eyes_W.emplace_back(T_WC.translation());
      PointCloud cloud = sensor.Capture(world_, T_WC);
      for (Eigen::Vector3f& p_C : cloud.points_C) {
        const bool on_wall = (T_WC * p_C.cast<double>()).x() > kWall - 1e-3;
        if (blank && on_wall) p_C.setConstant(std::numeric_limits<float>::quiet_NaN());
      }
      const ScanView view{.T_WC = T_WC, .measured = MeasuredShares::Of(cloud)};
      std::vector<VoxelChange> changes;
      for (const VoxelChange& change : map.Integrate(cloud, T_WC)) {
        if (!pocket_.contains(VoxelCenter(change.voxel, options.voxel_size))) changes.push_back(change);
      }
      explorer.Update(changes, {&view, 1}, now);
    };
    scan();
    for (int plans = 0; plans < 300; ++plans) {
      const Plan plan = explorer.MakePlan(T_WB, now);
      if (plan.kind == Plan::Kind::kDone) {
        End end{.outcome = plan.ending->outcome, .aside_W = {}, .eyes_W = std::move(eyes_W)};
        for (const auto& [reason, voxels] : explorer.memory().SetAsideVoxels()) {
          for (const VoxelIndex& i : voxels) end.aside_W[reason].push_back(explorer.map().CenterOf(i));
        }
        return end;
      }
      bool carried_out = true;
      for (std::size_t n = 0; n < plan.T_WBs.size() && carried_out; ++n) {
        T_WB = plan.T_WBs[n];
        scan();
        carried_out = !explorer.CheckPlan(T_WB);
      }
      if (carried_out) explorer.Arrived(now);
    }
    return {};
  }

  /// Whether a camera looking there from one of the eyes would see the wall behind it.
  bool IsBeforeWall(const Eigen::Vector3d& p_W, const std::vector<Eigen::Vector3d>& eyes_W) const {
    return std::any_of(eyes_W.begin(), eyes_W.end(), [&](const Eigen::Vector3d& eye_W) {
      const Eigen::Vector3d ray_W = (p_W - eye_W).normalized();
      const auto hit = world_.CastRay(eye_W, ray_W, 10.0);
      return hit && (eye_W + hit->distance * ray_W).x() > kWall - 1e-3;
    });
  }

  const Box bounds_{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(4.1, 3.1, 2.5)};
  static Box Between(double x0, double y0, double z0, double x1, double y1, double z1) {
    return {Eigen::Vector3d(x0, y0, z0), Eigen::Vector3d(x1, y1, z1)};
  }
  /// At the opposite wall: voxels that are measured but whose changes never reach the explorer.
  const Box pocket_ = Between(0.0, 1.2, 0.9, 0.3, 1.8, 1.5);
  const simulator::World world_{
      test::MeshOf(test::AnalyticRoom{Between(0.04, 0.03, 0.06, kWall, 3.02, 2.44),
                                      {Between(1.42, 2.51, 0.06, 2.13, 3.02, 1.77),     // cupboard
                                       Between(1.52, 0.44, 0.06, 2.07, 1.03, 0.81)}}),  // table
      bounds_};
};
INSTANTIATE_TEST_SUITE_P(Strategies, BlankWall, testing::Values("closest", "flow"));

TEST_P(BlankWall, FrontiersBeforeItAreSetAsideWithThatReasonAndOthersAreNot) {
  for (const bool blank : {false, true}) {
    const End end = Explore(blank);
    EXPECT_EQ(end.outcome, explorer::Outcome::kComplete);
    std::size_t in_pocket = 0;
    std::size_t before_wall = 0;
    std::size_t for_no_depth = 0;
    std::size_t no_depth_before_wall = 0;
    for (const auto& [reason, places_W] : end.aside_W) {
      const bool no_depth = reason == AsideReason::kNoDepth;
      for (const Eigen::Vector3d& p_W : places_W) {
        in_pocket += pocket_.contains(p_W) ? 1U : 0U;
        if (no_depth) {
          ++for_no_depth;
          EXPECT_TRUE(IsBeforeWall(p_W, end.eyes_W)) << p_W.transpose();
        }
        if (p_W.x() < kWall - 1.2) continue;
        ++before_wall;
        no_depth_before_wall += no_depth ? 1U : 0U;
      }
    }
    std::cout << GetParam() << (blank ? ", blank: " : ", measured: ") << before_wall
              << " voxels set aside before the wall, " << no_depth_before_wall << " of all " << for_no_depth
              << " for want of a depth; " << in_pocket << " in the pocket\n";
    EXPECT_GT(in_pocket, 20U) << "nothing else to tell it from";
    if (blank) {
      EXPECT_GT(before_wall, 200U);
      EXPECT_GT(no_depth_before_wall, before_wall * 9 / 10);
    } else {
      EXPECT_EQ(for_no_depth, 0U);
    }
  }
}

}  // namespace
}  // namespace thalweg
