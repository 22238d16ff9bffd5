#include "services/cli/process/run_programs.h"

#include <charconv>
#include <fstream>
#include <system_error>

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

std::filesystem::path ExecutableOf(const std::string& name) {
  return OwnExecutable().parent_path() / ("thalweg-" + name);
}

std::filesystem::path PortFile(const RunPlace& place) {
  return place.folder / "gateway.port";
}

void AddDomain(std::optional<int> domain, Program& program) {
  if (!domain) return;
  program.arguments.insert(program.arguments.end(), {"--domain", std::to_string(*domain)});
}

}  // namespace

Program ServiceProgram(const std::string& name, const RunPlace& place) {
  Program program = ProgramIn(place, name);
  program.executable = ExecutableOf(name);
  program.arguments = {"--scenario", place.ScenarioFile().string(), "--out", place.folder.string()};
  AddDomain(place.domain, program);
  return program;
}

Program GatewayProgram(const RunPlace& place) {
  Program program = ServiceProgram("gateway", place);
  program.arguments.insert(program.arguments.end(), {"--announce", PortFile(place).string()});
  return program;
}

Program ViewProgram(const RemoteView& view) {
  Program program;
  program.name = "gateway";
  program.executable = ExecutableOf(program.name);
  program.arguments = {"--scenario", view.scenario};
  for (const std::string& field : view.overrides) {
    program.arguments.insert(program.arguments.end(), {"--set", field});
  }
  AddDomain(view.domain, program);
  program.arguments.insert(program.arguments.end(), {"--announce", view.announcement});
  return program;
}

std::optional<int> TakeAnnouncedPort(const RunPlace& place) {
  std::ifstream in(PortFile(place));
  std::string line;
  if (!std::getline(in, line) || in.eof()) return std::nullopt;  // it is not there, or not yet whole
  int port = 0;
  std::from_chars(line.data(), line.data() + line.size(), port);
  std::error_code ignored;
  std::filesystem::remove(PortFile(place), ignored);
  return port;
}

Program RecorderProgram(const std::filesystem::path& file, const RunPlace& place,
                        const std::string& scenario) {
  Program program = ProgramIn(place, "recorder");
  program.executable = OwnExecutable();
  program.arguments = {"record", "--out", file.string(), "--scenario", place.ScenarioFile().string(),
                       "--name", scenario};
  program.expendable = true;
  AddDomain(place.domain, program);
  return program;
}

}  // namespace thalweg::cli
