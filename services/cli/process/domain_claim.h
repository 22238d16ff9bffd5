#pragma once

#include <string>

namespace thalweg::cli {

/// Held by a run for as long as it lives: two that publish on the same topics ruin each other.
///
/// A socket's name in the abstract namespace, so it is this machine's (or container's) runs that it keeps
/// apart, at once and without a file that could stay behind. Listening for others on the bus would take
/// seconds, and on a busy machine miss them.
class DomainClaim {
 public:
  /// Throws std::runtime_error naming the domain when another run holds it.
  DomainClaim(int domain, const std::string& partition);
  ~DomainClaim();
  DomainClaim(const DomainClaim&) = delete;
  DomainClaim& operator=(const DomainClaim&) = delete;

 private:
  int socket_;
};

}  // namespace thalweg::cli
