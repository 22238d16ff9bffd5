#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/geometry/point_cloud.h"

namespace thalweg::surface {

/// What a color of a picture means.
struct Meaning {
  Rgb color;
  std::string text;
};

/// The picture with a title above it, and below it what its colors mean.
/// @param picture  8 bit, blue, green, red.
/// Errors: std::runtime_error if the font cannot be read.
cv::Mat Framed(const cv::Mat& picture, const std::string& title, const std::vector<Meaning>& legend);

}  // namespace thalweg::surface
