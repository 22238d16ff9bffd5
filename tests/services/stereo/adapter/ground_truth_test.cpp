#include "services/stereo/adapter/ground_truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "services/stereo/adapter/image_files.h"

namespace thalweg::stereo {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

class GroundTruthFiles : public testing::Test {
 protected:
  GroundTruthFiles() { fs::create_directories(folder_); }
  ~GroundTruthFiles() override { fs::remove_all(folder_); }

  PairList Pairs(const std::string& text) const {
    std::ofstream(folder_ / "pairs.csv", std::ios::binary) << text;
    return ReadPairs(folder_ / "pairs.csv");
  }
  std::string MistakeIn(const std::string& line) const {
    const PairList list = Pairs("name,scale,max_disparity\ngood,4,64\n" + line + "\nlast,1,16\n");
    EXPECT_EQ(list.pairs.size(), 2U) << "the lines around it are taken";
    return list.mistakes.size() == 1 ? list.mistakes.front() : "none";
  }
  fs::path Picture(const std::string& name, const std::vector<std::uint8_t>& pixels) const {
    ByteImage image(static_cast<int>(pixels.size()), 1);
    image.data() = pixels;
    WriteImage(folder_ / name, image);
    return folder_ / name;
  }

  fs::path folder_ = fs::temp_directory_path() / ("ground_truth_" + std::to_string(getpid()));
};

TEST_F(GroundTruthFiles, PairsAreReadWithOrWithoutALineOfHeadings) {
  for (const std::string text : {"name,scale,max_disparity\r\nteddy,4,64\r\n\r\nhalf,2.5,112\r\n",
                                 "teddy,4,64\nhalf, 2.5 ,112", "\xEF\xBB\xBFteddy,4,64\nhalf,2.5,112\n",
                                 "max_disparity,source,name,scale\n64,web,teddy,4\n112,web,half,2.5\n"}) {
    const PairList list = Pairs(text);
    ASSERT_EQ(list.pairs.size(), 2U) << text;
    EXPECT_TRUE(list.mistakes.empty());
    EXPECT_EQ(list.pairs[0].name, "teddy");
    EXPECT_EQ(list.pairs[0].max_disparity, 64);
    EXPECT_EQ(list.pairs[1].scale, 2.5);
    EXPECT_EQ(list.pairs[1].max_disparity, 112);
  }
}

TEST_F(GroundTruthFiles, BadLinesOfPairsAreToldWithTheirPlace) {
  const std::string place = (folder_ / "pairs.csv").string() + ":3: ";
  EXPECT_EQ(MistakeIn("a,4"), place + "has 2 fields, must have 3");
  EXPECT_EQ(MistakeIn("a,4,64,7"), place + "has 4 fields, must have 3");
  EXPECT_EQ(MistakeIn(",4,64"), place + "name is empty");
  for (const std::string scale : {"4x", "-4", "0", "nan", "inf", ""}) {
    EXPECT_EQ(MistakeIn("a," + scale + ",64"), place + "scale is \"" + scale + "\", must be a number > 0");
  }
  for (const std::string most : {"64px", "-3", "0", "6.5", "99999999999"}) {
    EXPECT_EQ(MistakeIn("a,4," + most), place + "max_disparity is \"" + most + "\", must be an integer > 0");
  }
}

TEST_F(GroundTruthFiles, AListWithoutPairsIsRefused) {
  EXPECT_THAT([&] { Pairs("name,scale,max_disparity\n\n"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("lists no pairs")));
  EXPECT_THAT([&] { ReadPairs(folder_ / "none.csv"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("none.csv: cannot be read")));
}

TEST_F(GroundTruthFiles, PicturesAreFoundWhateverTheirEnding) {
  Picture("left.pgm", {1});
  EXPECT_EQ(FindPicture(folder_, "left"), folder_ / "left.pgm");
  Picture("left.png", {1});
  EXPECT_EQ(FindPicture(folder_, "left"), folder_ / "left.png");
  EXPECT_TRUE(FindPicture(folder_, "right").empty());
  EXPECT_THAT([&] { RequirePicture(folder_, "right"); },
              ThrowsMessage<std::runtime_error>(StartsWith((folder_ / "right").string() + ".*")));
}

TEST_F(GroundTruthFiles, TruthIsTakenFromGrayOfEightAndSixteenBitsAndFromFloats) {
  const ByteImage left(4, 1);
  const auto values = [&](const fs::path& file, double scale) {
    return ReadGroundTruth(file, {}, scale, {}, left).disparity.data();
  };
  const auto expected = ElementsAre(testing::NanSensitiveFloatEq(kNoDisparity), 1.5F, 2.0F,
                                    testing::NanSensitiveFloatEq(kNoDisparity));
  EXPECT_THAT(values(Picture("a.png", {0, 6, 8, 0}), 4.0), expected);
  EXPECT_THAT(values(Picture("a.pgm", {0, 6, 8, 0}), 4.0), expected);
  const cv::Mat_<std::uint16_t> deep = (cv::Mat_<std::uint16_t>(1, 4) << 0, 384, 512, 0);
  cv::imwrite((folder_ / "deep.png").string(), deep);
  EXPECT_THAT(values(folder_ / "deep.png", 256.0), expected);
  DisparityMap floats(4, 1);
  floats.data() = {kNoDisparity, 1.5F, 2.0F, kNoDisparity};
  WritePfm(folder_ / "a.pfm", floats);
  EXPECT_THAT(values(folder_ / "a.pfm", 1.0), expected);
}

TEST_F(GroundTruthFiles, PfmOfSeveralRowsComesBackAsWritten) {
  DisparityMap floats(2, 3);
  floats.data() = {1, 2, 3, 4, 5, 6};
  WritePfm(folder_ / "a.pfm", floats);
  EXPECT_EQ(ReadScaledDisparity(folder_ / "a.pfm", 1.0).data(), floats.data());
}

TEST_F(GroundTruthFiles, TruthWithoutDisparitiesIsRefused) {
  const ByteImage left(3, 1);
  const auto refused = [&](const fs::path& file, double scale, const std::string& what) {
    EXPECT_THAT([&] { ReadGroundTruth(file, {}, scale, {}, left); },
                ThrowsMessage<std::runtime_error>(HasSubstr(what)));
  };
  refused(Picture("unknown.png", {0, 0, 0}), 1.0, "unknown.png: contains no known disparity");
  refused(Picture("short.png", {4, 4}), 1.0, "short.png: is 2 x 1, the left image is 3 x 1");
  const fs::path good = Picture("good.png", {4, 4, 4});
  for (const double scale : {std::nan(""), 0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    refused(good, scale, "must be a number > 0");
  }
  EXPECT_THAT([&] { ReadGroundTruth(good, folder_ / "unknown.png", 1.0, {}, left); },
              ThrowsMessage<std::runtime_error>(HasSubstr("unknown.png: contains no known disparity")));
}

TEST_F(GroundTruthFiles, SaysWhereNonOccludedIsKnownFrom) {
  const ByteImage left(3, 1);
  const fs::path file = Picture("gt.png", {1, 1, 1});
  EXPECT_EQ(ReadGroundTruth(file, {}, 1.0, folder_, left).non_occluded_from, "the left ground truth alone");
  EXPECT_EQ(ReadGroundTruth(file, file, 1.0, {}, left).non_occluded_from, "both ground truths");
  Picture("mask_nonocc.png", {255, 128, 0});
  const GroundTruth truth = ReadGroundTruth(file, file, 1.0, folder_, left);
  EXPECT_EQ(truth.non_occluded_from, "a mask");
  EXPECT_THAT(truth.masks.non_occluded.data(), ElementsAre(255, 0, 0));
  EXPECT_THAT(truth.masks.all.data(), ElementsAre(255, 255, 255)) << "no such mask: from the truth";
  Picture("mask_nonocc.png", {1, 1, 0});
  EXPECT_THAT([&] { ReadGroundTruth(file, {}, 1.0, folder_, left); },
              ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("mask_nonocc.png"), HasSubstr("255"))));
}

}  // namespace
}  // namespace thalweg::stereo
