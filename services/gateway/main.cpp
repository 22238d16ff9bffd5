#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <thread>

#include "common/dds/security.h"
#include "common/service/service.h"
#include "services/gateway/adapter/gateway_service.h"
#include "services/gateway/adapter/options.h"

int main(int argc, char** argv) try {
  std::filesystem::path announce;
  const thalweg::ServiceArgs args = thalweg::ParseServiceArgs(
      argc, argv, "gateway", "shows the run to browsers and Foxglove clients", thalweg::Files::kNone,
      [&](CLI::App& app) {
        app.add_option("--announce", announce, "Write the port to this file as soon as it is served");
      });
  const thalweg::Scenario scenario = thalweg::LoadScenario(args.scenario, args.overrides);
  const std::stop_token stop = thalweg::StopOnSignals();
  thalweg::dds::BusOptions options = thalweg::BusOptionsFrom(scenario, args, "gateway");
  options.sole = false;    // any number of viewers may look at a run
  options.surveys = true;  // for the graph of connections
  const thalweg::dds::BusOptions bus_options = options;
  thalweg::dds::Bus bus(bus_options);
  const bool with_time = options.clock == thalweg::dds::ClockSource::kTopic;
  options.name = "gateway channels";
  options.clock = thalweg::dds::ClockSource::kSystem;  // the clock is a channel like the others
  options.publish_health = false;
  options.surveys = false;
  thalweg::dds::Bus channels(options);
  thalweg::gateway::ListenOptions listen = thalweg::gateway::ListenOptionsFromEnvironment();
  const std::filesystem::path keys = options.security_dir;
  if (!keys.empty() && thalweg::dds::RoleOf(options.name, keys) == "listener")
    listen.read_only = "the gateway has only the keys of a listener";
  thalweg::gateway::GatewayService gateway(listen, with_time, scenario,
                                           thalweg::gateway::LoadPage(thalweg::gateway::PageFolder()),
                                           bus_options, bus, channels);
  listen.port = gateway.port();
  listen.token.clear();  // belongs in no log
  spdlog::info("serving {}", thalweg::gateway::UrlOf(listen));
  if (!announce.empty()) std::ofstream(announce) << listen.port << std::endl;
  const std::jthread passing([&](const std::stop_token& own) {
    try {
      channels.Spin(own);
    } catch (const std::exception& error) {
      bus.Post([what = std::string(error.what())] { throw std::runtime_error(what); });
    }
  });
  bus.Spin(stop);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "gateway: " << error.what() << '\n';
  return EXIT_FAILURE;
}
