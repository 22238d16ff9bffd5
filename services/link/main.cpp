#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>

#include "common/service/command_line.h"
#include "common/service/service.h"
#include "services/link/adapter/link_service.h"

int main(int argc, char** argv) try {
  using thalweg::link::Side;
  Side side = Side::kOnboard;
  const auto name_on_bus = [&]() -> std::string {
    return side == Side::kOnboard ? "link-onboard" : "link-offboard";
  };
  const thalweg::ServiceArgs args = thalweg::ParseServiceArgs(
      argc, argv, "link", "carries a run between robot and base station over a thin, lossy or cut link",
      thalweg::Files::kNone,
      [&](CLI::App& app) {
        app.add_option("--side", side, "Where it runs: onboard or offboard")
            ->required()
            ->transform(thalweg::OneOf<Side>({{"onboard", Side::kOnboard}, {"offboard", Side::kOffboard}}))
            ->type_name("NAME");
      },
      name_on_bus);
  const std::string name = name_on_bus();
  const auto mistakes = [&](const thalweg::Scenario& scenario) {
    return thalweg::link::MistakesIn(scenario, thalweg::BusOptionsFrom(scenario, args, name).domain);
  };
  const thalweg::Scenario scenario =
      thalweg::LoadScenario(args.scenario, args.overrides, {.mistakes = mistakes});
  const std::stop_token stop = thalweg::StopOnSignals();
  const thalweg::dds::BusOptions given = thalweg::BusOptionsFrom(scenario, args, name);
  const thalweg::link::LinkOptions options = thalweg::link::OptionsFrom(scenario);
  thalweg::dds::Bus service(thalweg::link::ServiceBusOptions(given));
  thalweg::dds::Bus local(thalweg::link::LocalBusOptions(given));
  thalweg::dds::Bus network(thalweg::link::NetworkBusOptions(given, options));
  thalweg::link::LinkService link(options, side, {service, local, network});
  link.Run(stop);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "link: " << error.what() << '\n';
  return EXIT_FAILURE;
}
