#include "services/evaluator/core/stereo_sensor.h"

#include <utility>

namespace thalweg::evaluator {
namespace {

stereo::ByteImage ImageOf(simulator::RenderedImage&& rendered) {
  stereo::ByteImage image(rendered.width_px, rendered.height_px, rendered.channels);
  image.data() = std::move(rendered.data);
  return image;
}

}  // namespace

StereoSensor::StereoSensor(const Options& options, std::uint32_t noise_seed)
    : options_(options),
      rig_(options.rig, noise_seed, static_cast<std::size_t>(options.matcher.threads)),
      matcher_(stereo::MakeMatcher(options.engine, options.matcher)) {}

StereoSensor::Matched StereoSensor::Match(simulator::StereoPair&& pair) const {
  Matched matched{ImageOf(std::move(pair.left)), {}};
  const stereo::ByteImage right = ImageOf(std::move(pair.right));
  matched.disparity = matcher_->Match(matched.left, right);
  if (options_.refine) {
    stereo::Refine(stereo::ToGray(matched.left), stereo::ToGray(right), options_.refinement,
                   static_cast<std::size_t>(options_.matcher.threads), matched.disparity);
  }
  return matched;
}

PointCloud StereoSensor::Capture(const simulator::World& world, const RigidTransform& T_WC) {
  const Matched matched = Match(Render(world, T_WC));
  return stereo::Triangulate(matched.disparity, matched.left, geometry(), options_.triangulation);
}

}  // namespace thalweg::evaluator
