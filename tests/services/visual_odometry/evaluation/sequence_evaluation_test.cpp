#include "services/visual_odometry/evaluation/sequence_evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace thalweg::visual_odometry {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

RigidTransform At(double x) {
  return MakeTransform(Eigen::Matrix3d::Identity(), {x, 0.0, 0.0});
}

/// An estimate that is correct except for its scale, 1 % too large, in a frame with another origin.
SequenceEvaluation ScaledByOnePercent() {
  const RigidTransform T_WO = MakeTransform(RotationFromYawPitch(std::numbers::pi / 2, 0.0), {5.0, 6.0, 7.0});
  SequenceEvaluation evaluation;
  evaluation.layout = "KITTI";
  evaluation.frames = 22;
  evaluation.states = {19, 2, 1};
  evaluation.recognized = 3;
  evaluation.places = 4;
  evaluation.time = {.count = 22, .p50_ms = 1.0, .p95_ms = 2.0, .max_ms = 3.0};
  for (int k = 0; k <= 21; ++k) {
    const Time stamp{FromSeconds(k)};
    evaluation.trajectory.push_back({stamp, At(1.01 * k)});
    evaluation.compared.push_back({stamp, At(1.01 * k), T_WO * At(k)});
  }
  evaluation.error = Compare(evaluation.compared);
  return evaluation;
}

TEST(SequenceEvaluation, DescribesWhatWasFoundAndHowFarOffItIs) {
  const std::vector<std::string> lines = Describe(ScaledByOnePercent());
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[0], "KITTI, 22 frames: 19 tracking, 2 degraded, 1 lost; 4 places kept, recognized 3 times");
  EXPECT_EQ(lines[1], "ms per frame: median 1.0, 95 % 2.0, max 3.0");
  EXPECT_THAT(lines[2], HasSubstr("path 21.00 m"));
  EXPECT_THAT(lines[2], HasSubstr("end off by 0.2100 m (max 0.2100) and 0.000 deg"));
  EXPECT_EQ(lines[3], "relative errors: 1.000 %, 0.00000 deg/m");
  EXPECT_EQ(lines[4], "within the 95 % ellipsoid: position - %, rotation - % of the frames")
      << "there are no covariances";
  EXPECT_THAT(DescribeByLength(ScaledByOnePercent()), ElementsAre(HasSubstr("10 m, "), HasSubstr("20 m, ")));
}

TEST(SequenceEvaluation, WithoutTruthThereIsNothingToCompareWith) {
  SequenceEvaluation evaluation = ScaledByOnePercent();
  evaluation.compared.clear();
  evaluation.error.reset();
  EXPECT_EQ(Describe(evaluation).back(), "no ground truth to compare with");
  EXPECT_TRUE(DescribeByLength(evaluation).empty());
  EXPECT_TRUE(ToJson(evaluation)["error"].is_null());
  EXPECT_TRUE(PathsOf(evaluation).truth.empty());
  EXPECT_EQ(PathsOf(evaluation).estimated.back().x(), 1.01 * 21);
}

TEST(SequenceEvaluation, JsonHasUnitsAndNullForWhatIsNotKnown) {
  const auto json = nlohmann::ordered_json::parse(ToJson(ScaledByOnePercent()).dump());
  EXPECT_EQ(json["frames"], 22);
  EXPECT_EQ(json["states"].size(), 3U);
  EXPECT_EQ(json["frame_time_ms"]["max"], 3.0);
  EXPECT_NEAR(json["error"]["drift_m"].get<double>(), 0.21, 1e-9);
  EXPECT_NEAR(json["error"]["relative_translation_percent"].get<double>(), 1.0, 1e-9);
  EXPECT_TRUE(json["error"]["inside_95_percent"]["position"].is_null());
  EXPECT_EQ(json["error"]["by_length"].size(), 2U);
}

TEST(SequenceEvaluation, SaysWhetherTheCalibrationIsOff) {
  SequenceEvaluation evaluation = ScaledByOnePercent();
  evaluation.calibration = CalibrationFinding();
  EXPECT_THAT(Describe(evaluation)[2], HasSubstr("calibration: good;"));
  evaluation.calibration->off_probability = 0.99;
  evaluation.calibration->offset_px = 0.84;
  evaluation.calibration->left_px = 0.06;
  EXPECT_THAT(Describe(evaluation)[2], HasSubstr("off by about 0.8 px, corrected to 0.06 px"));
  EXPECT_EQ(ToJson(evaluation)["calibration"]["offset_px"], 0.84);
}

TEST(Bent, MovesARampByTheBend) {
  const PinholeCamera camera = PinholeCamera::FromFieldOfView(200, 40, 1.2);
  cv::Mat ramp(40, 200, CV_8UC1);
  for (int v = 0; v < ramp.rows; ++v) {
    for (int u = 0; u < ramp.cols; ++u) ramp.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(u + v);
  }
  const cv::Mat bent = Bent(ramp, camera, {4.0, 10.0}, 2.0);
  for (int u = 20; u < 180; ++u) {
    const double x = (u - camera.cx) / camera.fx;
    EXPECT_NEAR(bent.at<std::uint8_t>(20, u), u + 20 - 4.0 - 10.0 * x * x - 2.0, 1.0) << u;
  }
}

TEST(SequenceEvaluation, PathsBeginWhereTheTruthDoes) {
  const Paths paths = PathsOf(ScaledByOnePercent());
  ASSERT_EQ(paths.estimated.size(), paths.truth.size());
  EXPECT_TRUE(paths.estimated.front().isApprox(paths.truth.front(), 1e-12));
  EXPECT_NEAR((paths.estimated.back() - paths.truth.back()).norm(), 0.21, 1e-9);
}

}  // namespace
}  // namespace thalweg::visual_odometry
