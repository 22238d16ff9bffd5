#include <cstdlib>
#include <iostream>

#include "common/service/service.h"
#include "services/mapper/adapter/mapper_service.h"

int main(int argc, char** argv) try {
  const thalweg::ServiceArgs args = thalweg::ParseServiceArgs(
      argc, argv, "mapper",
      "fuses point clouds into the occupancy map, publishes what changed, and saves the map on exit");
  const thalweg::Scenario scenario = thalweg::LoadScenario(args.scenario, args.overrides);
  const std::stop_token stop = thalweg::StopOnSignals();
  thalweg::dds::Bus bus(thalweg::BusOptionsFrom(scenario, args, "mapper"));
  thalweg::mapper::MapperService mapper(thalweg::mapper::OptionsFrom(scenario, args.out), bus);
  bus.Spin(stop);
  mapper.Save();
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "mapper: " << error.what() << '\n';
  return EXIT_FAILURE;
}
