#pragma once

#include <string_view>

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

/// What is taken from both images before they are compared, so that they may differ in brightness.
enum class Prefilter {
  kNone,
  kDifferenceOfGaussians,  ///< Two Gaussian blurs, each separable.
  kLaplacianOfGaussian,    ///< The sum of two separable filters.
  kBilateral,              ///< The image less its bilateral blur, which keeps edges; not separable.
};

struct PrefilterOptions {
  Prefilter kind = Prefilter::kDifferenceOfGaussians;
  double dog_sigma = 0.7;                ///< [px] Of the narrower blur.
  double dog_ratio = 1.6;                ///< Of the wider to the narrower.
  double log_sigma = 1.0;                ///< [px]
  double bilateral_sigma_distance = 10;  ///< [px]
  double bilateral_sigma_range = 5;      ///< [grey values]
  double gain = 4.0;                     ///< Of DoG and LoG, whose responses are small.
};

/// @param image  Grey.
/// @return       128 where the filter answers 0; cut to 0 to 255. kNone returns the image.
ByteImage Filter(const ByteImage& image, const PrefilterOptions& options);

}  // namespace thalweg::stereo
