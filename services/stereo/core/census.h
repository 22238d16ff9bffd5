#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

inline constexpr int kCensusBits = 62;

/// Census transform: for each pixel, whether each of its neighbors in a 9 x 7 window is darker than it [Zabih
/// & Woodfill, 1994]. Outside the image, the border pixels are repeated.
/// @param threads  0 = one per core.
Image<std::uint64_t> CensusOf(const ByteImage& image, std::size_t threads);

/// Whether the images fit much better when exchanged, which reveals swapped camera cables. Compares the best
/// census matches along a sample of rows. Never true for a pair without disparity or texture.
bool LookSwapped(const ByteImage& left, const ByteImage& right, int max_disparity);

/// Reverses a row and appends `stride` copies of its first element: the layout in which the kernels read
/// right rows.
template <class T>
std::vector<T> Backwards(const T* row, std::size_t width, std::size_t stride) {
  std::vector<T> out(width + stride, row[0]);
  std::reverse_copy(row, row + width, out.begin());
  return out;
}

}  // namespace thalweg::stereo
