#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "common/files/write_file.h"
#include "common/service/command_line.h"
#include "services/simulator/tools/random_world.h"
#include "services/simulator/tools/worlds.h"

namespace {

using namespace thalweg::simulator;
using thalweg::WriteFile;

void Write(const std::filesystem::path& folder, const BoxWorld& world) {
  WriteFile(folder / (world.name() + ".obj"), world.Obj());
  WriteFile(folder / (world.name() + ".mtl"), world.Mtl());
}

}  // namespace

/// Writes the worlds of deploy/worlds into a folder as OBJ and MTL, or random worlds with a scenario each.
int main(int argc, char** argv) try {
  CLI::App app("Writes the worlds of deploy/worlds, each as NAME.obj and NAME.mtl; or random ones",
               "thalweg-make-worlds");
  thalweg::AddVersion(app);
  std::filesystem::path folder;
  std::uint32_t count = 0;
  RandomWorldOptions random;
  app.add_option("folder", folder, "Output folder; files of the same names in it are overwritten")
      ->required()
      ->check(CLI::ExistingDirectory);
  CLI::Option* const counted =
      app.add_option("--random", count, "Write this many random worlds instead, each with a scenario")
          ->check(CLI::Range(1, 10000));
  app.add_option("--seed", random.seed, "Seed of the first random world; the others count up from it")
      ->capture_default_str()
      ->needs(counted);
  app.add_option("--clutter", random.clutter, "Pieces of furniture per square meter, 0 to 2")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 2.0))
      ->needs(counted);
  app.add_option("--scale", random.scale, "Factor on the length and width of the floor, 1 to 5")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 5.0))
      ->needs(counted);
  std::vector<std::string> layouts;
  for (const auto& [name, layout] : LayoutNames()) layouts.push_back(name);
  app.add_option_function<std::string>(
         "--layout",
         [&](const std::string& name) {
           random.layout = std::ranges::find(LayoutNames(), name, &LayoutName::first)->second;
         },
         "Layout of all of them, in place of rooms, corridor, stalls or hall by the seed modulo 4")
      ->check(CLI::IsMember(layouts))
      ->needs(counted);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return thalweg::ReportParseError(app, error, "make-worlds");
  }
  if (count == 0) {
    for (const BoxWorld& world : MakeAllWorlds()) Write(folder, world);
  }
  for (; count > 0; --count, ++random.seed) {
    const RandomWorld world = MakeRandomWorld(random);
    Write(folder, world.boxes);
    WriteFile(folder / (world.boxes.name() + ".txtpb"), ScenarioText(world));
  }
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "make-worlds: " << error.what() << '\n';
  return EXIT_FAILURE;
}
