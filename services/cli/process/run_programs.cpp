#include "services/cli/process/run_programs.h"

namespace thalweg::cli {
namespace {

std::filesystem::path OwnExecutable() {
  return std::filesystem::read_symlink("/proc/self/exe");
}

Program ProgramIn(const RunPlace& place, const std::string& name) {
  Program program;
  program.name = name;
  program.log = place.folder / (name + ".log");
  return program;
}

void AddDomain(const RunPlace& place, Program& program) {
  if (!place.domain) return;
  program.arguments.insert(program.arguments.end(), {"--domain", std::to_string(*place.domain)});
}

}  // namespace

Program ServiceProgram(const std::string& name, const RunPlace& place) {
  Program program = ProgramIn(place, name);
  program.executable = OwnExecutable().parent_path() / ("thalweg-" + name);
  program.arguments = {"--scenario", place.ScenarioFile().string(), "--out", place.folder.string()};
  AddDomain(place, program);
  return program;
}

Program RecorderProgram(const std::filesystem::path& file, const RunPlace& place) {
  Program program = ProgramIn(place, "recorder");
  program.executable = OwnExecutable();
  program.arguments = {"record", "--out", file.string(), "--scenario", place.ScenarioFile().string()};
  program.expendable = true;
  AddDomain(place, program);
  return program;
}

}  // namespace thalweg::cli
