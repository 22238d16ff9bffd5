#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include "common/service/command_line.h"
#include "services/simulator/tools/worlds.h"

namespace {

void WriteText(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace

/// Writes the worlds that deploy/worlds holds, as OBJ and MTL, into a folder.
int main(int argc, char** argv) try {
  using namespace thalweg::simulator;
  CLI::App app("Writes the worlds of deploy/worlds, each as NAME.obj and NAME.mtl");
  std::filesystem::path folder;
  app.add_option("folder", folder, "Where to; files of these names there are replaced")
      ->required()
      ->check(CLI::ExistingDirectory);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return thalweg::TellOf(app, error, "make-worlds");
  }
  for (const BoxWorld& world : MakeAllWorlds()) {
    WriteText(folder / (world.name() + ".obj"), world.Obj());
    WriteText(folder / (world.name() + ".mtl"), world.Mtl());
  }
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "make-worlds: " << error.what() << '\n';
  return EXIT_FAILURE;
}
