#include <spdlog/spdlog.h>

#include <cstdlib>
#include <iostream>
#include <optional>

#include "common/service/service.h"
#include "services/stereo/adapter/stereo_service.h"

int main(int argc, char** argv) try {
  const thalweg::ServiceArgs args = thalweg::ParseServiceArgs(
      argc, argv, "stereo", "matches image pairs and publishes disparities and point clouds",
      thalweg::Files::kNone);
  const thalweg::Scenario scenario = thalweg::LoadScenario(args.scenario, args.overrides);
  const std::stop_token stop = thalweg::StopOnSignals();
  thalweg::dds::Bus bus(thalweg::BusOptionsFrom(scenario, args, "stereo"));
  std::optional<thalweg::stereo::StereoService> stereo;
  if (scenario.depth_source() == thalweg::DepthSource::STEREO) {
    stereo.emplace(thalweg::stereo::OptionsFrom(scenario), bus);
  } else {  // Stays up: whoever started it for every scenario takes an exit for a fault.
    spdlog::warn("idle: depth_source is {}, not STEREO",
                 thalweg::DepthSource::Kind_Name(scenario.depth_source()));
  }
  bus.Spin(stop);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "stereo: " << error.what() << '\n';
  return EXIT_FAILURE;
}
