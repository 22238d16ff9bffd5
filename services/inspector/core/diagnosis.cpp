#include "services/inspector/core/diagnosis.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/base/megabytes.h"

namespace thalweg::inspector {
namespace {

using Findings = std::vector<Finding>;

std::string Size(std::uint64_t bytes) {
  const double megabytes = Megabytes(static_cast<double>(bytes));
  if (megabytes >= 1000) return fmt::format("{:.1f} GB", 1e-3 * megabytes);
  return fmt::format("{:.{}f} MB", megabytes, megabytes < 10 ? 1 : 0);
}

void CheckSocketBuffers(const KernelFacts& kernel, Findings& out) {
  const std::uint64_t wanted = kernel.wanted_socket_bytes;
  const auto check = [&](const char* name, const std::optional<std::uint64_t>& granted) {
    if (!granted) {
      out.push_back({Level::kNote, "socket buffers", fmt::format("net.core.{} cannot be read here", name)});
    } else if (*granted < wanted) {
      out.push_back(
          {Level::kNote, "socket buffers",
           fmt::format("net.core.{} grants {} of the {} that our sockets request: large messages from other "
                       "machines are lost and repeated",
                       name, Size(*granted), Size(wanted)),
           fmt::format("sysctl -w net.core.{}={}", name, wanted)});
    } else {
      out.push_back({Level::kOk, "socket buffers", fmt::format("net.core.{} is {}", name, Size(*granted))});
    }
  };
  check("rmem_max", kernel.rmem_max);
  check("wmem_max", kernel.wmem_max);
}

void CheckFragments(const Facts& facts, Findings& out) {
  constexpr std::uint64_t kDefault = 4U << 20;  // of Linux
  const auto& threshold = facts.kernel.ipfrag_high_thresh;
  if (!threshold) return;
  Finding finding{Level::kOk, "IP fragments", "memory for cut packets is " + Size(*threshold)};
  if (*threshold < kDefault) {
    finding.level = Level::kNote;
    finding.text += ", less than Linux's default; drivers that send large messages in one packet lose them";
    finding.advice = fmt::format("sysctl -w net.ipv4.ipfrag_high_thresh={}", kDefault);
  }
  out.push_back(finding);
}

void CheckSharedMemory(const SharedMemoryFacts& memory, Findings& out) {
  const std::string subject = "shared memory";
  if (!memory.is_used) {
    out.push_back({Level::kOk, subject, "is switched off: processes of one machine talk by UDP"});
    return;
  }
  if (!memory.is_there || !memory.is_writable) {
    out.push_back({Level::kProblem, subject,
                   memory.is_there ? fmt::format("/dev/shm belongs to {}, and {} cannot write there",
                                                 memory.owner, memory.user)
                                   : std::string("there is no /dev/shm"),
                   memory.is_there ? "chmod 1777 /dev/shm, or --set network.shared_memory=false"
                                   : "mount -t tmpfs tmpfs /dev/shm, or --set network.shared_memory=false"});
    return;
  }
  Finding size{Level::kOk, subject,
               fmt::format("/dev/shm has {} free of {}", Size(memory.available), Size(memory.size))};
  const std::string larger = "mount -o remount,size=1G /dev/shm; for a container: --shm-size 1g";
  constexpr std::uint64_t kProcesses = 8;  // of a whole run
  if (memory.available < memory.segment) {
    size.level = Level::kProblem;
    size.text += fmt::format("; a process may need {}", Size(memory.segment));
    size.advice = larger;
  } else if (memory.available < kProcesses * memory.segment) {
    size.level = Level::kNote;
    size.text += fmt::format("; {} processes with large messages may need {}", kProcesses,
                             Size(kProcesses * memory.segment));
    size.advice = larger;
  }
  out.push_back(size);
  if (memory.stale_files > 0) {
    out.push_back(
        {Level::kNote, subject,
         fmt::format("killed processes left {} files with {}", memory.stale_files, Size(memory.stale_bytes)),
         "nothing to do: each process of thalweg removes such files when it starts"});
  }
  if (!memory.other_owners.empty()) {
    out.push_back(
        {Level::kNote, subject,
         fmt::format("{} {} DDS files in /dev/shm as well: processes of different users on one machine do "
                     "not hear each other, without a message",
                     fmt::join(memory.other_owners, ", "), memory.other_owners.size() == 1 ? "has" : "have"),
         "run all of them as " + memory.user + ", or --set network.shared_memory=false for all"});
  }
}

void CheckInterfaces(const Facts& facts, Findings& out) {
  bool any = false;
  bool any_network = false;
  for (const InterfaceFacts& interface : facts.interfaces) {
    const std::string name = interface.name + ' ' + interface.address;
    any_network = any_network || !interface.is_loopback;
    if (interface.is_loopback) continue;
    if (!interface.has_multicast) {
      out.push_back({Level::kNote, "network", name + " has no multicast: peers beyond it are not discovered",
                     "ip link set " + interface.name +
                         " multicast on, or THALWEG_PEERS=HOST,... with the other machines"});
    } else if (interface.hears_own_multicast == false) {
      out.push_back({Level::kNote, "network",
                     name + " does not return a datagram to a multicast group: a firewall or a missing route",
                     "ip route add 224.0.0.0/4 dev " + interface.name + ", and allow UDP in the firewall"});
    } else {
      out.push_back({Level::kOk, "network", name + ", multicast works on this machine"});
    }
    any = true;
  }
  if (any || any_network) return;
  out.push_back({Level::kNote, "network",
                 "no network but this machine's own: other machines cannot be reached", "ip address"});
}

void CheckDomain(const Facts& facts, Findings& out) {
  for (const DomainFacts& domain : facts.domains_in_use) {
    out.push_back(
        {Level::kOk, "domain",
         fmt::format("{} is used on this machine by {}{}", domain.number,
                     domain.processes.empty() ? "processes of other users"
                                              : fmt::format("{}", fmt::join(domain.processes, ", ")),
                     domain.number == facts.domain ? "" : ", not the one examined here")});
  }
  if (!facts.ros_domain_id.empty() && facts.ros_domain_id != std::to_string(facts.domain)) {
    out.push_back({Level::kNote, "domain",
                   fmt::format("ROS_DOMAIN_ID is {}, thalweg uses domain {}: they do not hear each other",
                               facts.ros_domain_id, facts.domain),
                   "export THALWEG_DOMAIN=" + facts.ros_domain_id});
  }
  out.push_back({facts.peers.empty() ? Level::kNote : Level::kOk, "domain",
                 fmt::format("{} participant{} in domain {}", facts.peers.size(),
                             facts.peers.size() == 1 ? "" : "s", facts.domain),
                 facts.peers.empty() ? "start a run, or name its domain with --domain" : ""});
}

void CheckDiscoveryServer(const Facts& facts, Findings& out) {
  const std::size_t count = facts.discovery_servers.size();
  if (count == 0) {
    out.push_back({Level::kOk, "discovery",
                   facts.named_peers.empty() ? "by multicast, without a server"
                                             : "by multicast, and at " + facts.named_peers});
    return;
  }
  std::vector<std::string> addresses;
  std::vector<std::string> commands;
  for (const auto& [id, host_and_port] : facts.discovery_servers) {
    addresses.push_back(host_and_port);
    const std::size_t colon = host_and_port.rfind(':');
    const std::string port = colon == std::string::npos ? "11811" : host_and_port.substr(colon + 1);
    commands.push_back(fmt::format("fast-discovery-server -i {} -l ADDRESS -p {}", id, port));
  }
  const std::string advice = fmt::format("{} on that machine, with that id", fmt::join(commands, ", or "));
  const std::string servers =
      fmt::format("the server{} {}", count == 1 ? "" : "s", fmt::join(addresses, " and "));
  if (facts.discovery_servers_answering >= count) {
    out.push_back({Level::kOk, "discovery", servers + (count == 1 ? " answers" : " answer")});
  } else if (facts.discovery_servers_answering > 0) {
    out.push_back({Level::kProblem, "discovery",
                   fmt::format("of {} only {} of {} answers: none takes over", servers,
                               facts.discovery_servers_answering, count),
                   advice});
  } else {
    out.push_back({Level::kProblem, "discovery",
                   servers + (count == 1 ? " does" : " do") + " not answer: nobody is discovered", advice});
  }
}

void CheckQos(const Facts& facts, Findings& out) {
  for (const QosFacts& mismatch : facts.mismatches) {
    out.push_back({Level::kProblem, "QoS", mismatch.topic + ": " + mismatch.text, mismatch.advice});
  }
  if (facts.mismatches.empty())
    out.push_back({Level::kOk, "QoS", "whoever uses the same topic fits together"});
}

void CheckVersions(const Facts& facts, Findings& out) {
  Finding finding{Level::kOk, "version", "thalweg " + facts.version};
  for (const PeerFacts& peer : facts.peers) {
    if (peer.version.empty() || peer.version == facts.version) continue;
    finding.level = Level::kProblem;
    finding.text += fmt::format("; {} is of {}", peer.name, peer.version);
    finding.advice = "install the same version everywhere";
  }
  out.push_back(finding);
}

void CheckClocks(const Facts& facts, Findings& out) {
  constexpr double kGood = 0.005;
  constexpr double kBad = 0.05;
  for (const ClockFacts& clock : facts.clocks) {
    const double size = std::abs(clock.least_difference_s);
    Finding finding{
        Level::kOk, "clocks",
        fmt::format("{} is {:.1f} ms {} this machine, by {} messages of health", clock.host, 1e3 * size,
                    clock.least_difference_s < 0 ? "ahead of" : "behind", clock.samples)};
    if (size > kGood) {
      finding.level = size > kBad ? Level::kProblem : Level::kNote;
      finding.advice = "run chrony on both machines; chronyc tracking";
    }
    out.push_back(finding);
  }
}

void CheckRunClock(const Facts& facts, Findings& out) {
  constexpr double kSame = 0.5;  // [s] A simulator's clock in step with this machine's comes within a tick
  for (const std::string& host : facts.uncompared_hosts) {
    out.push_back({Level::kNote, "clocks",
                   host + " has sent no message of health, so its clock was not compared with this machine's",
                   "chronyc tracking on both machines"});
  }
  if (!facts.run_clock_ahead_s) {
    out.push_back({Level::kOk, "clocks", "nobody publishes a clock: stamps are by the machines' own clocks"});
  } else if (std::abs(*facts.run_clock_ahead_s) > kSame) {
    out.push_back({Level::kOk, "clocks",
                   "the run has simulated time: its stamps do not compare with any machine's clock; for "
                   "ROS 2 tools use_sim_time"});
  } else {
    out.push_back({Level::kOk, "clocks", "the run publishes a clock, which is this machine's time"});
  }
}

void CheckNames(const Facts& facts, Findings& out) {
  for (const WireNameFacts& name : facts.misnamed) {
    out.push_back(
        {Level::kProblem, "topic names",
         fmt::format("{} {} {} on the wire, which nobody {}: the topic is {} there", name.participant,
                     name.writes ? "publishes" : "subscribes", name.topic,
                     name.writes ? "hears" : "publishes", name.meant),
         fmt::format("use {} where plain DDS names a topic; ROS 2 and thalweg add the prefix", name.meant)});
  }
}

void CheckDisk(const Facts& facts, Findings& out) {
  constexpr std::uint64_t kNeeded = 100'000'000;         // a run without a recording
  constexpr std::uint64_t kComfortable = 5'000'000'000;  // ten minutes of a recording with images
  if (!facts.out_available) {
    out.push_back({Level::kProblem, "disk", facts.out_folder + " cannot be reached", "choose another --out"});
    return;
  }
  Finding finding{Level::kOk, "disk",
                  fmt::format("{:.1f} GB free in {}", 1e-9 * static_cast<double>(*facts.out_available),
                              facts.out_folder)};
  if (*facts.out_available < kComfortable) {
    finding.level = *facts.out_available < kNeeded ? Level::kProblem : Level::kNote;
    finding.text += ": a recording with images takes about 0.5 GB a minute";
    finding.advice = "df -h " + facts.out_folder;
  }
  out.push_back(finding);
}

}  // namespace

std::string_view NameOf(Level level) {
  switch (level) {
    case Level::kNote:
      return "note";
    case Level::kProblem:
      return "problem";
    default:
      return "ok";
  }
}

std::vector<Finding> Diagnose(const Facts& facts) {
  Findings findings;
  CheckVersions(facts, findings);
  CheckDomain(facts, findings);
  CheckDiscoveryServer(facts, findings);
  CheckQos(facts, findings);
  CheckNames(facts, findings);
  CheckClocks(facts, findings);
  CheckRunClock(facts, findings);
  CheckInterfaces(facts, findings);
  CheckSocketBuffers(facts.kernel, findings);
  CheckFragments(facts, findings);
  CheckSharedMemory(facts.shared_memory, findings);
  CheckDisk(facts, findings);
  return findings;
}

}  // namespace thalweg::inspector
