#pragma once

#include <memory>
#include <string>

#include "common/geometry/point_cloud.h"
#include "services/simulator/core/stereo_rig.h"
#include "services/stereo/core/matcher.h"
#include "services/stereo/core/refinement.h"
#include "services/stereo/core/triangulation.h"

namespace thalweg::evaluator {

/// A stereo camera and its matcher as a source of clouds: renders both images, matches them and triangulates,
/// as simulator and stereo service do in a run of processes. Uses one thread.
class StereoSensor {
 public:
  struct Options {
    simulator::StereoRigModel rig;
    double rate = rig.rate;  ///< [Hz] Pairs that are matched.
    std::string engine = stereo::kBestEngine;
    stereo::MatcherOptions matcher;  ///< But for its threads.
    bool refine = true;
    stereo::RefinementOptions refinement;
    stereo::TriangulationOptions triangulation;
  };
  /// Throws std::invalid_argument as stereo::MakeMatcher does.
  StereoSensor(const Options& options, std::uint32_t noise_seed);

  /// @param T_WC  Pose of the left camera.
  /// @return Organized cloud in C, with colors; NaN where nothing was matched.
  PointCloud Capture(const simulator::World& world, const RigidTransform& T_WC);

 private:
  Options options_;
  simulator::StereoRig rig_;
  std::unique_ptr<stereo::Matcher> matcher_;
};

}  // namespace thalweg::evaluator
