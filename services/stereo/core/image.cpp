#include "services/stereo/core/image.h"

#include <opencv2/imgproc.hpp>

#include "common/base/check.h"
#include "services/stereo/core/opencv_view.h"

namespace thalweg::stereo {

ByteImage ToGray(const ByteImage& image) {
  if (image.channels() == 1) return image;
  THALWEG_CHECK(image.channels() == 3);
  ByteImage gray(image.width(), image.height());
  cv::Mat out = ViewOf(gray);
  cv::cvtColor(ViewOf(std::as_const(image)), out, cv::COLOR_RGB2GRAY);
  return gray;
}

}  // namespace thalweg::stereo
