#include <cstdlib>
#include <iostream>

#include "common/service/service.h"
#include "services/visual_odometry/adapter/visual_odometry_service.h"

/// Visual odometry: publishes the robot's pose, from its images or from another publisher's poses.
int main(int argc, char** argv) try {
  using namespace thalweg;
  const ServiceArgs args = ParseServiceArgs(argc, argv, "visual-odometry");
  const Scenario scenario = LoadScenario(args.scenario, args.overrides);
  const std::stop_token stop = StopOnSignals();
  dds::Bus bus(BusOptionsFrom(scenario, args, "visual-odometry"));
  visual_odometry::VisualOdometryService odometry(visual_odometry::OptionsFrom(scenario), bus);
  bus.Spin(stop);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "visual-odometry: " << error.what() << '\n';
  return EXIT_FAILURE;
}
