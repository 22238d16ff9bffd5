#include "services/stereo/core/opencv_matchers.h"

#include <opencv2/imgproc.hpp>

#include "services/stereo/core/opencv_view.h"

namespace thalweg::stereo {
namespace {

constexpr int kP1 = 200;
constexpr int kP2 = 800;
constexpr int kUniqueness = 10;  // [%]
constexpr int kSpecklePixels = 50;
constexpr int kSpeckleStep = 2;  // [px]
constexpr int kLeftRight = 1;    // [px]

/// Sets OpenCV's number of threads and restores it on destruction; it is a setting of the whole process.
class OpenCvThreads {
 public:
  explicit OpenCvThreads(int count) : before_(cv::getNumThreads()) {
    if (count > 0) cv::setNumThreads(count);
  }
  ~OpenCvThreads() { cv::setNumThreads(before_); }
  OpenCvThreads(const OpenCvThreads&) = delete;
  OpenCvThreads& operator=(const OpenCvThreads&) = delete;

 private:
  int before_;
};

class OpenCvMatcher : public Matcher {
 public:
  OpenCvMatcher(cv::Ptr<cv::StereoMatcher> matcher, const MatcherOptions& options)
      : Matcher(options.max_disparity), matcher_(std::move(matcher)), options_(options) {}

 private:
  DisparityMap Find(const ByteImage& left, const ByteImage& right) override {
    const OpenCvThreads threads(options_.threads);
    const ByteImage gray_left = ToGray(left);
    const ByteImage gray_right = ToGray(right);
    // OpenCV finds no matches in a left margin of max_disparity pixels, so the images are padded by such a
    // margin.
    const int margin = matcher_->getNumDisparities();
    cv::Mat wide_left;
    cv::Mat wide_right;
    cv::copyMakeBorder(ViewOf(gray_left), wide_left, 0, 0, margin, 0, cv::BORDER_REPLICATE);
    cv::copyMakeBorder(ViewOf(gray_right), wide_right, 0, 0, margin, 0, cv::BORDER_REPLICATE);
    cv::Mat_<short> fixed;
    matcher_->compute(wide_left, wide_right, fixed);
    DisparityMap disparity(left.width(), left.height(), 1, kNoDisparity);
    for (int v = 0; v < left.height(); ++v) {
      for (int u = 0; u < left.width(); ++u) {
        const float d = static_cast<float>(fixed(v, u + margin)) / float{cv::StereoMatcher::DISP_SCALE};
        if (d >= 0.0F && d < static_cast<float>(options_.max_disparity)) disparity(u, v) = d;
      }
    }
    return disparity;
  }

  cv::Ptr<cv::StereoMatcher> matcher_;
  MatcherOptions options_;
};

int RoundedUpTo16(int value) {
  return (value + 15) / 16 * 16;
}

}  // namespace

cv::Ptr<cv::StereoMatcher> UsualBlockMatcher(int max_disparity, int window) {
  const auto matcher = cv::StereoBM::create(RoundedUpTo16(max_disparity), window);
  matcher->setUniquenessRatio(kUniqueness);
  matcher->setSpeckleWindowSize(kSpecklePixels);
  matcher->setSpeckleRange(kSpeckleStep);
  matcher->setDisp12MaxDiff(kLeftRight);
  return matcher;
}

cv::Ptr<cv::StereoMatcher> UsualSemiGlobalMatcher(int max_disparity, int window) {
  return cv::StereoSGBM::create(0, RoundedUpTo16(max_disparity), window, kP1, kP2, kLeftRight, 0, kUniqueness,
                                kSpecklePixels, kSpeckleStep);
}

std::unique_ptr<Matcher> MakeOpenCvBlockMatcher(const MatcherOptions& options) {
  return std::make_unique<OpenCvMatcher>(
      UsualBlockMatcher(options.max_disparity, options.opencv.block_window), options);
}

std::unique_ptr<Matcher> MakeOpenCvSemiGlobalMatcher(const MatcherOptions& options) {
  return std::make_unique<OpenCvMatcher>(
      UsualSemiGlobalMatcher(options.max_disparity, options.opencv.semi_global_window), options);
}

}  // namespace thalweg::stereo
