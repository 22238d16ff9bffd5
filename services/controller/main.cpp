#include <cstdlib>
#include <iostream>

#include "common/service/service.h"
#include "services/controller/adapter/controller_service.h"

int main(int argc, char** argv) try {
  const thalweg::ServiceArgs args = thalweg::ParseServiceArgs(
      argc, argv, "controller",
      "leads the robot along the explorer's path within its limits, and stops it when messages stop arriving",
      thalweg::Files::kNone);
  const thalweg::Scenario scenario =
      thalweg::LoadScenario(args.scenario, args.overrides, {.mistakes = thalweg::controller::MistakesIn});
  const std::stop_token stop = thalweg::StopOnSignals();
  thalweg::dds::Bus bus(thalweg::BusOptionsFrom(scenario, args, "controller"));
  thalweg::controller::ControllerService controller(thalweg::controller::OptionsFrom(scenario), bus);
  bus.Spin(stop);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "controller: " << error.what() << '\n';
  return EXIT_FAILURE;
}
