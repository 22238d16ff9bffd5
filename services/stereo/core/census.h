#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

inline constexpr int kCensusBits = 62;

/// Of each pixel, whether its neighbours in a window of 9 x 7 are darker than it is [Zabih & Woodfill, 1994].
/// Beyond its border an image goes on with its border pixels. @param threads  0 = one a core.
Image<std::uint64_t> CensusOf(const ByteImage& image, std::size_t threads);

/// Whether the right image explains the left one much better as its left neighbour: cables get swapped. From
/// the best censuses along some rows. A pair without disparity or without texture never does.
bool LookSwapped(const ByteImage& left, const ByteImage& right, int max_disparity);

/// A row backwards, with its first element `stride` more times behind it: as the kernels read right rows.
template <class T>
std::vector<T> Backwards(const T* row, std::size_t width, std::size_t stride) {
  std::vector<T> out(width + stride, row[0]);
  std::reverse_copy(row, row + width, out.begin());
  return out;
}

}  // namespace thalweg::stereo
