#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace thalweg::dds {

/// Ends what is heard of a discovery server with its farewell. Fast DDS 2.9.1 then starts again with the
/// sequence numbers of a server with this prefix, but a server says farewell two or three times: a client
/// that receives another one after that takes its number for one of the successor, whose own announcement,
/// number 1, is to it an old one. Whether it does depends on the timing of its threads.
///
/// Threading: any thread.
class ServerFarewells {
 public:
  using SteadyTime = std::chrono::steady_clock::time_point;
  using GuidPrefix = std::array<std::uint8_t, 12>;
  /// Longer than the last words of a server take; a successor repeats what it says more often than twice.
  static constexpr std::chrono::milliseconds kSilence{500};

  explicit ServerFarewells(std::vector<GuidPrefix> servers) {
    for (const GuidPrefix& server : servers) servers_.push_back({server, SteadyTime::min()});
  }

  /// How many bytes of a message of `size` bytes are to be heard.
  /// @param farewell  How many of them lead to the end of the sender's farewell, if it says one.
  std::size_t Heard(const GuidPrefix& sender, std::size_t size, std::optional<std::size_t> farewell,
                    SteadyTime now) {
    const std::lock_guard lock(mutex_);
    const auto server = std::ranges::find(servers_, sender, &Server::prefix);
    if (server == servers_.end()) return size;
    if (now < server->silent_until) return 0;
    if (!farewell) return size;
    server->silent_until = now + kSilence;
    return *farewell;
  }

 private:
  struct Server {
    GuidPrefix prefix;
    SteadyTime silent_until;
  };
  std::mutex mutex_;
  std::vector<Server> servers_;
};

}  // namespace thalweg::dds
