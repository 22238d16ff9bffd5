#pragma once

#include <opencv2/core.hpp>

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

/// The same pixels as OpenCV sees them, not copied.
template <class T>
cv::Mat_<T> ViewOf(Image<T>& image) {
  return cv::Mat_<T>(image.height(), image.width() * image.channels(), image.data().data());
}
/// To be read only: OpenCV has no type for that.
template <class T>
cv::Mat ViewOf(const Image<T>& image) {
  return {image.height(), image.width(), CV_MAKETYPE(cv::DataType<T>::depth, image.channels()),
          const_cast<T*>(image.data().data())};  // NOLINT(cppcoreguidelines-pro-type-const-cast)
}

}  // namespace thalweg::stereo
