// `thalweg stereo` and `thalweg calibrate` as typed by a user.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "services/stereo/adapter/image_files.h"
#include "tests/support/outcome.h"
#include "tests/support/places.h"
#include "tests/support/random_images.h"

namespace thalweg::cli {
namespace {

namespace fs = std::filesystem;
using stereo::ByteImage;
using test::Outcome;
using test::OutcomeOf;
using testing::HasSubstr;

constexpr int kWidth = 120;
constexpr int kHeight = 80;
constexpr int kDisparity = 6;
constexpr int kScale = 8;

/// A shifted texture with known disparity, in a folder laid out as for pairs.csv.
class StereoCommand : public testing::Test {
 protected:
  StereoCommand() { AddPair("a", ".png"); }
  ~StereoCommand() override { fs::remove_all(folder_); }

  void AddPair(const std::string& name, const std::string& ending) const {
    fs::create_directories(folder_ / name);
    const auto pair = stereo::test::PlanePair(kWidth, kHeight, 0.0, 0.0, kDisparity, 3);
    stereo::WriteImage(folder_ / name / ("left" + ending), pair.left);
    stereo::WriteImage(folder_ / name / ("right" + ending), pair.right);
    stereo::WriteImage(folder_ / name / ("gt" + ending), ByteImage(kWidth, kHeight, 1, kDisparity * kScale));
  }
  std::string File(const std::string& name) const { return (folder_ / name).string(); }
  Outcome Stereo(const std::string& arguments) const {
    return OutcomeOf(test::BinFolder() + "/thalweg stereo " + arguments);
  }
  Outcome Pair(const std::string& more) const {
    return Stereo(File("a/left.png") + " " + File("a/right.png") + " --out " + File("out") + " " + more);
  }
  Outcome DataSet(const std::string& pairs) const {
    std::ofstream(folder_ / "pairs.csv") << "name,scale,max_disparity\n" << pairs;
    return Stereo("--dataset " + folder_.string() + " --engine best,opencv-bm --json " + File("table.json"));
  }
  nlohmann::json Table() const { return nlohmann::json::parse(std::ifstream(folder_ / "table.json")); }

