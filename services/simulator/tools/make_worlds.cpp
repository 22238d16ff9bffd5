#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>

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
  if (argc != 2) {
    std::cerr << "usage: thalweg-make-worlds FOLDER\n";
    return EXIT_FAILURE;
  }
  const std::filesystem::path folder = argv[1];
  for (const BoxWorld& world : {MakeKitchen(), MakeFlat(), MakeTiny()}) {
    WriteText(folder / (world.name() + ".obj"), world.Obj());
    WriteText(folder / (world.name() + ".mtl"), world.Mtl());
  }
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "make-worlds: " << error.what() << '\n';
  return EXIT_FAILURE;
}
