#pragma once

#include <filesystem>

#include "services/stereo/core/calibration.h"

namespace thalweg::stereo {

/// OpenCV's YAML: image_width, image_height, M1 (or K1), D1, M2 (or K2), D2, R, T, as its stereo_calib sample
/// names them, in one file. Throws std::runtime_error naming file and field.
StereoCalibration ReadCalibration(const std::filesystem::path& file);

/// Beside what ReadCalibration takes it writes the two errors, for people.
void WriteCalibration(const std::filesystem::path& file, const CalibrationResult& result);

}  // namespace thalweg::stereo
