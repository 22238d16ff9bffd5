#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace thalweg {

/// Writes an image in the format given by the file's extension, like WriteFile and with its errors. Also
/// throws std::runtime_error if no format has that extension.
void WritePicture(const std::filesystem::path& file, const cv::Mat& picture);

}  // namespace thalweg
