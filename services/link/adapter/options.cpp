#include "services/link/adapter/options.h"

#include <string>

#include "common/scenario/models.h"
#include "common/scenario/option_binding.h"

namespace thalweg::link {

void Visit(OptionVisitor& visitor, LinkOptions& options) {
  visitor.Whole("domain", options.domain);
  visitor.Number("pose_rate_hz", options.pose_rate);
  visitor.Number("clock_rate_hz", options.clock_rate);
  visitor.Switch("colors", options.clouds.colors);
  visitor.Whole("keep_mb", options.keep_mb);
  visitor.Seconds("lost_after_s", options.lost_after);
  visitor.Seconds("command_age_s", options.command_age);
}

LinkOptions OptionsFrom(const Scenario& scenario) {
  // Steps so small that they move few points to other voxels.
  constexpr double kDepthStepsPerVoxel = 20.0;
  constexpr double kPointStepsPerVoxel = 10.0;
  LinkOptions options;
  const double voxel_size = MapFrom(scenario).voxel_size;
  options.clouds.depth_step = voxel_size / kDepthStepsPerVoxel;
  options.clouds.point_step = voxel_size / kPointStepsPerVoxel;
  options.wall_clock = scenario.network().wall_clock();
  ReadOptions(scenario.link(), options);
  return options;
}

std::vector<Mistake> MistakesIn(const Scenario& scenario, int local_domain) {
  if (ReadOptions<LinkOptions>(scenario.link()).domain != local_domain) return {};
  return {{.field = PathOf("link", "domain"),
           .text = "is " + std::to_string(local_domain) +
                   ", which is the services': the links need one of their own",
           .other = PathOf("network", "domain")}};
}

}  // namespace thalweg::link
