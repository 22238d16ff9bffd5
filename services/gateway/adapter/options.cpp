#include "services/gateway/adapter/options.h"

#include <unistd.h>

#include <array>
#include <charconv>
#include <stdexcept>
#include <string>

#include "common/base/environment.h"

namespace thalweg::gateway {

ListenOptions ListenOptionsFromEnvironment() {
  ListenOptions options;
  if (const auto address = Environment("THALWEG_GATEWAY_ADDRESS"); !address.empty())
    options.address = address;
  if (const auto port = Environment("THALWEG_GATEWAY_PORT"); !port.empty()) {
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), options.port);
    const bool whole = error == std::errc() && end == port.data() + port.size();
    if (!whole || options.port < 0 || options.port > 65535) {
      throw std::runtime_error("THALWEG_GATEWAY_PORT is \"" + port + "\", must be 0 to 65535");
    }
  } else {
    options.more_ports = 9;
  }
  options.token = Environment("THALWEG_GATEWAY_TOKEN");
  options.origins = Environment("THALWEG_GATEWAY_ORIGINS");
  const std::string read_only = Environment("THALWEG_GATEWAY_READ_ONLY");
  if (!read_only.empty() && read_only != "0") options.read_only = "the gateway is read-only";
  return options;
}

std::string UrlOf(const ListenOptions& options) {
  std::string host = options.address;
  if (host == "0.0.0.0" || host == "::") {
    std::array<char, 256> name = {};
    host = gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "localhost";
  } else if (host.find(':') != std::string::npos) {
    host = "[" + host + "]";
  }
  const std::string query = options.token.empty() ? "" : "?token=" + options.token;
  return "http://" + host + ":" + std::to_string(options.port) + "/" + query;
}

}  // namespace thalweg::gateway
