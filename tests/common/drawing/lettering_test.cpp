#include "common/drawing/lettering.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace thalweg {
namespace {

constexpr double kCapital = 20.0;  // [px]
const cv::Scalar kWhite(255, 255, 255);
const cv::Scalar kBlack(0, 0, 0);

/// The bounding box of all pixels that are not paper when a text is drawn at (20, 60).
cv::Rect InkOf(const std::string& text, bool strong = false) {
  cv::Mat picture(100, 400, CV_8UC3, kWhite);
  lettering::Draw(picture, text, {20.0, 60.0}, kCapital, kBlack, strong);
  cv::Mat gray;
  cv::extractChannel(picture, gray, 0);
  return cv::boundingRect(gray < 128);
}

TEST(Lettering, ACapitalIsAsHighAsAskedForAndStandsOnTheLine) {
  const cv::Rect ink = InkOf("H");
  EXPECT_NEAR(ink.height, kCapital, 1.0);
  EXPECT_NEAR(ink.br().y, 60, 1);
}

TEST(Lettering, LettersThatLookAlikeDiffer) {
  const auto drawn = [](const std::string& text) {
    cv::Mat picture(100, 100, CV_8UC3, kWhite);
    lettering::Draw(picture, text, {20.0, 60.0}, kCapital, kBlack, false);
    return picture;
  };
  for (const auto& [a, b] : {std::pair("i", "l"), {"l", "I"}, {"0", "O"}, {"1", "l"}}) {
    EXPECT_GT(cv::norm(drawn(a), drawn(b), cv::NORM_L1), 10 * 255) << a << ' ' << b;
  }
}

TEST(Lettering, AnAccentAndAPowerAreLettersOfTheirOwn) {
  const cv::Rect power = InkOf("²");
  const cv::Rect digit = InkOf("2");
  EXPECT_LT(power.height, 0.75 * digit.height) << "raised and small";
  EXPECT_LT(power.br().y, digit.br().y - 5);
  EXPECT_LT(lettering::WidthOf("m²", kCapital, false), lettering::WidthOf("m2", kCapital, false));
  EXPECT_GT(InkOf("°").area(), 0);
}

TEST(Lettering, WidthIsThatOfTheInkAndStrongLettersAreWider) {
  const std::string text = "solid over its whole height";
  EXPECT_NEAR(InkOf(text).width, lettering::WidthOf(text, kCapital, false), 0.2 * kCapital);
  EXPECT_GT(lettering::WidthOf(text, kCapital, true), lettering::WidthOf(text, kCapital, false));
  EXPECT_EQ(lettering::WidthOf("", kCapital, false), 0.0);
}

TEST(Lettering, BytesThatAreNoUtf8AreDrawnAsBoxesAndWhatIsOutsideIsLeftOut) {
  EXPECT_GT(InkOf("\xFF\xC3").area(), 0);
  cv::Mat picture(10, 10, CV_8UC3, kWhite);
  lettering::Draw(picture, "Wide", {-15.0, 14.0}, kCapital, kBlack, false);
  EXPECT_LT(cv::norm(picture), cv::norm(cv::Mat(10, 10, CV_8UC3, kWhite)));
}

}  // namespace
}  // namespace thalweg
