#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "services/stereo/adapter/calibration_file.h"
#include "services/stereo/adapter/image_files.h"

namespace thalweg::stereo {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

class Files : public testing::Test {
 protected:
  Files() { fs::create_directories(folder_); }
  ~Files() override { fs::remove_all(folder_); }

  fs::path Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  static std::string Text(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }

  fs::path folder_ = fs::temp_directory_path() / ("stereo_files_" + std::to_string(getpid()));
};

constexpr auto kGood = R"(%YAML:1.0
---
image_width: 640
image_height: 480
M1: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 500., 0., 320., 0., 501., 240., 0., 0., 1. ] }
D1: !!opencv-matrix { rows: 1, cols: 5, dt: d, data: [ 0.1, 0., 0., 0., 0. ] }
K2: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 502., 0., 321., 0., 503., 241., 0., 0., 1. ] }
D2: !!opencv-matrix { rows: 5, cols: 1, dt: d, data: [ 0., 0., 0., 0., 0.2 ] }
R: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ] }
T: !!opencv-matrix { rows: 3, cols: 1, dt: d, data: [ -0.1, 0., 0. ] }
)";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST_F(Files, CalibrationIsReadAsOpenCvWritesIt) {
  const StereoCalibration c = ReadCalibration({Write("c.yml", kGood)});
  EXPECT_EQ(c.left.width_px, 640);
  EXPECT_EQ(c.right.height_px, 480);
  EXPECT_EQ(c.left.K(1, 1), 501.0);
  EXPECT_EQ(c.right.K(0, 2), 321.0);
  EXPECT_THAT(c.right.distortion, testing::ElementsAre(0, 0, 0, 0, 0.2));
  EXPECT_EQ(c.T_RL.translation().x(), -0.1);
}

TEST_F(Files, CalibrationComesBackAsWritten) {
  CalibrationResult result;
  result.calibration = ReadCalibration({Write("c.yml", kGood)});
  WriteCalibration(folder_ / "d.yml", result);
  const StereoCalibration c = ReadCalibration({folder_ / "d.yml"});
  EXPECT_EQ(c.left.K, result.calibration.left.K);
  EXPECT_EQ(c.right.distortion, result.calibration.right.distortion);
  EXPECT_EQ(c.T_RL.matrix(), result.calibration.T_RL.matrix());
}

TEST_F(Files, BadCalibrationsAreRefusedNamingFileAndField) {
  const auto refused = [&](const std::string& text, const std::string& field) {
    const fs::path file = Write("bad.yml", text);
    EXPECT_THAT([&] { ReadCalibration({file}); },
                ThrowsMessage<std::runtime_error>(StartsWith(file.string() + ": " + field)));
  };
  refused(Replaced(kGood, "500.", ".Nan"), "left K contains a non-finite value");
  refused(Replaced(kGood, "502.", "-5."), "right K has a focal length");
  refused(Replaced(kGood, "image_width: 640", "image_width: wide"), "image_width is missing");
  refused(Replaced(kGood, "image_width: 640", "image_width: 0"), "left image size is 0 x 480");
  refused(Replaced(kGood, "D2", "D3"), "D2 is missing");
  refused(Replaced(kGood, "rows: 3, cols: 1, dt: d, data: [ -0.1, 0., 0. ]",
                   "rows: 2, cols: 1, dt: d, data: [ -0.1, 0. ]"),
          "T is 2 x 1, must be 3 x 1");
  refused(Replaced(kGood, "[ -0.1, 0., 0. ]", "[ 0.1, 0., 0. ]"), "T does not put the right camera");
  refused(Replaced(kGood, "data: [ 1.,", "data: [ 2.,"), "R is not a rotation");
  refused("%YAML:1.0\n---\nM1: [", "is not YAML");
  EXPECT_THAT([&] { ReadCalibration({folder_ / "none.yml"}); },
              ThrowsMessage<std::runtime_error>(HasSubstr("none.yml: cannot be read")));
}

/// OpenCV's stereo_calib writes two files and no image size.
TEST_F(Files, CalibrationInTwoFilesTakesItsSizeFromTheImages) {
  std::string text = Replaced(kGood, "image_width: 640\nimage_height: 480\n", "");
  const std::size_t at = text.find("R:");
  const fs::path intrinsics = Write("intrinsics.yml", text.substr(0, at));
  const fs::path extrinsics = Write("extrinsics.yml", "%YAML:1.0\n---\n" + text.substr(at));
  const StereoCalibration c = ReadCalibration({intrinsics, extrinsics}, ImageSize{700, 500});
  EXPECT_EQ(c.left.K(1, 1), 501.0);
  EXPECT_EQ(c.T_RL.translation().x(), -0.1);
  EXPECT_EQ(c.right.width_px, 700);
  const auto refused = [](const std::vector<fs::path>& files, const std::optional<ImageSize>& size,
                          const std::string& what) {
    EXPECT_THAT([&] { ReadCalibration(files, size); }, ThrowsMessage<std::runtime_error>(HasSubstr(what)));
  };
  refused({intrinsics, extrinsics}, std::nullopt, "add those of the images");
  refused({intrinsics}, ImageSize{700, 500},
          "R is missing: OpenCV's stereo_calib writes it to extrinsics.yml");
  refused({extrinsics}, ImageSize{700, 500},
          "M1 is missing: OpenCV's stereo_calib writes it to intrinsics.yml");
}

TEST_F(Files, ImagesComeBackAsWritten) {
  ByteImage image(7, 5, 3);
  for (std::size_t i = 0; i < image.data().size(); ++i) image.data()[i] = static_cast<std::uint8_t>(2 * i);
  WriteImage(folder_ / "image.png", image);
  EXPECT_EQ(ReadImage(folder_ / "image.png"), image);
}

