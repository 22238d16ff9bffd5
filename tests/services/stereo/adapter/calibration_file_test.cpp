#include "services/stereo/adapter/calibration_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/services/stereo/adapter/files_fixture.h"

namespace thalweg::stereo {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

class CalibrationFile : public test::FilesTest {};

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

TEST_F(CalibrationFile, CalibrationIsReadAsOpenCvWritesIt) {
  const StereoCalibration c = ReadCalibration({Write("c.yml", kGood)});
  EXPECT_EQ(c.left.width_px, 640);
  EXPECT_EQ(c.right.height_px, 480);
  EXPECT_EQ(c.left.K(1, 1), 501.0);
  EXPECT_EQ(c.right.K(0, 2), 321.0);
  EXPECT_THAT(c.right.distortion, testing::ElementsAre(0, 0, 0, 0, 0.2));
  EXPECT_EQ(c.T_RL.translation().x(), -0.1);
}

TEST_F(CalibrationFile, CalibrationComesBackAsWritten) {
  CalibrationResult result;
  result.calibration = ReadCalibration({Write("c.yml", kGood)});
  WriteCalibration(folder_ / "d.yml", result);
  const StereoCalibration c = ReadCalibration({folder_ / "d.yml"});
  EXPECT_EQ(c.left.K, result.calibration.left.K);
  EXPECT_EQ(c.right.distortion, result.calibration.right.distortion);
  EXPECT_EQ(c.T_RL.matrix(), result.calibration.T_RL.matrix());
}

TEST_F(CalibrationFile, BadCalibrationsAreRefusedNamingFileAndField) {
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
TEST_F(CalibrationFile, CalibrationInTwoFilesTakesItsSizeFromTheImages) {
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

}  // namespace
}  // namespace thalweg::stereo
