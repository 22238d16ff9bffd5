#include "services/evaluator/core/stereo_sensor.h"

#include <utility>

namespace thalweg::evaluator {
namespace {

constexpr int kStereoThreads = 1;  // since runs share the cores

stereo::MatcherOptions OnOneThread(stereo::MatcherOptions options) {
  options.threads = kStereoThreads;
  return options;
}

stereo::ByteImage ImageOf(simulator::RenderedImage&& rendered) {
  stereo::ByteImage image(rendered.width_px, rendered.height_px, rendered.channels);
  image.data() = std::move(rendered.data);
  return image;
}

}  // namespace

StereoSensor::StereoSensor(const Options& options, std::uint32_t noise_seed)
    : options_(options),
      rig_(options.rig, noise_seed, kStereoThreads),
      matcher_(stereo::MakeMatcher(options.engine, OnOneThread(options.matcher))) {}

PointCloud StereoSensor::Capture(const simulator::World& world, const RigidTransform& T_WC) {
  simulator::StereoPair pair = rig_.Capture(world, T_WC);
  const stereo::ByteImage left = ImageOf(std::move(pair.left));
  const stereo::ByteImage right = ImageOf(std::move(pair.right));
  stereo::DisparityMap disparity = matcher_->Match(left, right);
  if (options_.refine)
    stereo::Refine(stereo::ToGray(left), stereo::ToGray(right), options_.refinement, kStereoThreads,
                   disparity);
  return stereo::Triangulate(disparity, left, {options_.rig.camera, options_.rig.baseline},
                             options_.triangulation);
}

}  // namespace thalweg::evaluator
