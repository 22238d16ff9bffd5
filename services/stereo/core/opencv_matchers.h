#pragma once

#include <memory>
#include <opencv2/calib3d.hpp>

#include "services/stereo/core/matcher.h"

namespace thalweg::stereo {

// OpenCV's matchers with their usual parameters, for comparison. The number of disparities they search is a
// multiple of 16.

cv::Ptr<cv::StereoMatcher> UsualBlockMatcher(int max_disparity, int window = OpenCvOptions{}.block_window);
cv::Ptr<cv::StereoMatcher> UsualSemiGlobalMatcher(int max_disparity,
                                                  int window = OpenCvOptions{}.semi_global_window);

std::unique_ptr<Matcher> MakeOpenCvBlockMatcher(const MatcherOptions& options);
std::unique_ptr<Matcher> MakeOpenCvSemiGlobalMatcher(const MatcherOptions& options);

}  // namespace thalweg::stereo
