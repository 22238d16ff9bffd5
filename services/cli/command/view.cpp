#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/scenario/scenario.h"
#include "services/cli/command/command.h"
#include "services/cli/process/browser.h"
#include "services/gateway/adapter/options.h"
#include "services/gateway/adapter/page_files.h"

namespace thalweg::cli {
namespace {

struct ViewArgs {
  std::string scenario = kDefaultScenario;
  std::vector<std::string> overrides;
  int domain = -1;
  std::string address;
  int port = -1;
  bool read_only = false;
};

/// Reads the port that the gateway announces, and prints where to look. Nothing if the gateway ends before.
void PrintAddress(int announcement, gateway::ListenOptions listen) {
  std::string text;
  char character = 0;
  while (read(announcement, &character, 1) == 1 && character != '\n') text += character;
  if (character != '\n') return;
  listen.port = std::stoi(text);
  const std::string url = gateway::UrlOf(listen);
  std::cout << (gateway::HasPage() ? "Open " + url + " in a browser, or the same with ws:// in Foxglove."
                                   : gateway::NoPageText(url))
            << " Ctrl-C ends the view, not the run." << std::endl;
  if (gateway::HasPage() && listen.token.empty() && HasBrowser(isatty(STDOUT_FILENO) != 0))
    OpenInBrowser(gateway::UrlOf(listen));
}

/// Starts a process that prints the address, which is known once the gateway serves it.
/// @return  The file to which the gateway is to announce its port.
std::string BeginToPrintAddress() {
  const gateway::ListenOptions listen = gateway::ListenOptionsFromEnvironment();
  std::array<int, 2> announcement{};
  if (pipe(announcement.data()) != 0) {
    throw std::runtime_error(std::string("no pipe for the gateway's port: ") + std::strerror(errno));
  }
  const auto [out, in] = announcement;
  const pid_t child = fork();
  if (child == 0) {
    close(in);
    // The grandchild belongs to nobody who would have to wait for it.
    if (fork() == 0) PrintAddress(out, listen);
    _exit(0);
  }
  close(out);
  waitpid(child, nullptr, 0);
  return "/dev/fd/" + std::to_string(in);
}

/// Becomes the gateway; returns only by an exception.
void View(const ViewArgs& args) {
  if (!args.address.empty()) setenv("THALWEG_GATEWAY_ADDRESS", args.address.c_str(), 1);
  if (args.port >= 0) setenv("THALWEG_GATEWAY_PORT", std::to_string(args.port).c_str(), 1);
  if (args.read_only) setenv("THALWEG_GATEWAY_READ_ONLY", "1", 1);
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "thalweg-gateway";
  std::vector<std::string> words = {program.string(), "--scenario", args.scenario};
  for (const std::string& field : args.overrides) words.insert(words.end(), {"--set", field});
  if (args.domain >= 0) words.insert(words.end(), {"--domain", std::to_string(args.domain)});
  words.insert(words.end(), {"--announce", BeginToPrintAddress()});
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  throw std::runtime_error("cannot start " + program.string() + ": " + std::strerror(errno));
}

}  // namespace

void AddView(CLI::App& app) {
  const auto args = std::make_shared<ViewArgs>();
  CLI::App* command = app.add_subcommand("view", "Show a run that was started elsewhere in the browser");
  command->add_option("scenario", args->scenario, "Name of a scenario in deploy/scenarios, or a file")
      ->envname("THALWEG_SCENARIO")
      ->capture_default_str();
  command->add_option("--set", args->overrides, "field=value, overrides the scenario's")
      ->allow_extra_args(false);
  command->add_option("--domain", args->domain, "DDS domain; overrides THALWEG_DOMAIN and the scenario's")
      ->check(CLI::Range(0, 232));
  command->add_option("--address", args->address,
                      "Address to listen on; one that other machines reach needs THALWEG_GATEWAY_TOKEN");
  command
      ->add_option("--port", args->port,
                   "Port to listen on; default: " + std::to_string(gateway::ListenOptions().port) +
                       ", or the next that is free")
      ->check(CLI::Range(1, 65535));
  command->add_flag("--read-only", args->read_only, "Show the run, and let nobody steer it from there");
  command->callback([args] { View(*args); });
}

}  // namespace thalweg::cli
