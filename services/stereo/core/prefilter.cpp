#include "services/stereo/core/prefilter.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/base/check.h"
#include "services/stereo/core/opencv_view.h"

namespace thalweg::stereo {
namespace {

constexpr double kMiddle = 128.0;
constexpr double kReach = 3.0;  // of a kernel, in units of sigma

int RadiusOf(double sigma) {
  return std::max(1, static_cast<int>(std::ceil(kReach * sigma)));
}

/// Samples the function at -radius..radius.
template <class Function>
cv::Mat KernelOf(int radius, Function&& function) {
  cv::Mat_<float> kernel(1, 2 * radius + 1);
  for (int i = -radius; i <= radius; ++i) kernel(0, i + radius) = static_cast<float>(function(i));
  return kernel;
}

cv::Mat GaussianKernel(double sigma) {
  cv::Mat kernel = KernelOf(RadiusOf(sigma), [&](int i) { return std::exp(-0.5 * i * i / (sigma * sigma)); });
  return kernel / cv::sum(kernel)[0];
}

cv::Mat Separable(const cv::Mat& image, const cv::Mat& along_u, const cv::Mat& along_v) {
  cv::Mat out;
  cv::sepFilter2D(image, out, CV_32F, along_u, along_v, {-1, -1}, 0.0, cv::BORDER_REPLICATE);
  return out;
}

cv::Mat DifferenceOfGaussians(const cv::Mat& image, const PrefilterOptions& options) {
  const cv::Mat narrow = GaussianKernel(options.dog_sigma);
  const cv::Mat wide = GaussianKernel(options.dog_sigma * options.dog_ratio);
  return Separable(image, narrow, narrow) - Separable(image, wide, wide);
}

cv::Mat LaplacianOfGaussian(const cv::Mat& image, double sigma) {
  const cv::Mat gaussian = GaussianKernel(sigma);
  cv::Mat second = KernelOf(RadiusOf(sigma), [&](int i) {
    const double square = i * i / (sigma * sigma);
    return (square - 1.0) / (sigma * sigma) * std::exp(-0.5 * square);
  });
  second /= cv::norm(second, cv::NORM_L1);
  // So that the response to a uniform area is 0
  second -= cv::sum(second)[0] / static_cast<double>(second.total());
  return -(Separable(image, second, gaussian) + Separable(image, gaussian, second));
}

cv::Mat BilateralBlur(const cv::Mat& image, const PrefilterOptions& options) {
  cv::Mat blurred;
  cv::bilateralFilter(image, blurred, 0, options.bilateral_sigma_range, options.bilateral_sigma_distance,
                      cv::BORDER_REPLICATE);
  return blurred;
}

cv::Mat LessItsBilateralBlur(const cv::Mat& image, const PrefilterOptions& options) {
  cv::Mat difference;
  cv::subtract(image, BilateralBlur(image, options), difference, cv::noArray(), CV_32F);
  return difference;
}

}  // namespace

ByteImage Filter(const ByteImage& image, const PrefilterOptions& options) {
  THALWEG_CHECK(image.channels() == 1);
  const cv::Mat in = ViewOf(image);
  cv::Mat response;
  double gain = options.gain;
  double middle = kMiddle;
  switch (options.kind) {
    case Prefilter::kNone:
      return image;
    case Prefilter::kDifferenceOfGaussians:
      response = DifferenceOfGaussians(in, options);
      break;
    case Prefilter::kLaplacianOfGaussian:
      response = LaplacianOfGaussian(in, options.log_sigma);
      break;
    case Prefilter::kBilateral:
      response = LessItsBilateralBlur(in, options);
      gain = 1.0;
      break;
    case Prefilter::kBilateralBlur:
      response = BilateralBlur(in, options);
      gain = 1.0;
      middle = 0.0;
      break;
  }
  ByteImage out(image.width(), image.height());
  cv::Mat to = ViewOf(out);
  response.convertTo(to, CV_8U, gain, middle);
  return out;
}

}  // namespace thalweg::stereo
