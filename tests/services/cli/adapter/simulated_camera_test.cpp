#include "services/cli/adapter/simulated_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/simulator/adapter/load_mesh.h"

namespace thalweg::cli {
namespace {

using testing::HasSubstr;

const std::vector<std::string> kSmall = {"stereo_camera.width_px=160", "stereo_camera.height_px=120"};

/// [m] Distances of a view's points to the true surfaces of the tiny room, ascending.
std::vector<double> ErrorsOf(const surface::View& view) {
  static const simulator::World world = simulator::LoadWorld(LoadScenario("tiny"));
  std::vector<double> errors;
  for (std::size_t pixel = 0; pixel < view.disparities.size(); ++pixel) {
    if (view.IsValid(pixel)) {
      errors.push_back(world.DistanceToSurface(view.T_WC * view.PointAt(pixel), 1.0));
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

TEST(SimulatedCamera, ExactDisparitiesLieOnTheSurfaces) {
  SimulatedCamera camera("tiny", kSmall, true);
  const surface::View view = camera.Look(camera.StartPose());
  EXPECT_FALSE(MistakeIn(view));
  EXPECT_EQ(view.colors.size(), 160U * 120U);
  const std::vector<double> errors = ErrorsOf(view);
  ASSERT_EQ(errors.size(), 160U * 120U) << "a closed room";
  EXPECT_LT(errors.back(), 1e-4);
}

TEST(SimulatedCamera, MatchedDisparitiesLieNearTheSurfaces) {
  SimulatedCamera camera("tiny", kSmall, false);
  const std::vector<double> errors = ErrorsOf(camera.Look(camera.StartPose()));
  ASSERT_GT(errors.size(), 160U * 120U / 2);
  EXPECT_LT(errors[errors.size() / 2], 0.02);
}

// The room is 3 x 2.5 x 1.6 m; the camera starts at (0.9, 1.3, 0.8) and looks along x.
TEST(SimulatedCamera, GoesOnlyWhereTheRobotFits) {
  SimulatedCamera camera("tiny", kSmall, true);
  const auto refusal = [&](const Eigen::Vector3d& p_W, const Eigen::Vector3d& above_W) -> std::string {
    const auto view = camera.LookFromAbove(MakeTransform(BodyFromOptical(), p_W), above_W);
    return view ? "none" : view.error();
  };
  const Eigen::Vector3d start_W = camera.StartPose().translation();
  const Eigen::Vector3d floor_W(start_W.x(), start_W.y(), 0.05);
  EXPECT_EQ(refusal(start_W, floor_W), "none");
  EXPECT_THAT(refusal({start_W.x(), start_W.y(), 0.08}, floor_W), HasSubstr("touch"));
  EXPECT_THAT(refusal({start_W.x(), start_W.y(), 9.0}, floor_W), HasSubstr("outside"));
  EXPECT_THAT(refusal(start_W, {start_W.x(), start_W.y(), -1.0}), HasSubstr("a surface stands between"));
}

}  // namespace
}  // namespace thalweg::cli
