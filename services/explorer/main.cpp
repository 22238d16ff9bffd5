#include <cstdlib>
#include <iostream>

#include "common/service/service.h"
#include "services/explorer/adapter/exploration_file.h"
#include "services/explorer/adapter/explorer_service.h"
#include "services/explorer/adapter/options.h"

int main(int argc, char** argv) try {
  const std::stop_token stop = thalweg::StopOnSignals();
  const thalweg::ServiceArgs args = thalweg::ParseServiceArgs(
      argc, argv, "explorer",
      "decides where to look and go until nothing reachable is left to see, and publishes the path");
  const thalweg::Scenario scenario =
      thalweg::LoadScenario(args.scenario, args.overrides, {.mistakes = thalweg::explorer::MistakesIn});
  thalweg::dds::Bus bus(thalweg::BusOptionsFrom(scenario, args, "explorer"));
  thalweg::explorer::ExplorerService explorer(
      thalweg::explorer::OptionsFrom(scenario), bus,
      {.path = std::filesystem::path(args.out) / thalweg::explorer::kExplorationFile,
       .place = thalweg::explorer::PlaceOf(scenario)},
      scenario.depth_source() == thalweg::DepthSource::DEPTH_IMAGE
          ? thalweg::explorer::ExplorerService::ViewSource::kDepthImages
          : thalweg::explorer::ExplorerService::ViewSource::kClouds);
  bus.Spin(stop);
  explorer.Forget();
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "explorer: " << error.what() << '\n';
  return EXIT_FAILURE;
}
