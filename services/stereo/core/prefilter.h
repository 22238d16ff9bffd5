#pragma once

#include <string_view>

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

/// Filters applied to both images before matching. All but kNone and kBilateralBlur let them differ in
/// brightness.
enum class Prefilter {
  kNone,
  kDifferenceOfGaussians,  ///< Difference of two Gaussian blurs, each separable.
  kLaplacianOfGaussian,    ///< The sum of two separable filters.
  kBilateral,              ///< The image minus its bilateral blur, which preserves edges; not separable.
  kBilateralBlur,          ///< The bilateral blur itself, Eq. (3.17), which leaves differences in brightness.
};

struct PrefilterOptions {
  Prefilter kind = Prefilter::kDifferenceOfGaussians;
  double dog_sigma = 0.7;                ///< [px] Sigma of the narrower blur.
  double dog_ratio = 1.6;                ///< Sigma of the wider blur relative to the narrower.
  double log_sigma = 1.0;                ///< [px]
  double bilateral_sigma_distance = 10;  ///< [px]
  double bilateral_sigma_range = 5;      ///< [gray values]
  double gain = 4.0;                     ///< For DoG and LoG, whose responses are small.
};

/// Filters a grayscale image.
/// @return The response offset by 128 and clamped to 0 to 255; for kNone the image itself, for
///   kBilateralBlur the blurred image.
ByteImage Filter(const ByteImage& image, const PrefilterOptions& options);

}  // namespace thalweg::stereo
