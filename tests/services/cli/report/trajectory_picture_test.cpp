#include "services/cli/report/trajectory_picture.h"

#include <gtest/gtest.h>

#include "tests/services/cli/report/example_run.h"

namespace thalweg::cli {
namespace {

using test::PixelsOf;

TEST(TrajectoryPicture, ShowsThePathOverTheTrueOne) {
  TrajectoryPicture picture{"a path", {"with text"}, {}, {}};
  for (int i = 0; i <= 50; ++i) {
    picture.path.emplace_back(0.2 * i, 0.02 * i, 0.1);
    picture.true_path.emplace_back(0.2 * i, 0.0, 0.0);
  }
  const cv::Mat both = Draw(picture);
  const cv::Scalar truth(92, 138, 46);
  const cv::Scalar path(148, 98, 24);
  EXPECT_GT(PixelsOf(both, path), 500);
  EXPECT_GT(PixelsOf(both, truth), 1000);
  picture.true_path.clear();
  EXPECT_EQ(PixelsOf(Draw(picture), truth), 0);
}

TEST(TrajectoryPicture, IsDrawnForACameraThatStandsAndForNone) {
  TrajectoryPicture picture{"standing", {}, {Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(1, 2, 3)}, {}};
  EXPECT_FALSE(Draw(picture).empty());
  picture.path.clear();
  EXPECT_FALSE(Draw(picture).empty());
}

}  // namespace
}  // namespace thalweg::cli
