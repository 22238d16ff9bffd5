#include "services/visual_odometry/adapter/sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "common/base/angles.h"
#include "common/files/tum.h"
#include "common/files/write_file.h"
#include "services/visual_odometry/adapter/text.h"
#include "services/visual_odometry/core/trajectory_error.h"
#include "services/visual_odometry/core/visual_odometry.h"

namespace thalweg::visual_odometry {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kCalibration =
    "500 0 50 0 0 500 40 0 0 0 1 0\n"
    "500 0 50 -60 0 500 40 0 0 0 1 0\n";

/// A temporary folder for each test, removed afterwards.
class SequenceTest : public testing::Test {
 protected:
  SequenceTest() { fs::create_directories(folder_); }
  ~SequenceTest() override { fs::remove_all(folder_); }

  void Write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  void WriteImage(const std::string& name, int width = 100, int height = 80) const {
    fs::create_directories((folder_ / name).parent_path());
    cv::imwrite((folder_ / name).string(), cv::Mat(height, width, CV_8UC1, cv::Scalar(90)));
  }
  void WriteKitti(int frames) const {
    for (int i = 0; i < frames; ++i) {
      WriteImage("image_0/00000" + std::to_string(i) + ".png");
      WriteImage("image_1/00000" + std::to_string(i) + ".png");
    }
    Write("calib.txt", kCalibration);
  }
  std::string ErrorOfOpen() const {
    try {
      Sequence::Open(folder_);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "opened";
  }
  std::string ErrorOfTrajectory(const std::string& text) const {
    Write("trajectory.txt", text);
    try {
      ReadTrajectory(folder_ / "trajectory.txt", 10.0);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "read";
  }

  fs::path folder_ =
      fs::path(testing::TempDir()) / ("sequence-" + std::to_string(getpid()) + '-' +
                                      testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(SequenceTest, ReadsKittisLayout) {
  WriteKitti(3);
  Write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0.5 0 1 0 0 0 0 1 1\n0 0 1 2 0 1 0 3 -1 0 0 4\n");
  const Sequence sequence = Sequence::Open(folder_);
  EXPECT_EQ(sequence.layout(), "KITTI");
  ASSERT_EQ(sequence.size(), 3U);
  EXPECT_DOUBLE_EQ(sequence.geometry().camera.fx, 500.0);
  EXPECT_DOUBLE_EQ(sequence.geometry().baseline, 0.12);
  EXPECT_EQ(sequence.StampOf(2) - sequence.StampOf(0), std::chrono::milliseconds(200));
  ASSERT_TRUE(sequence.TruthAt(2));
  EXPECT_TRUE(sequence.TruthAt(2)->translation().isApprox(Eigen::Vector3d(2, 3, 4)));
  EXPECT_EQ(sequence.Load(1).left.size(), cv::Size(100, 80));
}

TEST_F(SequenceTest, TakesTheBenchmarksOwnCalibrationAndTimes) {
  WriteKitti(2);
  Write("calib.txt",
        "P0: 500 0 50 0 0 500 40 0 0 0 1 0\nP1: 500 0 50 -250 0 500 40 0 0 0 1 0\n"
        "P2: 500 0 50 9 0 500 40 0 0 0 1 0\nTr: 1 0 0 0 0 1 0 0 0 0 1 0\n");
  Write("times.txt", "0.000000e+00\n1.036224e-01\n");
  const Sequence sequence = Sequence::Open(folder_);
  EXPECT_DOUBLE_EQ(sequence.geometry().baseline, 0.5);
  EXPECT_NEAR(Seconds(sequence.StampOf(1) - sequence.StampOf(0)), 0.1036224, 1e-9);
  EXPECT_FALSE(sequence.TruthAt(0));
}

TEST_F(SequenceTest, NamesTheImageOfAnotherSize) {
  WriteKitti(3);
  WriteImage("image_1/000002.png", 90, 80);
  const Sequence sequence = Sequence::Open(folder_);
  sequence.Load(1);
  try {
    sequence.Load(2);
    FAIL() << "taken";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("image_1/000002.png"), HasSubstr("90 x 80"), HasSubstr("100 x 80")));
  }
}

TEST_F(SequenceTest, NamesWhatIsWrongWithAFolder) {
  EXPECT_THAT(ErrorOfOpen(), HasSubstr("neither image_l or image_0 (KITTI) nor cam0 (EuRoC)"));
  WriteKitti(2);
  WriteImage("image_0/000002.png");
  EXPECT_THAT(ErrorOfOpen(), AllOf(HasSubstr("image_0/000002.png"), HasSubstr("no partner")));
  Write("image_1/000002.png", "this is no image");
  Write("image_0/000000.png", "this is no image");
  EXPECT_THAT(ErrorOfOpen(), AllOf(HasSubstr("image_0/000000.png"), HasSubstr("not an image")));
}

TEST_F(SequenceTest, NamesTheLineOfABrokenCalibration) {
  WriteKitti(2);
  Write("calib.txt", "500 0 50 0 0 500 40 0 0 0 1 0\n500 0 50 -60 0 500 x 0 0 0 1 0\n");
  EXPECT_THAT(ErrorOfOpen(), AllOf(HasSubstr("calib.txt:2"), HasSubstr("\"x\"")));
  Write("calib.txt", "500 0 50 0 0 500 40 0 0 0 1\n");
  EXPECT_THAT(ErrorOfOpen(), AllOf(HasSubstr("calib.txt:1"), HasSubstr("11 numbers")));
  Write("calib.txt", "500 0 50 0 0 500 40 0 0 0 1 0\n");
  EXPECT_THAT(ErrorOfOpen(), AllOf(HasSubstr("calib.txt"), HasSubstr("no projection matrix P1")));
}

TEST_F(SequenceTest, NamesACalibrationThatDoesNotFitTheImages) {
  WriteKitti(2);
  Write("calib.txt", "700 0 601 0 0 700 183 0 0 0 1 0\n700 0 601 -380 0 700 183 0 0 0 1 0\n");
  EXPECT_THAT(ErrorOfOpen(), AllOf(HasSubstr("principal point"), HasSubstr("100 x 80")));
  Write("calib.txt", "500 0 50 -60 0 500 40 0 0 0 1 0\n500 0 50 0 0 500 40 0 0 0 1 0\n");
  EXPECT_THAT(ErrorOfOpen(), HasSubstr("swapped"));
  Write("calib.txt", "500 0 50 0 0 500 40 0 0 0 1 0\n520 0 50 -60 0 500 40 0 0 0 1 0\n");
  EXPECT_THAT(ErrorOfOpen(), HasSubstr("not rectified"));
}

TEST_F(SequenceTest, NamesTruthThatDoesNotFit) {
  WriteKitti(2);
  Write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(ErrorOfOpen(), AllOf(HasSubstr("poses.txt"), HasSubstr("1 poses"), HasSubstr("2 images")));
  Write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 2 0 0 0 0 1 0\n");
  EXPECT_THAT(ErrorOfOpen(), AllOf(HasSubstr("poses.txt:2"), HasSubstr("not a rotation")));
}

TEST_F(SequenceTest, ReadsEurocsLayoutAndRectifies) {
  const auto camera = [](double x) {
    return "%YAML:1.0\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1.0, 0.0, 0.0, " + std::to_string(x) +
           ",\n    0.0, 1.0, 0.0, 0.0,\n    0.0, 0.0, 1.0, 0.0,\n    0.0, 0.0, 0.0, 1.0]\nresolution: [100, "
           "80]\n"
           "intrinsics: [90.0, 90.0, 50.0, 40.0]\ndistortion_model: radial-tangential\n"
           "distortion_coefficients: [-0.1, 0.01, 0.0, 0.0]\n";
  };
  Write("cam0.yaml", camera(0.0));
  Write("cam1.yaml", camera(0.11));
  for (const char* name : {"1403715273262142976", "1403715273312143104"}) {
    WriteImage(std::string("cam0/") + name + ".png");
    WriteImage(std::string("cam1/") + name + ".png");
  }
  Write("groundtruth.csv",
        "#time_ns,px,py,pz,qw,qx,qy,qz\n1403715273262142976,1,2,3,1,0,0,0\n1403715273312143104,1,2,4,1,0,0,"
        "0\n");
  const Sequence sequence = Sequence::Open(folder_);
  EXPECT_EQ(sequence.layout(), "EuRoC");
  EXPECT_NEAR(sequence.geometry().baseline, 0.11, 1e-9);
  EXPECT_EQ((sequence.StampOf(1) - sequence.StampOf(0)).count(), 50000128);
  EXPECT_TRUE(sequence.TruthAt(1)->translation().isApprox(Eigen::Vector3d(1, 2, 4), 1e-9));

  Write("groundtruth.csv", "#\n1403715273262142976,1,2,3,1,0,0,0\n1403715273312143104,1,2,oops,1,0,0,0\n");
  EXPECT_THAT(ErrorOfOpen(), AllOf(HasSubstr("groundtruth.csv:3"), HasSubstr("\"oops\"")));
  Write("cam1.yaml", "%YAML:1.0\nresolution: [100, 80]\nintrinsics: [90.0, 90.0, 50.0]\n");
  EXPECT_THAT(ErrorOfOpen(), AllOf(HasSubstr("cam1.yaml"), HasSubstr("intrinsics has 3 numbers")));
  Write("cam1.yaml", "%YAML:1.0\nresolution: [100, 80\nintrinsics: ]");
  EXPECT_THAT(ErrorOfOpen(), AllOf(HasSubstr("cam1.yaml"), HasSubstr("is not YAML")));
  Write("cam0.yaml", "%YAML:1.0\nresolution: [200, 80]\n");
  EXPECT_THAT(ErrorOfOpen(), HasSubstr("cam0.yaml"));
}

TEST_F(SequenceTest, TrajectoriesNameFileAndLineOfWhatIsWrong) {
  EXPECT_EQ(ErrorOfTrajectory("# a comment\n1.0 0 0 0 0 0 0 1\n2.0 1 0 0 0 0 0 1\n"), "read");
  EXPECT_THAT(ErrorOfTrajectory("1.0 0 0 0 0 0 0 1\n2.0 1 0 0 0 0 0\n"),
              AllOf(HasSubstr("trajectory.txt:2"), HasSubstr("7 numbers")));
  EXPECT_THAT(ErrorOfTrajectory("1.0 0 0 0 0 0 0 1\n\n2.0 1 0 zero 0 0 0 1\n"),
              AllOf(HasSubstr("trajectory.txt:3"), HasSubstr("\"zero\"")));
  EXPECT_THAT(ErrorOfTrajectory("1.0 0 0 nan 0 0 0 1\n"), HasSubstr("not finite"));
  EXPECT_THAT(ErrorOfTrajectory("1.0 0 0 0 0 0 0 0.5\n"), HasSubstr("quaternion"));
  EXPECT_THAT(ErrorOfTrajectory("2.0 0 0 0 0 0 0 1\n1.0 0 0 0 0 0 0 1\n"),
              AllOf(HasSubstr("trajectory.txt:2"), HasSubstr("not later")));
  EXPECT_THAT(ErrorOfTrajectory("# nothing\n"), HasSubstr("no poses"));
  EXPECT_THAT(ErrorOfTrajectory("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1\n"),
              AllOf(HasSubstr("trajectory.txt:2"), HasSubstr("11 numbers")));
}

TEST_F(SequenceTest, ATrajectoryIsTheSameAfterWritingAndReading) {
  std::vector<TimedPose> poses;
  for (int i = 0; i < 5; ++i) {
    poses.push_back({Time(Duration(1403715273262142976LL + i * 50000128LL)),
                     MakeTransform(RotationFromYawPitch(0.3 * i, 0.1 * i), {0.1 * i, -i / 3.0, 2.0})});
  }
  WriteFile(folder_ / "out.tum", TumText(poses));
  const auto read = ReadTrajectory(folder_ / "out.tum", 10.0);
  ASSERT_EQ(read.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(read[i].stamp, poses[i].stamp);
    EXPECT_EQ(read[i].T.translation(), poses[i].T.translation());
    EXPECT_TRUE(read[i].T.isApprox(poses[i].T, 1e-15));
  }
}

TEST_F(SequenceTest, ATrajectoryIsInterpolatedButNotOverAGap) {
  const auto at = [](double s) { return Time(FromSeconds(s)); };
  const auto pose = [](double x) { return MakeTransform(Eigen::Matrix3d::Identity(), {x, 0, 0}); };
  const Trajectory trajectory({{at(1), pose(0)}, {at(2), pose(1)}, {at(9), pose(2)}}, FromSeconds(1.5));
  EXPECT_NEAR(trajectory.At(at(1.25))->translation().x(), 0.25, 1e-12);
  EXPECT_NEAR(trajectory.At(at(9))->translation().x(), 2.0, 1e-12);
  EXPECT_FALSE(trajectory.At(at(5)));
  EXPECT_FALSE(trajectory.At(at(0.9)));
  EXPECT_FALSE(trajectory.At(at(9.1)));
}

/// Runs the odometry along a sequence of real data; skips the test if there is none.
std::vector<PosePair> Follow(const std::string& name, std::size_t first) {
  const char* const data = std::getenv("THALWEG_DATA");
  if (data == nullptr) return {};
  const Sequence sequence = Sequence::Open(fs::path(data) / "vo" / name);
  VisualOdometry odometry(sequence.geometry());
  std::vector<PosePair> poses;
  for (std::size_t i = first; i < sequence.size(); ++i) {
    const PoseEstimate estimate = odometry.Track(sequence.Load(i));
    EXPECT_EQ(estimate.state, TrackingState::kTracking) << i << ' ' << ReasonText(estimate.reason);
    if (const auto truth = sequence.TruthAt(i)) poses.push_back({estimate.stamp, estimate.T_OC, *truth});
  }
  return poses;
}

TEST(RealSequences, KittiIsFollowedToOnePercent) {
  const auto poses = Follow("kitti_sequence_1", 0);
  if (poses.empty())
    GTEST_SKIP() << "set THALWEG_DATA to the folder of the data that is not part of this repository";
  EXPECT_LT(Compare(poses).relative_translation, 0.010);
}

TEST(RealSequences, KittiTurnsAreRightTo5ThousandthsOfADegreeAMeterWhereTheTruthIsMeasured) {
  // Over frames 0 to 11 the ground truth rotates at a constant rate, because it was interpolated there:
  // docs/results/visual-odometry.md.
  const auto poses = Follow("kitti_sequence_1", 12);
  if (poses.empty())
    GTEST_SKIP() << "set THALWEG_DATA to the folder of the data that is not part of this repository";
  EXPECT_LT(Compare(poses).relative_rotation, 0.005 * kDegree);
}

TEST(RealSequences, EurocsStandstillDriftsNoMoreThan5Millimeters) {
  const auto poses = Follow("euroc_v101_standstill", 0);
  if (poses.empty())
    GTEST_SKIP() << "set THALWEG_DATA to the folder of the data that is not part of this repository";
  EXPECT_LT(Compare(poses).drift_max, 0.005);
}

}  // namespace
}  // namespace thalweg::visual_odometry
