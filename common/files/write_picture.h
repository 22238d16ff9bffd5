#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace thalweg {

/// Writes a picture in the format of the file's ending, as WriteFile does and with its errors; throws
/// std::runtime_error, too, when no format has that ending.
void WritePicture(const std::filesystem::path& file, const cv::Mat& picture);

}  // namespace thalweg