  fs::path folder_ = fs::temp_directory_path() / ("stereo_command_" + std::to_string(getpid()));
};

TEST_F(StereoCommand, LeavesDisparityAndCloudAndSaysHowGoodTheyAre) {
  const Outcome outcome = Pair("--max-disparity 16 --ground-truth " + File("a/gt.png") + " --scale 8");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("non-occluded 0.00,"));
  EXPECT_THAT(outcome.text, HasSubstr("near discontinuities -,"));
  EXPECT_THAT(outcome.text, HasSubstr("determined from the left ground truth alone"));
  for (const char* const file : {"out/disparity.pfm", "out/disparity.png", "out/cloud.ply"}) {
    EXPECT_GT(fs::file_size(folder_ / file), 0U) << file;
  }
  const stereo::DisparityMap disparity = stereo::ReadScaledDisparity(folder_ / "out/disparity.pfm", 1.0);
  EXPECT_NEAR(disparity(kWidth / 2, kHeight / 2), kDisparity, 0.25);
}

TEST_F(StereoCommand, WithoutCalibrationTheCloudHasAllThatHasOnePixelOfDisparity) {
  const auto distant = stereo::test::PlanePair(kWidth, kHeight, 0.0, 0.0, 2.0, 3);
  stereo::WriteImage(folder_ / "a/left.png", distant.left);
  stereo::WriteImage(folder_ / "a/right.png", distant.right);
  EXPECT_THAT(Pair("--max-disparity 16").text, HasSubstr("depths to 120.0 baselines"));
  std::string text;
  std::ifstream cloud(folder_ / "out/cloud.ply");
  while (std::getline(cloud, text) && !text.starts_with("element vertex ")) continue;
  EXPECT_GT(std::stoi(text.substr(15)), kWidth * kHeight * 8 / 10);
}

TEST_F(StereoCommand, SaysThatImagesLookSwapped) {
  for (const char* const engine : {"best", "sad5-dog", "opencv-bm", "opencv-sgbm"}) {
    const Outcome outcome = Stereo(File("a/right.png") + " " + File("a/left.png") +
                                   " --max-disparity 16 --out " + File("out") + " --engine " + engine);
    EXPECT_THAT(outcome.text, HasSubstr("density 0.0 %")) << engine;
    EXPECT_THAT(outcome.text, HasSubstr("left and right look swapped")) << engine;
  }
}

TEST_F(StereoCommand, ADataSetIsReadInAnyFormatOfPictures) {
  AddPair("b", ".pgm");
  AddPair("c", ".bmp");
  fs::remove(folder_ / "c/gt.bmp");
  stereo::WritePfm(folder_ / "c/gt.pfm", stereo::DisparityMap(kWidth, kHeight, 1, float{kDisparity}));
  const Outcome outcome = DataSet("a,8,16\nb,8,16\nc,1,16\n");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  const nlohmann::json rows = Table()["rows"];
  ASSERT_EQ(rows.size(), 6U);
  for (const auto& row : rows) {
    EXPECT_EQ(row["bad_matched"], 0.0) << row;
    // OpenCV's block matcher finds nothing in the left margin, which is as wide as the range.
    EXPECT_LE(row["bad_nonocc"], row["engine"] == "best" ? 0.0 : 15.0) << row;
    EXPECT_TRUE(row["bad_disc"].is_null()) << row;
    EXPECT_GT(row["density"], 80.0) << row;
    EXPECT_GT(row["ms"], 0.0) << row;
  }
}

TEST_F(StereoCommand, OneBadPairIsReportedAndTheOthersAreJudged) {
  AddPair("unknown", ".png");
  stereo::WriteImage(folder_ / "unknown/gt.png", ByteImage(kWidth, kHeight));
  AddPair("small", ".png");
  stereo::WriteImage(folder_ / "small/right.png", ByteImage(kWidth, kHeight - 1));
  const Outcome outcome = DataSet("nowhere,8,16\nunknown,8,16\na,8,300\nsmall,8,16\na,8x,16\na,8,16\n");
  EXPECT_EQ(outcome.exit_code, 1);
  const std::string list = File("pairs.csv");
  EXPECT_THAT(outcome.text, HasSubstr(list + ":2: nowhere: " + File("nowhere/left") + ".*: no such image"));
  EXPECT_THAT(outcome.text,
              HasSubstr(list + ":3: unknown: " + File("unknown/gt.png") + ": contains no known disparity"));
  EXPECT_THAT(outcome.text, HasSubstr(list + ":4: a: max_disparity is 300, must be 1 to 256"));
  EXPECT_THAT(outcome.text, HasSubstr(list + ":5: small: left image is 120 x 80"));
  EXPECT_THAT(outcome.text, HasSubstr(list + ":6: scale is \"8x\""));
  EXPECT_THAT(outcome.text, HasSubstr("5 of 6 pairs could not be judged"));
  EXPECT_EQ(Table()["rows"].size(), 2U);
  EXPECT_EQ(Table()["errors"].size(), 5U);
}

TEST_F(StereoCommand, RefusesArgumentsThatDoNotGoTogether) {
  const auto refused = [](const Outcome& outcome, const std::string& what) {
    EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr(what));
  };
  const std::string dataset = "--dataset " + folder_.string() + " ";
  refused(Pair("--scale 8"), "--scale requires --ground-truth");
  refused(Pair("--masks " + folder_.string()), "--masks requires --ground-truth");
  refused(Pair("--ground-truth x --scale nan"), "--scale: is nan");
  refused(Pair("--ground-truth x --scale 8x"), "--scale: is 8x");
  refused(Pair("--engine best,opencv-bm"), "several are for --dataset");
  refused(Pair("--json x"), "--json requires --dataset");
  refused(Pair("--max-depth-error-m 0.1"), "--max-depth-error-m requires --calibration");
  refused(Stereo(dataset + File("a/left.png") + " " + File("a/right.png")), "excludes --dataset");
  refused(Stereo(dataset + "--max-disparity 8"), "--max-disparity excludes --dataset");
  refused(Stereo(dataset + "--calibration x"), "--calibration excludes --dataset");
  refused(Stereo(dataset + "--out x"), "--out excludes --dataset");
  EXPECT_EQ(Pair("--engine nothing").exit_code, 1);
}

TEST_F(StereoCommand, CalibrateRefusesBoardsAndSquaresThatAreNone) {
  const auto refused = [this](const std::string& arguments, const std::string& what) {
    const Outcome outcome =
        OutcomeOf(test::BinFolder() + "/thalweg calibrate " + folder_.string() + " " + arguments);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr(what));
  };
  for (const char* const board : {"9x6x", "9", "x6", "9x", "2x6", "9x999", "9.5x6", "-9x6"}) {
    refused(std::string("--square-m 0.025 --board=") + board, "--board is \"" + std::string(board) + "\"");
  }
  for (const char* const square : {"0", "-1", "nan"}) {
    refused(std::string("--square-m=") + square, "--square-m is ");
  }
  refused("--square-m 0.025", "has no left*, right* pairs");
}

}  // namespace
}  // namespace thalweg::cli
