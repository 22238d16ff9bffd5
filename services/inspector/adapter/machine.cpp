#include "services/inspector/adapter/machine.h"

#include <arpa/inet.h>
#include <poll.h>
#include <pwd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <system_error>

#include "common/base/text.h"
#include "common/dds/network_interfaces.h"
#include "common/dds/rtps_ports.h"
#include "common/dds/shared_memory_files.h"

namespace thalweg::inspector {
namespace {

namespace fs = std::filesystem;

using dds::kFirstPort;
using dds::kPortsOfDomain;
constexpr int kLastDomain = 232;

std::string UserName(uid_t id) {
  std::array<char, 4096> buffer{};
  passwd entry{};
  passwd* found = nullptr;
  getpwuid_r(id, &entry, buffer.data(), buffer.size(), &found);
  return found != nullptr ? found->pw_name : "user " + std::to_string(id);
}

/// A UDP socket whose port belongs to a DDS domain.
struct DomainSocket {
  int domain = 0;
  bool hears_discovery = false;  ///< Else the port is one of a participant's own.
};

/// By the sockets' inodes.
std::map<std::string, DomainSocket> DomainSockets(const fs::path& proc) {
  constexpr int kFirstOwnPort = 10;  // in the ports of a domain, from that of discovery on
  std::map<std::string, DomainSocket> sockets;
  std::ifstream table(proc / "net" / "udp");
  std::string line;
  std::getline(table, line);  // names of the columns
  while (std::getline(table, line)) {
    std::istringstream columns(line);
    std::array<std::string, 10> column;  // the second is the local address, the tenth the inode
    for (std::string& text : column) columns >> text;
    const std::size_t colon = column[1].find(':');
    int port = 0;
    if (!columns || colon == std::string::npos) continue;
    std::from_chars(column[1].data() + colon + 1, column[1].data() + column[1].size(), port, 16);
    const int domain = (port - kFirstPort) / kPortsOfDomain;
    const int offset = (port - kFirstPort) % kPortsOfDomain;
    if (port < kFirstPort || domain > kLastDomain || (offset > 0 && offset < kFirstOwnPort)) continue;
    sockets[column[9]] = {domain, offset == 0};
  }
  return sockets;
}

/// The domains of which a process holds both the port of discovery and one of its own: other programs, too,
/// are given ports in the range of a domain by chance.
class DomainsHeld {
 public:
  void Add(const DomainSocket& socket) { (socket.hears_discovery ? hearing_ : own_).insert(socket.domain); }
  std::set<int> domains() const {
    std::set<int> both;
    std::ranges::set_intersection(hearing_, own_, std::inserter(both, both.end()));
    return both;
  }

