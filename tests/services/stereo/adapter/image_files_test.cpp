#include "services/stereo/adapter/image_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/services/stereo/adapter/files_fixture.h"

namespace thalweg::stereo {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

class ImageFiles : public test::FilesTest {};

TEST_F(ImageFiles, ImagesComeBackAsWritten) {
  ByteImage image(7, 5, 3);
  for (std::size_t i = 0; i < image.data().size(); ++i) image.data()[i] = static_cast<std::uint8_t>(2 * i);
  WriteImage(folder_ / "image.png", image);
  EXPECT_EQ(ReadImage(folder_ / "image.png"), image);
}

TEST_F(ImageFiles, ImagesThatAreNoneAreRefusedByName) {
  cv::imwrite((folder_ / "deep.png").string(), cv::Mat(4, 4, CV_16U, cv::Scalar(900)));
  EXPECT_THAT([&] { ReadImage(folder_ / "deep.png"); },
              ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("deep.png"), HasSubstr("8"))));
  WriteImage(folder_ / "good.png", ByteImage(50, 50, 1, 3));
  const fs::path cut = Write("cut.png", Text(folder_ / "good.png").substr(0, 20));
  EXPECT_THAT([&] { ReadImage(cut); }, ThrowsMessage<std::runtime_error>(HasSubstr("cut.png")));
  EXPECT_THAT([&] { ReadImage(folder_); },
              ThrowsMessage<std::runtime_error>(HasSubstr("is not a readable image")));
}

TEST_F(ImageFiles, APfmsScaleIsOnlyTheOrderOfItsBytes) {
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

TEST_F(ImageFiles, AJpegThatIsCutShortIsRefused) {
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

TEST_F(ImageFiles, PfmHasRowsFromBelowAndInfinityForNone) {
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

TEST_F(ImageFiles, ColorsGoFromBlueFarToRedNear) {
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

TEST_F(ImageFiles, GroundTruthIsScaledAndZeroIsUnknown) {
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
