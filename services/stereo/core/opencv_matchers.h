#pragma once

#include <memory>

#include "services/stereo/core/matcher.h"

namespace thalweg::stereo {

// OpenCV's matchers with their usual parameters, for comparison: a window of 11 px, and block 5, P1 200,
// P2 800; both with uniqueness 10 and speckles of 50 px and step 2. Both search a multiple of 16 disparities.

std::unique_ptr<Matcher> MakeOpenCvBlockMatcher(const MatcherOptions& options);
std::unique_ptr<Matcher> MakeOpenCvSemiGlobalMatcher(const MatcherOptions& options);

}  // namespace thalweg::stereo
