#pragma once

#include <opencv2/core.hpp>

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

/// Wraps the same pixels as an OpenCV matrix, without copying.
template <class T>
cv::Mat_<T> ViewOf(Image<T>& image) {
  return cv::Mat_<T>(image.height(), image.width() * image.channels(), image.data().data());
}
/// The result must not be written to; OpenCV has no type for read-only matrices.
template <class T>
cv::Mat ViewOf(const Image<T>& image) {
  return {image.height(), image.width(), CV_MAKETYPE(cv::DataType<T>::depth, image.channels()),
          const_cast<T*>(image.data().data())};  // NOLINT(cppcoreguidelines-pro-type-const-cast)
}

}  // namespace thalweg::stereo
