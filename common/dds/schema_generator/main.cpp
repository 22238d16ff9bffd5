#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "common/dds/schema_generator/idl_model.h"

/// Prints the table of schemas that common/dds/schema.cpp includes. Runs during the build.
/// usage: thalweg_schema_generator FILE.idl...
int main(int argc, char** argv) try {
  thalweg::idl::IdlModel model;
  for (int k = 1; k < argc; ++k) {
    std::ifstream in(argv[k]);
    if (!in) throw std::runtime_error(std::string(argv[k]) + ": cannot be read");
    std::ostringstream text;
    text << in.rdbuf();
    model.Add(argv[k], text.str());
  }
  std::cout << "constexpr Schema kSchemas[] = {\n";
  for (const std::string& name : model.Structs()) {
    std::cout << "{\"" << name << "\", R\"schema(" << model.Ros2Msg(name) << ")schema\", R\"schema("
              << model.Description(name) << ")schema\"},\n";
  }
  std::cout << "};\n";
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return EXIT_FAILURE;
}
