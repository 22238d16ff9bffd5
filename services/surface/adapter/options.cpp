#include "services/surface/adapter/options.h"

#include <cmath>

#include "common/base/megabytes.h"
#include "common/scenario/models.h"
#include "common/scenario/option_binding.h"

namespace thalweg::surface {
namespace {}  // namespace

void Visit(OptionVisitor& visitor, SurfaceServiceOptions& options) {
  FusedSurface::Options& surface = options.surface;
  visitor.Number("voxel_size_m", surface.voxel_size);
  visitor.Number("max_range_m", surface.max_range);
  visitor.Number("inspection_distance_m", surface.limits.distance);
  double angle = std::acos(static_cast<double>(surface.limits.cosine));
  if (visitor.Degrees("inspection_angle_deg", angle)) {
    surface.limits.cosine = static_cast<float>(std::cos(angle));
  }
  visitor.Number("sampling_m", surface.limits.sampling);
  visitor.Seconds("publish_period_s", options.publish_period);
  visitor.Seconds("checkpoint_period_s", options.checkpoint_period);
  auto megabytes = static_cast<int>(surface.most_bytes / kMegabyte);
  if (visitor.Whole("most_memory_mb", megabytes)) {
    surface.most_bytes = static_cast<std::size_t>(megabytes) * kMegabyte;
  }
}

SurfaceServiceOptions OptionsFrom(const Scenario& scenario, const std::filesystem::path& out) {
  SurfaceServiceOptions options;
  options.out = out;
  options.reads_images = scenario.depth_source() == DepthSource::DEPTH_IMAGE;
  const RobotModel robot = RobotFrom(scenario);
  options.T_BC = robot.T_BC;
  options.continuity = PoseContinuity::Options::For(robot);
  const DepthSensorModel sensor = DepthSensorFrom(scenario);
  options.infinity_is_free = sensor.no_return_is_free;
  options.surface.max_range = sensor.max_range;
  options.surface.depth_error = DepthErrorFrom(scenario);
  ReadOptions(scenario.surface(), options);
  return options;
}

}  // namespace thalweg::surface
