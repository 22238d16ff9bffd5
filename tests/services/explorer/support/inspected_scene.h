#pragma once

#include <random>
#include <vector>

#include "services/explorer/core/view/inspection.h"
#include "tests/services/explorer/support/random_planning_map.h"

namespace thalweg::explorer::test {

/// A robot with a free camera among random boxes, and what it has inspected of them.
struct InspectedScene {
  explicit InspectedScene(unsigned seed) : random(seed) {
    surface.Follow(map, map.Apply(RandomScene(random, {{0, 0, 0}, {30, 26, 20}}, 12, 5)));
    const std::vector<VoxelIndex> traversable = TraversableVoxels(map);
    Stand(traversable.at(random() % traversable.size()), Eigen::Matrix3d::Identity());
  }
  void Stand(const VoxelIndex& at, const Eigen::Matrix3d& R_WB) {
    T_WB = MakeTransform(R_WB, map.CenterOf(at));
    search.Flood(map, {{at, 0}});
  }
  /// Goes where a view is to be taken, and takes a scan there.
  void Take(const InspectionView& view) {
    Stand(view.place, view.R_WB);
    surface.See(map, {.T_WC = MakeTransform(view.R_WB * BodyFromOptical(), T_WB.translation())});
  }
  InspectionViews Views() { return {map, views, criterion, surface}; }

  std::mt19937 random;
  InspectionCriterion criterion{.distance = 1.2};
  PlanningMap map{{.voxel_size = kSize, .clearance = kClearance, .bounds = {}}};
  PinholeCamera camera = PinholeCamera::FromFieldOfView(100, 100, 87 * kDegree);
  ViewPlanner views{camera, RobotModel{}};
  InspectedSurface surface{criterion, camera, 0.0};
  PathSearch search;
  RigidTransform T_WB = RigidTransform::Identity();
};

}  // namespace thalweg::explorer::test
