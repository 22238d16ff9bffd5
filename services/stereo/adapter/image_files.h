#pragma once

#include <filesystem>

#include "common/geometry/point_cloud.h"
#include "services/stereo/core/image.h"

namespace thalweg::stereo {

// Pictures and clouds on disk. All throw std::runtime_error naming the file and what is wrong with it.

/// Any format that OpenCV reads, as grey or RGB. Refused: 16 bits a channel, no image at all.
ByteImage ReadImage(const std::filesystem::path& file);

/// A grey picture of disparity * scale, of 8 or 16 bits, or a PFM of the same. Unknown: 0, and what is not
/// finite.
DisparityMap ReadScaledDisparity(const std::filesystem::path& file, double scale);

/// Portable float map as of Middlebury: 32 bits, rows from below, infinity where there is none.
void WritePfm(const std::filesystem::path& file, const DisparityMap& disparity);

/// Near is red, far (disparity 0) is blue, none is black.
void WriteColored(const std::filesystem::path& file, const DisparityMap& disparity, double max_disparity);

void WriteImage(const std::filesystem::path& file, const ByteImage& image);

/// Binary, with colours; without the points that are none. Makes the mapper's and MeshLab's kind of file.
void WritePly(const std::filesystem::path& file, const PointCloud& cloud);

}  // namespace thalweg::stereo
