#pragma once

#include <optional>
#include <string>

#include "common/scenario/scenario.h"
#include "services/stereo/core/calibration.h"
#include "services/stereo/core/matcher.h"
#include "services/stereo/core/triangulation.h"

namespace thalweg::stereo {

/// For maps: what is not matched is not guessed, so surfaces are not filled unless the scenario asks for it.
struct StereoOptions {
  StereoOptions() { matcher.best.fill_surfaces = false; }

  std::string engine = "best";
  MatcherOptions matcher;
  TriangulationOptions triangulation;
  std::optional<StereoCalibration> calibration;  ///< None: the images are rectified, as camera_info says.
};

/// Throws std::runtime_error naming the calibration file and what is wrong with it.
StereoOptions OptionsFrom(const Scenario& scenario);

}  // namespace thalweg::stereo
