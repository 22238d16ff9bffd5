#pragma once

#include <filesystem>

#include "services/stereo/core/image.h"

namespace thalweg::stereo {

// Reads and writes images. What reads or writes throws std::runtime_error naming the file and what is wrong.

/// Reads any format that OpenCV supports, as gray or RGB with 8 bits per channel. Throws if the file has 16
/// bits per channel or is not an image.
ByteImage ReadImage(const std::filesystem::path& file);

/// Reads disparities from an 8- or 16-bit gray image of disparity * scale, or a PFM of the same. 0 and values
/// that are not finite mean unknown.
DisparityMap ReadScaledDisparity(const std::filesystem::path& file, double scale);

/// Writes a portable float map in Middlebury's convention: 32 bits, rows from the bottom, infinity where
/// there is no disparity.
void WritePfm(const std::filesystem::path& file, const DisparityMap& disparity);

/// An RGB image: near is red, far (disparity 0) is blue, no disparity is black.
ByteImage Colored(const DisparityMap& disparity, double max_disparity);

/// Writes the disparities as Colored has them.
void WriteColored(const std::filesystem::path& file, const DisparityMap& disparity, double max_disparity);

void WriteImage(const std::filesystem::path& file, const ByteImage& image);

}  // namespace thalweg::stereo
