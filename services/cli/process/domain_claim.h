#pragma once

#include <string>

namespace thalweg::cli {

/// Reserves a DDS domain for a run while it exists: two runs that publish on the same topics would spoil each
/// other.
///
/// Uses the name of a socket in the abstract namespace, so that it separates runs on one machine (or in one
/// container), instantly and without a file that could be left behind. Discovering other runs on the bus
/// would take seconds, and might miss them on a busy machine.
class DomainClaim {
 public:
  /// Throws std::runtime_error naming the domain if another run has reserved it.
  DomainClaim(int domain, const std::string& partition);
  ~DomainClaim();
  DomainClaim(const DomainClaim&) = delete;
  DomainClaim& operator=(const DomainClaim&) = delete;

 private:
  int socket_;
};

}  // namespace thalweg::cli
