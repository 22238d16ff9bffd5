#pragma once

#include <optional>
#include <string>

namespace thalweg::gateway {

/// Where the gateway listens. Settings of the machine, not of the exploration, so that no scenario contains
/// them; and a token given on the command line could be read by every user of the machine.
struct ListenOptions {
  std::string address = "127.0.0.1";  ///< IPv4 or IPv6 address. THALWEG_GATEWAY_ADDRESS
  int port = 8765;                    ///< 0 = any free one. THALWEG_GATEWAY_PORT
  int more_ports = 0;  ///< How many of those that follow are tried where others listen already.
  std::optional<std::string> read_only;  ///< Why no client may steer the robot. THALWEG_GATEWAY_READ_ONLY
  std::string origins;  ///< Other pages that may connect, separated by commas. THALWEG_GATEWAY_ORIGINS
  std::string token;    ///< "" = none; required unless the address is loopback. THALWEG_GATEWAY_TOKEN
};

/// Where no port is named, nine more are tried: of several runs on a machine, each is shown. Throws
/// std::runtime_error naming the invalid variable.
ListenOptions ListenOptionsFromEnvironment();

/// The address of the page for people, e.g. http://127.0.0.1:8765/. Addresses that mean every interface are
/// shown as this machine's name.
std::string UrlOf(const ListenOptions& options);

}  // namespace thalweg::gateway
