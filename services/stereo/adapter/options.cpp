#include "services/stereo/adapter/options.h"

#include "services/stereo/adapter/calibration_file.h"

namespace thalweg::stereo {

StereoOptions OptionsFrom(const Scenario& scenario) {
  StereoOptions options;
  const Stereo& given = scenario.stereo();
  if (given.has_engine()) options.engine = given.engine();
  if (given.has_rate_hz()) options.rate = given.rate_hz();
  if (given.has_max_disparity_px()) options.matcher.max_disparity = given.max_disparity_px();
  if (given.has_threads()) options.matcher.threads = given.threads();
  if (given.has_fill_surfaces()) options.matcher.best.fill_surfaces = given.fill_surfaces();
  if (given.has_refine()) options.refine = given.refine();
  if (given.has_window_px()) options.matcher.sad5.window = given.window_px();
  if (given.has_max_difference()) options.matcher.sad5.max_difference = given.max_difference();
  if (given.has_uniqueness()) options.matcher.sad5.uniqueness = given.uniqueness();
  if (given.has_speckle_px()) {
    options.matcher.best.speckle_pixels = given.speckle_px();
    options.matcher.sad5.speckle_pixels = given.speckle_px();
  }
  TriangulationOptions& triangulation = options.triangulation;
  if (given.has_min_depth_m()) triangulation.min_depth = given.min_depth_m();
  if (given.has_max_depth_m()) triangulation.max_depth = given.max_depth_m();
  if (given.has_disparity_error_px()) triangulation.disparity_error = given.disparity_error_px();
  if (given.has_max_depth_error_m()) triangulation.max_depth_error = given.max_depth_error_m();
  if (given.has_calibration_file()) options.calibration = ReadCalibration({given.calibration_file()});
  return options;
}

}  // namespace thalweg::stereo
