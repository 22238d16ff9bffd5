#include <spdlog/spdlog.h>

#include <cstdlib>
#include <iostream>
#include <optional>

#include "common/service/service.h"
#include "services/visual_odometry/adapter/visual_odometry_service.h"

int main(int argc, char** argv) try {
  using namespace thalweg;
  const ServiceArgs args = ParseServiceArgs(
      argc, argv, "visual-odometry",
      "publishes the robot's pose, from its images or from another publisher's poses", Files::kNone);
  const Scenario scenario = LoadScenario(args.scenario, args.overrides);
  const std::stop_token stop = StopOnSignals();
  dds::Bus bus(BusOptionsFrom(scenario, args, "visual-odometry"));
  std::optional<visual_odometry::VisualOdometryService> odometry;
  if (scenario.odometry_source() == OdometrySource::VISUAL_ODOMETRY) {
    odometry.emplace(visual_odometry::OptionsFrom(scenario), bus);
  } else {  // Stays up: whoever started it for every scenario takes an exit for a fault.
    spdlog::warn("idle: odometry_source is {}, not VISUAL_ODOMETRY",
                 OdometrySource::Kind_Name(scenario.odometry_source()));
  }
  bus.Spin(stop);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "visual-odometry: " << error.what() << '\n';
  return EXIT_FAILURE;
}
