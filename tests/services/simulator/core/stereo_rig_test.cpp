#include "services/simulator/core/stereo_rig.h"

#include <gtest/gtest.h>

#include "tests/services/simulator/core/simple_scenes.h"
#include "tests/support/meshes.h"

namespace thalweg::simulator {
namespace {

using test::kAhead;
using test::kSensorBounds;
using test::WallAt;

StereoRigModel SmallRig() {
  StereoRigModel model;
  model.camera = PinholeCamera::FromFieldOfView(128, 96, 1.15);
  return model;
}

TEST(StereoRig, TheRightImageIsTheLeftOneShiftedByTheDisparity) {
  const StereoRigModel model = SmallRig();
  constexpr int kDisparity = 8;
  StereoRig rig(model);
  const StereoPair pair = rig.Capture(WallAt(model.camera.fx * model.baseline / kDisparity), kAhead);
  for (int v = 0; v < model.camera.height_px; ++v) {
    for (int u = kDisparity; u < model.camera.width_px; ++u) {
      const auto left = static_cast<std::size_t>(v * model.camera.width_px + u);
      ASSERT_NEAR(pair.left.data[left], pair.right.data[left - kDisparity], 1) << u << ' ' << v;
    }
  }
}

TEST(StereoRig, APlaceKeepsItsGrayValueWhenTheCameraMoves) {
  const World world = WallAt(2.0);
  const StereoRigModel model = SmallRig();
  StereoRig rig(model);
  // Shifted sideways by the width of four pixels on the wall.
  const Eigen::Vector3d aside = 4.0 * 2.0 / model.camera.fx * -Eigen::Vector3d::UnitY();
  const StereoPair first = rig.Capture(world, kAhead);
  const StereoPair second = rig.Capture(world, MakeTransform(BodyFromOptical(), aside));
  for (std::size_t u = 4; u < 128; ++u) {
    ASSERT_NEAR(first.left.data[48 * 128 + u], second.left.data[48 * 128 + u - 4], 1) << u;
  }
}

TEST(StereoRig, DepthIsThatOfTheClosedForm) {
  const auto room = test::AnalyticRoom::Furnished();
  const World world(test::MeshOf(room), kSensorBounds);
  const StereoRigModel model = SmallRig();
  StereoRig rig(model);
  std::mt19937 random(9);
  const RigidTransform T_WC = room.RandomPose(random);
  const StereoPair pair = rig.Capture(world, T_WC);
  const PointCloud expected = room.Render(model.camera, T_WC);
  int edges = 0;
  for (std::size_t i = 0; i < pair.depth.size(); ++i) {
    edges += std::abs(pair.depth[i] - expected.points_C[i].z()) > 1e-4F;
  }
  EXPECT_LE(edges, 2);
}

TEST(StereoRig, WhereNothingIsThereIsNoDepth) {
  StereoRig rig(SmallRig());
  const StereoPair pair = rig.Capture(WallAt(-3.0), kAhead);
  for (const float depth : pair.depth) ASSERT_TRUE(std::isnan(depth));
}

TEST(StereoRig, ASurfaceHasSomethingToMatchAtAnyDistance) {
  for (const double distance : {0.5, 1.0, 2.0, 5.0}) {
    StereoRigModel model;
    StereoRig rig(model);
    const StereoPair pair = rig.Capture(WallAt(distance), kAhead);
    double steps = 0.0;  // mean difference of horizontal neighbors
    for (std::size_t i = 1; i < pair.left.data.size(); ++i) {
      steps += std::abs(pair.left.data[i] - pair.left.data[i - 1]);
    }
    EXPECT_GT(steps / static_cast<double>(pair.left.data.size()), 1.5) << distance;
  }
}

TEST(StereoRig, NoiseHasTheAskedForSpreadAndDiffersBetweenEyesAndPictures) {
  StereoRigModel model = SmallRig();
  const World world = WallAt(2.0);
  const StereoPair clean = StereoRig(model).Capture(world, kAhead);
  model.noise_sigma = 4.0;
  StereoRig rig(model, 11);
  const StereoPair first = rig.Capture(world, kAhead);
  const StereoPair second = rig.Capture(world, kAhead);
  const auto n = static_cast<double>(clean.left.data.size());
  double squares = 0.0;
  double products = 0.0;
  for (std::size_t i = 0; i < clean.left.data.size(); ++i) {
    const double a = first.left.data[i] - clean.left.data[i];
    const double b = second.left.data[i] - clean.left.data[i];
    squares += a * a;
    products += a * b;
  }
  EXPECT_NEAR(std::sqrt(squares / n), 4.0, 0.15);
  EXPECT_NEAR(products / n, 0.0, 0.6);
  EXPECT_NE(first.left.data, first.right.data);
}

TEST(StereoRig, AnEdgeIsSmoothedOverThePixelsThatItCrosses) {
  // A bright quad in front of nothing, its edge slightly slanted: pixels along the edge take intermediate
  // values.
  Mesh mesh;
  test::AddQuad(mesh, {2, -5, -5}, {0, 4.8, 0.6}, {0, -0.6, 9});
  const World world(mesh, kSensorBounds);
  const auto values_along_the_edge = [&](int samples) {
    StereoRigModel model = SmallRig();
    model.edge_samples = samples;
    const StereoPair pair = StereoRig(model).Capture(world, kAhead);
    int between = 0;
    for (std::size_t row = 10; row < 86; ++row) {
      for (std::size_t u = 1; u < 127; ++u) {
        const int before = pair.left.data[row * 128 + u - 1];
        const int here = pair.left.data[row * 128 + u];
        const int after = pair.left.data[row * 128 + u + 1];
        const bool edge =
            std::isnan(pair.depth[row * 128 + u - 1]) != std::isnan(pair.depth[row * 128 + u + 1]);
        between += edge && std::abs(here - before) > 8 && std::abs(here - after) > 8;
      }
    }
    return between;
  };
  EXPECT_GT(values_along_the_edge(3), values_along_the_edge(1) + 20);
}

TEST(StereoRig, ColorHasThreeChannels) {
  StereoRigModel model = SmallRig();
  model.color = true;
  const StereoPair pair = StereoRig(model).Capture(WallAt(2.0), kAhead);
  EXPECT_EQ(pair.left.channels, 3);
  EXPECT_EQ(pair.left.data.size(), 128U * 96 * 3);
}

TEST(StereoRig, RefusesACameraWithoutPixels) {
  StereoRigModel model;
  model.camera.width_px = 0;
  EXPECT_THROW(StereoRig{model}, std::invalid_argument);
}

}  // namespace
}  // namespace thalweg::simulator