 private:
  std::set<int> hearing_, own_;
};

/// "thalweg-mapper (1234)"
std::string ProcessName(const fs::path& folder) {
  std::ifstream file(folder / "cmdline");
  std::string program;
  std::getline(file, program, '\0');
  return CleanText(fs::path(program).filename().string()) + " (" + folder.filename().string() + ')';
}

bool IsNumberName(const std::string& name) {
  return !name.empty() && name.find_first_not_of("0123456789") == std::string::npos;
}

/// Whether a datagram to a group of multicast comes back by the interface with this address.
std::optional<bool> HearsOwnMulticast(const std::string& address) {
  const int in = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int out = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  std::optional<bool> heard;
  ip_mreq membership{};
  inet_pton(AF_INET, "239.255.0.1", &membership.imr_multiaddr);  // the group of DDS discovery
  inet_pton(AF_INET, address.c_str(), &membership.imr_interface);
  sockaddr_in place{};
  place.sin_family = AF_INET;
  socklen_t size = sizeof place;
  auto* const any = reinterpret_cast<sockaddr*>(&place);
  constexpr unsigned char kThisMachineOnly = 0;
  const bool ready =
      in >= 0 && out >= 0 && bind(in, any, sizeof place) == 0 && getsockname(in, any, &size) == 0 &&
      setsockopt(in, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) == 0 &&
      setsockopt(out, IPPROTO_IP, IP_MULTICAST_IF, &membership.imr_interface, sizeof(in_addr)) == 0 &&
      setsockopt(out, IPPROTO_IP, IP_MULTICAST_TTL, &kThisMachineOnly, sizeof kThisMachineOnly) == 0;
  if (ready) {
    constexpr char kText = 'x';
    constexpr int kPatienceMs = 500;
    place.sin_addr = membership.imr_multiaddr;
    pollfd waiting{.fd = in, .events = POLLIN, .revents = 0};
    heard = sendto(out, &kText, 1, 0, any, sizeof place) == 1 && poll(&waiting, 1, kPatienceMs) == 1;
  }
  if (in >= 0) close(in);
  if (out >= 0) close(out);
  return heard;
}

}  // namespace

std::string OwnUser() {
  return UserName(geteuid());
}

std::string OwnHost() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::optional<std::uint64_t> NumberInFile(const fs::path& file) {
  std::ifstream in(file);
  std::uint64_t number = 0;
  if (!(in >> number)) return std::nullopt;
  return number;
}

std::vector<DomainFacts> DomainsInUse(const fs::path& proc) {
  const std::map<std::string, DomainSocket> sockets = DomainSockets(proc);
  std::map<int, std::set<std::string>> processes;
  std::set<std::string> shown;  // inodes
  std::error_code error;
  for (const auto& process : fs::directory_iterator(proc, error)) {
    if (!IsNumberName(process.path().filename().string())) continue;
    const bool is_own = process.path().filename() == std::to_string(getpid());
    DomainsHeld held;
    std::error_code not_ours;  // processes of other users do not show their files
    for (const auto& file : fs::directory_iterator(process.path() / "fd", not_ours)) {
      const std::string target = fs::read_symlink(file.path(), not_ours).string();
      if (!target.starts_with("socket:[") || !target.ends_with(']')) continue;
      const std::string inode = target.substr(8, target.size() - 9);
      const auto socket = sockets.find(inode);
      if (socket == sockets.end()) continue;
      shown.insert(inode);
      held.Add(socket->second);
    }
    if (is_own) continue;
    for (const int domain : held.domains()) processes[domain].insert(ProcessName(process.path()));
  }
  DomainsHeld by_others;
  for (const auto& [inode, socket] : sockets) {
    if (!shown.contains(inode)) by_others.Add(socket);
  }
  for (const int domain : by_others.domains()) processes[domain];  // of somebody who is not shown
  std::vector<DomainFacts> facts;
  for (const auto& [domain, names] : processes) facts.push_back({domain, {names.begin(), names.end()}});
  return facts;
}

SharedMemoryFacts ReadSharedMemory(const fs::path& folder) {
  SharedMemoryFacts facts;
  facts.user = UserName(geteuid());
  struct stat status {};
  facts.is_there = stat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode);
  if (!facts.is_there) return facts;
  facts.owner = UserName(status.st_uid);
  facts.is_writable = access(folder.c_str(), W_OK | X_OK) == 0;
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  if (!error) {
    facts.size = space.capacity;
    facts.available = space.available;
  }
  for (const fs::path& file : dds::StaleFiles(folder)) {
    ++facts.stale_files;
    struct stat stale {};
    constexpr std::uint64_t kBlock = 512;  // of which stat counts; a segment is a file with holes
    if (stat(file.c_str(), &stale) == 0)
      facts.stale_bytes += kBlock * static_cast<std::uint64_t>(stale.st_blocks);
  }
  std::set<std::string> others;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    struct stat file {};
    if (!entry.path().filename().string().starts_with("fastrtps_")) continue;
    if (stat(entry.path().c_str(), &file) == 0 && file.st_uid != geteuid())
      others.insert(UserName(file.st_uid));
  }
  facts.other_owners.assign(others.begin(), others.end());
  return facts;
}

std::vector<InterfaceFacts> ReadInterfaces() {
  std::vector<InterfaceFacts> facts;
  for (const dds::InterfaceAddress& interface : dds::InterfaceAddresses()) {
    InterfaceFacts& one = facts.emplace_back(InterfaceFacts{.name = interface.interface,
                                                            .address = interface.address,
                                                            .is_loopback = interface.is_loopback,
                                                            .has_multicast = interface.has_multicast,
                                                            .hears_own_multicast = std::nullopt});
    if (one.has_multicast && !one.is_loopback) one.hears_own_multicast = HearsOwnMulticast(one.address);
  }
  return facts;
}

std::optional<std::uint64_t> FreeBytes(fs::path folder) {
  std::error_code error;
  folder = fs::absolute(folder, error);
  while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
  const fs::space_info space = fs::space(folder, error);
  if (error) return std::nullopt;
  return space.available;
}

}  // namespace thalweg::inspector
