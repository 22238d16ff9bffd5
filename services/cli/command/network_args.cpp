#include "services/cli/command/network_args.h"

#include "common/service/command_line.h"
#include "common/service/service.h"

namespace thalweg::cli {
namespace {

constexpr int kLastDomain = 232;  // whose ports fit into 16 bits

}  // namespace

void AddDomainOption(CLI::App& command, int& domain, const std::string& more) {
  command.add_option("--domain", domain, "DDS domain; overrides THALWEG_DOMAIN and the scenario's" + more)
      ->check(CLI::Range(0, kLastDomain));
}

void AddNetworkArgs(CLI::App& command, NetworkArgs& args) {
  command.add_option("--scenario", args.scenario, "Scenario whose network is used: a name or a file")
      ->envname("THALWEG_SCENARIO")
      ->capture_default_str();
  AddDomainOption(command, args.domain);
}

dds::BusOptions BusOptionsFrom(const Scenario& scenario, int domain, const std::string& name) {
  ServiceArgs service;
  service.domain = domain;
  service.files = Files::kNone;
  dds::BusOptions options = BusOptionsFrom(scenario, service, name);
  options.clock = dds::ClockSource::kSystem;
  options.publish_health = false;
  options.sole = false;
  return options;
}

dds::BusOptions BusOptionsFrom(const NetworkArgs& args, const std::string& name) {
  return BusOptionsFrom(LoadScenario(args.scenario), args.domain, name);
}

}  // namespace thalweg::cli
