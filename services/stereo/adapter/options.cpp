#include "services/stereo/adapter/options.h"

#include "common/scenario/option_binding.h"
#include "services/stereo/adapter/calibration_file.h"

namespace thalweg::stereo {

void Visit(OptionVisitor& visitor, StereoOptions& options) {
  MatcherOptions& matcher = options.matcher;
  visitor.Text("engine", options.engine);
  visitor.Number("rate_hz", options.rate);
  visitor.Whole("max_disparity_px", matcher.max_disparity);
  visitor.Whole("threads", matcher.threads);
  visitor.Switch("fill_surfaces", matcher.best.fill_surfaces);
  visitor.Switch("refine", options.refine);
  visitor.Whole("window_px", matcher.sad5.window);
  visitor.Whole("max_difference", matcher.sad5.max_difference);
  visitor.Number("uniqueness", matcher.sad5.uniqueness);
  if (visitor.Whole("speckle_px", matcher.best.speckle_pixels)) {
    matcher.sad5.speckle_pixels = matcher.best.speckle_pixels;
  }
  visitor.Number("min_depth_m", options.triangulation.min_depth);
  visitor.Number("max_depth_m", options.triangulation.max_depth);
  visitor.Number("disparity_error_px", options.triangulation.disparity_error);
  visitor.Number("max_depth_error_m", options.triangulation.max_depth_error);
}

StereoOptions OptionsFrom(const Scenario& scenario) {
  StereoOptions options;
  ReadOptions(scenario.stereo(), options);
  if (scenario.stereo().has_calibration_file()) {
    options.calibration = ReadCalibration({scenario.stereo().calibration_file()});
  }
  return options;
}

}  // namespace thalweg::stereo