TEST_F(Files, ImagesThatAreNoneAreRefusedByName) {
  cv::imwrite((folder_ / "deep.png").string(), cv::Mat(4, 4, CV_16U, cv::Scalar(900)));
  EXPECT_THAT([&] { ReadImage(folder_ / "deep.png"); },
              ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("deep.png"), HasSubstr("8"))));
  WriteImage(folder_ / "good.png", ByteImage(50, 50, 1, 3));
  const fs::path cut = Write("cut.png", Text(folder_ / "good.png").substr(0, 20));
  EXPECT_THAT([&] { ReadImage(cut); }, ThrowsMessage<std::runtime_error>(HasSubstr("cut.png")));
  EXPECT_THAT([&] { ReadImage(folder_); },
              ThrowsMessage<std::runtime_error>(HasSubstr("is not a readable image")));
}

TEST_F(Files, APfmsScaleIsOnlyTheOrderOfItsBytes) {
  const auto with = [this](const std::string& scale, bool swapped) {
    std::string bytes = "Pf\n2 1\n" + scale + "\n";
    for (float value : {3.5F, 7.25F}) {
      std::string four(sizeof(value), '\0');
      std::memcpy(four.data(), &value, sizeof(value));
      if (swapped) std::reverse(four.begin(), four.end());
      bytes += four;
    }
    return ReadScaledDisparity(Write("truth.pfm", bytes), 1.0);
  };
  for (const char* scale : {"-1", "-1.0", "-0.003922", "-4"}) {
    EXPECT_EQ(with(scale, false)(0, 0), 3.5F) << scale;
    EXPECT_EQ(with(scale, false)(1, 0), 7.25F) << scale;
  }
  EXPECT_EQ(with("0.003922", true)(1, 0), 7.25F);
}

TEST_F(Files, AJpegThatIsCutShortIsRefused) {
  const cv::Mat noise(80, 100, CV_8UC1);
  cv::randu(noise, 0, 256);
  cv::imwrite((folder_ / "whole.jpg").string(), noise);
  EXPECT_NO_THROW(ReadImage(folder_ / "whole.jpg"));
  const std::string whole = Text(folder_ / "whole.jpg");
  EXPECT_NO_THROW(ReadImage(Write("more.jpg", whole + "appended")));
  for (const std::size_t length : {whole.size() / 4, whole.size() / 2, whole.size() - 2}) {
    EXPECT_THAT([&] { ReadImage(Write("cut.jpg", whole.substr(0, length))); },
                ThrowsMessage<std::runtime_error>(HasSubstr("cut.jpg: is not a readable image")));
  }
}

TEST_F(Files, PfmHasRowsFromBelowAndInfinityForNone) {
  DisparityMap disparity(2, 2);
  disparity.data() = {1.5F, kNoDisparity, 3.0F, 4.0F};
  WritePfm(folder_ / "d.pfm", disparity);
  const std::string bytes = Text(folder_ / "d.pfm");
  const std::string head = "Pf\n2 2\n-1\n";
  ASSERT_TRUE(bytes.starts_with(head));
  ASSERT_EQ(bytes.size(), head.size() + 16);
  float values[4];
  std::memcpy(values, bytes.data() + head.size(), 16);
  EXPECT_EQ(values[0], 3.0F);
  EXPECT_EQ(values[1], 4.0F);
  EXPECT_EQ(values[2], 1.5F);
  EXPECT_TRUE(std::isinf(values[3]));
}

TEST_F(Files, ColorsGoFromBlueFarToRedNear) {
  DisparityMap disparity(3, 1);
  disparity.data() = {0.0F, 63.0F, kNoDisparity};
  WriteColored(folder_ / "d.png", disparity, 64.0);
  const ByteImage colors = ReadImage(folder_ / "d.png");
  const std::uint8_t* const c = colors.Row(0);
  EXPECT_GT(c[2], 100);
  EXPECT_EQ(c[0], 0);
  EXPECT_GT(c[3], 100);
  EXPECT_EQ(c[5], 0);
  EXPECT_EQ(c[6] + c[7] + c[8], 0);
}

TEST_F(Files, PlyHasThePointsThatAreThere) {
  PointCloud cloud;
  cloud.width_px = 2;
  cloud.height_px = 1;
  cloud.points_C = {{1, 2, 3}, {NAN, NAN, NAN}};
  cloud.colors = {{10, 20, 30}, {}};
  WritePly(folder_ / "c.ply", cloud);
  const std::string bytes = Text(folder_ / "c.ply");
  EXPECT_THAT(bytes, HasSubstr("element vertex 1\n"));
  const std::string tail = bytes.substr(bytes.find("end_header\n") + 11);
  ASSERT_EQ(tail.size(), 15U);
  float z = 0.0F;
  std::memcpy(&z, tail.data() + 8, 4);
  EXPECT_EQ(z, 3.0F);
  EXPECT_EQ(tail[14], 30);
}

TEST_F(Files, GroundTruthIsScaledAndZeroIsUnknown) {
  ByteImage image(3, 1);
  image.data() = {0, 16, 40};
  WriteImage(folder_ / "gt.png", image);
  const DisparityMap truth = ReadScaledDisparity(folder_ / "gt.png", 8.0);
  EXPECT_TRUE(std::isnan(truth(0, 0)));
  EXPECT_EQ(truth(1, 0), 2.0F);
  EXPECT_EQ(truth(2, 0), 5.0F);
}

}  // namespace
}  // namespace thalweg::stereo
