#include <cstdlib>
#include <iostream>

#include "common/service/service.h"
#include "services/surface/adapter/surface_service.h"

int main(int argc, char** argv) try {
  const thalweg::ServiceArgs args =
      thalweg::ParseServiceArgs(argc, argv, "surface",
                                "fuses point clouds into one surface, publishes its mesh and how well it was "
                                "seen, and saves it on exit");
  const thalweg::Scenario scenario = thalweg::LoadScenario(args.scenario, args.overrides);
  const std::stop_token stop = thalweg::StopOnSignals();
  thalweg::dds::Bus bus(thalweg::BusOptionsFrom(scenario, args, "surface"));
  thalweg::surface::SurfaceService surface(thalweg::surface::OptionsFrom(scenario, args.out), bus);
  bus.Spin(stop);
  surface.Save();
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "surface: " << error.what() << '\n';
  return EXIT_FAILURE;
}
