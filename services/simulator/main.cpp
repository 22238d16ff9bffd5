#include <spdlog/spdlog.h>

#include <cstdlib>
#include <iostream>

#include "common/service/service.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/adapter/mistakes.h"
#include "services/simulator/adapter/simulator_service.h"

int main(int argc, char** argv) try {
  using namespace thalweg;
  const ServiceArgs args = ParseServiceArgs(
      argc, argv, "simulator", "stands in for the robot and its sensors in a simulated world", Files::kNone);
  const Scenario scenario = LoadScenario(args.scenario, args.overrides, {.mistakes = simulator::MistakesIn});
  const std::stop_token stop = StopOnSignals();
  simulator::World world = simulator::LoadWorld(scenario);
  const simulator::SimulatorOptions options = simulator::OptionsFrom(scenario, world);
  dds::BusOptions bus_options = BusOptionsFrom(scenario, args, "simulator");
  bus_options.clock = dds::ClockSource::kOwn;
  dds::Bus bus(bus_options);
  // Posted, so that it follows the bus's own first line in the log.
  bus.Post([about = simulator::DescriptionOf(scenario, world)] { spdlog::info("{}", about); });
  simulator::SimulatorService simulator(options, std::move(world), bus);
  bus.Spin(stop);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "simulator: " << error.what() << '\n';
  return EXIT_FAILURE;
}
