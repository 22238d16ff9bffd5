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

/// For maps: what is not matched is not guessed, so surfaces are not filled unless the scenario asks for it;
/// and disparities are refined.
struct StereoOptions {
  StereoOptions() { matcher.best.fill_surfaces = false; }

  std::string engine = kBestEngine;
  double rate = 0.0;  ///< [Hz] At which pairs are matched at most; 0 = all that there is time for.
  MatcherOptions matcher;
  bool refine = true;
  RefinementOptions refinement;
  TriangulationOptions triangulation;
  std::optional<StereoCalibration> calibration;  ///< None: camera_info says how the images are.
};

void Visit(OptionVisitor& visitor,
           StereoOptions& options);  ///< Block `stereo`, but for the calibration file.

/// Throws std::runtime_error naming the calibration file and what is wrong with it.
StereoOptions OptionsFrom(const Scenario& scenario);

}  // namespace thalweg::stereo
