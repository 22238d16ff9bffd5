#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/stereo/core/checks.h"
#include "services/stereo/core/image.h"
#include "services/stereo/core/matcher.h"

/// Reference implementations of the matchers, straight from their definitions and without regard to speed.
namespace thalweg::stereo::test {

/// SAD5 of one pixel and disparity, from every pixel of the five windows.
int SlowSad5(const ByteImage& left, const ByteImage& right, int u, int v, int d, int window, int cut);

/// Costs of one pixel by disparity.
using Costs = std::vector<int>;

/// Applies the checks of one row to costs [u][d] of all candidates.
std::vector<float> SlowChoose(const std::vector<Costs>& costs, double uniqueness, int left_right,
                              bool subpixel);

/// RemoveSmallRegions by flood fill from each pixel.
DisparityMap SlowlyRemoved(const DisparityMap& disparity, int min_pixels, float max_step,
                           Connectivity connectivity);

/// Semi-global matching with the row checks, before small regions are removed and surfaces filled.
DisparityMap SlowSemiGlobal(const ByteImage& left, const ByteImage& right, int max_disparity,
                            const SemiGlobalOptions& options);

}  // namespace thalweg::stereo::test
