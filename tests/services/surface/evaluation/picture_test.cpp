#include "services/surface/evaluation/picture.h"

#include <gtest/gtest.h>

#include "tests/common/surface_graph/scenes.h"

namespace thalweg::surface {
namespace {

/// Pixels that are clearly red, green or blue.
struct Pixels {
  explicit Pixels(const cv::Mat& picture) {
    for (auto at = picture.begin<cv::Vec3b>(); at != picture.end<cv::Vec3b>(); ++at) {
      const int b = (*at)[0];
      const int g = (*at)[1];
      const int r = (*at)[2];
      red += r > g + 60 && r > b + 60;
      green += g > r + 20 && g > b + 20;
      blue += b > r + 60 && b > g + 60;
      white += r > 250 && g > 250 && b > 250;
      all += 1;
    }
  }
  int red = 0, green = 0, blue = 0, white = 0, all = 0;
};

Surface SurfaceOf(double (*depth)(const Eigen::Vector3d&, const Eigen::Vector3d&)) {
  Surface surface({});
  surface.Add(test::ViewOf(test::Rig(240, 180, 160.0), RigidTransform::Identity(), depth));
  return surface;
}

double Plane(const Eigen::Vector3d& o, const Eigen::Vector3d& r) {
  return test::PlaneAt(2.0, o, r);
}

/// A little beside the camera, so that the rift of a step is not seen end on.
Viewpoint Beside() {
  return {PinholeCamera::FromFieldOfView(640, 480, 1.0), test::Shifted({0.8, 0.0, -0.5})};
}

TEST(WeightColor, GoesFromGreenOverYellowToRed) {
  EXPECT_GT(WeightColor(0.0, 0.1).g, 2 * WeightColor(0.0, 0.1).r);
  EXPECT_GT(WeightColor(0.05, 0.1).r, 200);
  EXPECT_GT(WeightColor(0.05, 0.1).g, 200);
  EXPECT_GT(WeightColor(0.1, 0.1).r, 5 * WeightColor(0.1, 0.1).g);
  EXPECT_EQ(WeightColor(3.0, 0.1), WeightColor(0.1, 0.1));
}

TEST(SurfacePictures, EdgesOfAPlaneAreGreenAndThoseOfAStepAlsoRed) {
  const Pixels plane(DrawEdges(SurfaceOf(Plane), Beside()));
  EXPECT_GT(plane.green, plane.all / 10);
  EXPECT_EQ(plane.red, 0);
  EXPECT_GT(plane.white, 0) << "the plane ends within the picture";
  const Pixels step(DrawEdges(SurfaceOf(test::StepAt), Beside()));
  EXPECT_GT(step.green, step.all / 10);
  EXPECT_GT(step.red, step.all / 100);
}

TEST(SurfacePictures, TheDominantRiftIsRedAndTheTrajectoryBlue) {
  Surface surface = SurfaceOf(test::StepAt);
  const Move move = surface.PlanMove();
  ASSERT_FALSE(move.poses.empty());
  const Viewpoint from = BesideFirstCamera(surface);
  const Pixels rifts(DrawRifts(surface, move, from));
  EXPECT_GT(rifts.red, 100);
  EXPECT_EQ(rifts.blue, 0);
  const Pixels trajectory(DrawTrajectory(surface, move, 4, from));
  EXPECT_GT(trajectory.red, 100);
  EXPECT_GT(trajectory.blue, 100);
}

TEST(SurfacePictures, HideWhatIsBehindAndLeaveOutBacks) {
  const Surface surface = SurfaceOf(Plane);
  const Move none;
  const Viewpoint front = Beside();
  EXPECT_LT(Pixels(DrawRifts(surface, none, front)).white, Pixels(DrawRifts(surface, none, front)).all);
  Viewpoint back = front;
  back.T_WC = MakeTransform(Eigen::AngleAxisd(3.14159, Eigen::Vector3d::UnitY()).toRotationMatrix(),
                            Eigen::Vector3d(0.0, 0.0, 4.0));
  const Pixels from_behind(DrawRifts(surface, none, back));
  EXPECT_EQ(from_behind.white, from_behind.all);
}

TEST(BesideFirstCamera, HasMostOfTheSurfaceInThePicture) {
  const Surface surface = SurfaceOf(test::StepAt);
  const Viewpoint from = BesideFirstCamera(surface);
  std::size_t seen = 0;
  for (SurfaceGraph::Vertex vertex = 0; vertex < surface.vertex_count(); ++vertex) {
    seen += from.camera.Sees(from.T_WC.inverse() * surface.graph().Position(vertex).cast<double>()) ? 1U : 0U;
  }
  EXPECT_GT(seen, surface.vertex_count() * 9 / 10);
}

TEST(VertexColors, AreThoseOfTheFirstViewThatShowedThem) {
  auto [a, b] = test::PlaneTwice(test::Rig(60, 40, 50.0), 2.0, 17);
  a.colors.assign(60 * 40, {1, 1, 1});
  b.colors.assign(60 * 40, {2, 2, 2});
  Surface surface({});
  surface.Add(a);
  surface.Add(b);
  const std::vector<Rgb> colors = VertexColors(surface);
  ASSERT_EQ(colors.size(), 77U * 40U);
  for (std::size_t i = 0; i < colors.size(); ++i) EXPECT_EQ(colors[i].r, i < 60U * 40U ? 1 : 2);
}

}  // namespace
}  // namespace thalweg::surface
