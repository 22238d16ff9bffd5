#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace thalweg::inspector {

// What a machine and a bus can suffer from: facts in, findings out, so that every finding can be tested with
// facts that are made up.

struct KernelFacts {
  std::optional<std::uint64_t> rmem_max, wmem_max;  ///< [byte] Nothing = cannot be read.
  std::optional<std::uint64_t> ipfrag_high_thresh;  ///< [byte]
  std::uint64_t wanted_socket_bytes = 0;            ///< What our sockets request.
};

struct SharedMemoryFacts {
  bool is_used = true;    ///< Whether the network settings use shared memory at all.
  bool is_there = false;  ///< Whether there is a /dev/shm.
  bool is_writable = false;
  std::string owner;            ///< Who owns the folder.
  std::uint64_t size = 0;       ///< [byte]
  std::uint64_t available = 0;  ///< [byte]
  std::uint64_t segment = 0;    ///< [byte] What each of our processes may use.
  std::size_t stale_files = 0;  ///< Left by processes that were killed.
  std::uint64_t stale_bytes = 0;
  std::string user;                       ///< Who asks.
  std::vector<std::string> other_owners;  ///< Other users who have DDS files there.
};

struct InterfaceFacts {
  std::string name, address;
  bool is_loopback = false;
  bool has_multicast = false;  ///< By its flags.
  std::optional<bool> hears_own_multicast =
      {};  ///< Whether a datagram to a group came back; nothing = not tried.
};

struct DomainFacts {
  int number = 0;
  std::vector<std::string> processes;  ///< "mapper (1234)"; empty if they belong to others.
};

struct PeerFacts {
  std::string name;     ///< "mapper" (1234)
  std::string version;  ///< The process's version of thalweg; empty for other programs.
};

/// How far another machine's clock is from this one's.
struct ClockFacts {
  std::string host;
  /// [s] The smallest of reception by our clock minus writing by theirs: offset plus the fastest transport.
  double least_difference_s = 0.0;
  std::size_t samples = 0;
};

/// A topic under another name than the one on which it is heard.
struct WireNameFacts {
  std::string participant;  ///< "driver" (1234)
  bool writes = false;      ///< Publishes it, else subscribes it.
  std::string topic;        ///< As on the wire: "odometry"
  std::string meant;        ///< The name on the wire that thalweg and ROS 2 use: "rt/odometry"
};

struct DiscoveryServerFacts {
  int id = 0;                 ///< As in `fast-discovery-server -i ID`.
  std::string host_and_port;  ///< "10.0.0.1:11811"
};

struct QosFacts {
  std::string topic, text, advice;
};

struct Facts {
  KernelFacts kernel;
  SharedMemoryFacts shared_memory;
  std::vector<InterfaceFacts> interfaces;
  int domain = 0;                                       ///< The one examined.
  std::string ros_domain_id;                            ///< The variable ROS_DOMAIN_ID; empty = not set.
  std::vector<DomainFacts> domains_in_use;              ///< On this machine.
  std::vector<DiscoveryServerFacts> discovery_servers;  ///< None = multicast discovery.
  std::size_t discovery_servers_answering = 0;
  std::string named_peers;  ///< HOST,HOST,...: announced to in addition; empty = none.
  std::vector<PeerFacts> peers;
  std::vector<QosFacts> mismatches;
  std::vector<WireNameFacts> misnamed;
  std::vector<ClockFacts> clocks;
  std::vector<std::string> uncompared_hosts;  ///< Other machines whose clock could not be compared.
  /// [s] The run's clock minus this machine's; nothing = nobody publishes one.
  std::optional<double> run_clock_ahead_s;
  std::string version;                         ///< Ours.
  std::string out_folder;                      ///< Where runs leave their files.
  std::optional<std::uint64_t> out_available;  ///< [byte] Nothing = no such folder can be made.
};

enum class Level { kOk, kNote, kProblem };

std::string_view NameOf(Level level);  ///< "ok", "note", "problem"

struct Finding {
  Level level = Level::kOk;
  std::string subject;      ///< "socket buffers"
  std::string text;         ///< What was found, in a sentence.
  std::string advice = {};  ///< What to type or to change; empty where nothing need be.
};

/// At least one finding for each subject, in a fixed order.
std::vector<Finding> Diagnose(const Facts& facts);

}  // namespace thalweg::inspector
