#include "services/cli/process/domain_claim.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <functional>
#include <stdexcept>

namespace thalweg::cli {

DomainClaim::DomainClaim(int domain, const std::string& partition)
    : socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
  const std::string where = "DDS domain " + std::to_string(domain);
  if (socket_ < 0) throw std::runtime_error("cannot claim " + where + ": " + std::strerror(errno));
  // A hash, since a partition's name may be longer than a socket address.
  const std::string name =
      "thalweg-run-" + std::to_string(domain) + '-' + std::to_string(std::hash<std::string>()(partition));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(name.begin(), name.end(), address.sun_path + 1);  // begins with 0: abstract
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), size) == 0) return;
  const int error = errno;
  close(socket_);
  if (error != EADDRINUSE) throw std::runtime_error("cannot claim " + where + ": " + std::strerror(error));
  throw std::runtime_error("another run is going on in " + where +
                           ": give this one its own with --domain N, or follow that one with "
                           "thalweg watch");
}

DomainClaim::~DomainClaim() {
  close(socket_);
}

}  // namespace thalweg::cli
