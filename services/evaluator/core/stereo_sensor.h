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
/// as simulator and stereo service do in a run of processes.
class StereoSensor {
 public:
  struct Options {
    simulator::StereoRigModel rig;
    double rate = rig.rate;  ///< [Hz] Pairs that are matched.
    std::string engine = stereo::kBestEngine;
    stereo::MatcherOptions matcher;  ///< Its threads do all of the work; no result depends on their number.
    bool refine = true;
    stereo::RefinementOptions refinement;
    stereo::TriangulationOptions triangulation;
  };
  /// Throws std::invalid_argument as stereo::MakeMatcher does.
  StereoSensor(const Options& options, std::uint32_t noise_seed);

  const Options& options() const { return options_; }
  StereoGeometry geometry() const { return {options_.rig.camera, options_.rig.baseline}; }

  /// @param T_WC  Pose of the left camera.
  simulator::StereoPair Render(const simulator::World& world, const RigidTransform& T_WC) {
    return rig_.Capture(world, T_WC);
  }
  struct Matched {
    stereo::ByteImage left;
    stereo::DisparityMap disparity;
  };
  /// Disparities of a pair, refined if the options say so.
  Matched Match(simulator::StereoPair&& pair) const;
  /// @return Organized cloud in C, with colors; NaN where nothing was matched.
  PointCloud Capture(const simulator::World& world, const RigidTransform& T_WC);

 private:
  Options options_;
  simulator::StereoRig rig_;
  std::unique_ptr<stereo::Matcher> matcher_;
};

}  // namespace thalweg::evaluator
