#pragma once

#include <filesystem>

#include "services/stereo/core/calibration.h"

namespace thalweg::stereo {

struct ImageSize {
  int width_px = 0;
  int height_px = 0;
};

/// Reads OpenCV's YAML: image_width, image_height, M1 (or K1), D1, M2 (or K2), D2, R, T, as named by its
/// stereo_calib sample, in one file or several. Throws std::runtime_error naming the files and the field.
/// @param images  Size to use if the files do not contain it.
StereoCalibration ReadCalibration(const std::vector<std::filesystem::path>& files,
                                  const std::optional<ImageSize>& images = std::nullopt);

/// Writes the fields that ReadCalibration reads, and the two calibration errors for information.
void WriteCalibration(const std::filesystem::path& file, const CalibrationResult& result);

}  // namespace thalweg::stereo
