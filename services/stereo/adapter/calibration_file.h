#pragma once

#include <filesystem>

#include "services/stereo/core/calibration.h"

namespace thalweg::stereo {

struct ImageSize {
  int width_px = 0;
  int height_px = 0;
};

/// OpenCV's YAML: image_width, image_height, M1 (or K1), D1, M2 (or K2), D2, R, T, as its stereo_calib sample
/// names them, in one file or spread over several. Throws std::runtime_error naming the files and the field.
/// @param images  Taken where the files do not tell the size.
StereoCalibration ReadCalibration(const std::vector<std::filesystem::path>& files,
                                  const std::optional<ImageSize>& images = std::nullopt);

/// Beside what ReadCalibration takes it writes the two errors, for people.
void WriteCalibration(const std::filesystem::path& file, const CalibrationResult& result);

}  // namespace thalweg::stereo
