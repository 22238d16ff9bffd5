#pragma once

#include <optional>
#include <string>

#include "common/base/option_visitor.h"
#include "common/scenario/scenario.h"
#include "services/stereo/core/calibration.h"
#include "services/stereo/core/matcher.h"
#include "services/stereo/core/refinement.h"
#include "services/stereo/core/triangulation.h"

namespace thalweg::stereo {

/// Options of the service. For maps, what is not matched must not be guessed: surfaces are not filled unless
/// the scenario says so, and disparities are refined.
struct StereoOptions {
  StereoOptions() { matcher.best.fill_surfaces = false; }

  std::string engine = kBestEngine;
  double rate = 0.0;  ///< [Hz] Largest rate at which pairs are matched; 0 = as many as possible.
  MatcherOptions matcher;
  bool refine = true;
  RefinementOptions refinement;
  TriangulationOptions triangulation;
  std::optional<StereoCalibration> calibration;  ///< Nothing: camera_info describes the images.
};

void Visit(OptionVisitor& visitor,
           StereoOptions& options);  ///< Block `stereo`, except for the calibration file.

/// Throws std::runtime_error naming the calibration file and what is wrong with it.
StereoOptions OptionsFrom(const Scenario& scenario);

}  // namespace thalweg::stereo
