#include <cstdlib>
#include <iostream>

#include "common/service/service.h"
#include "services/stereo/adapter/stereo_service.h"

/// Stereo: matches image pairs and publishes disparities and point clouds.
int main(int argc, char** argv) try {
  const thalweg::ServiceArgs args = thalweg::ParseServiceArgs(argc, argv, "stereo");
  const thalweg::Scenario scenario = thalweg::LoadScenario(args.scenario, args.overrides);
  const std::stop_token stop = thalweg::StopOnSignals();
  thalweg::dds::Bus bus(thalweg::BusOptionsFrom(scenario, args, "stereo"));
  thalweg::stereo::StereoService stereo(thalweg::stereo::OptionsFrom(scenario), bus);
  bus.Spin(stop);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "stereo: " << error.what() << '\n';
  return EXIT_FAILURE;
}
