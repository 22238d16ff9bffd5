#include "common/surface_graph/view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/common/surface_graph/scenes.h"

namespace thalweg::surface {
namespace {

using test::Rig;
using testing::HasSubstr;

TEST(SurfaceView, APointAppearsInThePixelThatShowsIt) {
  View view{.rig = {{64, 48, 50.0, 60.0, 30.2, 23.9}, 0.1}, .disparities = {}, .colors = {}};
  view.disparities.assign(64 * 48, 2.5F);
  for (std::size_t pixel = 0; pixel < view.disparities.size(); pixel += 37) {
    const Eigen::Vector3d p_C = view.PointAt(pixel);
    EXPECT_NEAR(p_C.z(), 50.0 * 0.1 / 2.5, 1e-12);
    EXPECT_EQ(view.PixelOf(p_C), pixel);
  }
  EXPECT_FALSE(view.PixelOf({0.0, 0.0, -1.0}));
  EXPECT_FALSE(view.PixelOf({5.0, 0.0, 1.0}));
}

TEST(SurfaceView, DepthsBecomeDisparitiesAndDepthsAgain) {
  const StereoGeometry rig = Rig(4, 1, 100.0);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const View view{
      .rig = rig,
      .disparities = DisparitiesOf({4, 1, {2.0F, nan, std::numeric_limits<float>::infinity(), -1.0F}}, rig),
      .colors = {}};
  EXPECT_NEAR(view.DepthAt(0), 2.0, 1e-6);
  for (const std::size_t pixel : {1, 2, 3}) EXPECT_FALSE(view.IsValid(pixel)) << pixel;
}

TEST(SurfaceView, APixelThatShowsWhatIsFartherThanAnythingIsNotValid) {
  const View view{.rig = Rig(2, 1, 100.0), .disparities = {1e-42F, 1e-3F}, .colors = {}};
  EXPECT_FALSE(view.IsValid(0));
  EXPECT_TRUE(view.IsValid(1));
}

TEST(SurfaceView, MistakesAreNamed) {
  View good{.rig = Rig(4, 3, 100.0), .disparities = std::vector<float>(12, 1.0F), .colors = {}};
  good.disparities[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(MistakeIn(good));
  const auto mistake = [&](const auto& spoil) {
    View view = good;
    spoil(view);
    return MistakeIn(view).value_or("none");
  };
  EXPECT_THAT(mistake([](View& view) { view.rig.camera.width_px = 5; }),
              HasSubstr("12 disparities for a camera of 5 x 3"));
  EXPECT_THAT(mistake([](View& view) { view.colors.push_back({}); }), HasSubstr("1 colors"));
  EXPECT_THAT(mistake([](View& view) { view.rig.camera.fx = 0.0; }), HasSubstr("focal length"));
  EXPECT_THAT(mistake([](View& view) { view.rig.camera.cy = NAN; }), HasSubstr("principal point"));
  EXPECT_THAT(mistake([](View& view) { view.rig.baseline = -0.1; }), HasSubstr("baseline is -0.1"));
  EXPECT_THAT(mistake([](View& view) { view.T_WC.linear() *= 2.0; }), HasSubstr("pose"));
  EXPECT_THAT(mistake([](View& view) { view.T_WC.translation().x() = NAN; }), HasSubstr("pose"));
  EXPECT_THAT(mistake([](View& view) { view.T_WC.translation().x() = 1e300; }), HasSubstr("pose"));
  EXPECT_THAT(mistake([](View& view) { view.rig.camera.fx = 1e300; }), HasSubstr("focal length"));
  EXPECT_THAT(mistake([](View& view) { view.rig.camera.height_px = 0; }), HasSubstr("empty"));
}

}  // namespace
}  // namespace thalweg::surface
