#include "common/dds/shared_memory_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <map>
#include <optional>
#include <random>
#include <regex>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/dds/rtps_ports.h"

namespace thalweg::dds {
namespace {

namespace fs = std::filesystem;
using std::chrono_literals::operator""s;

// The ports of FreshSharedPorts are numbered beyond those of UDP: domain 0 has those from 10'000'000 on,
// domain 1 those from 20'000'000.
constexpr std::uint32_t kSharedPortsOfDomain = 10'000'000;
constexpr std::uint64_t kDomains = 233;
// What is left of them takes at most 52 MB.
constexpr std::uint32_t kPairsOfDomain = 500;
// The owner of a younger file may be about to lock it.
constexpr auto kYoung = 10s;

fs::file_time_type WrittenAt(const fs::path& file) {
  std::error_code error;
  const auto written = fs::last_write_time(file, error);
  return error ? fs::file_time_type::min() : written;
}

bool IsYoung(const fs::path& file) {
  return WrittenAt(file) > fs::file_time_type::clock::now() - kYoung;
}

/// Whether a process holds this lock, or might.
bool IsLocked(const fs::path& lock) {
  const int file = open(lock.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return errno != ENOENT;
  const bool locked = flock(file, LOCK_EX | LOCK_NB) != 0;
  close(file);
  return locked;
}

fs::path LockOf(const fs::path& file) {
  return file.string() + "_el";
}

fs::path MutexOf(const fs::path& port) {
  return port.parent_path() / ("sem." + port.filename().string() + "_mutex");
}

fs::path PortFile(const fs::path& folder, std::uint32_t port) {
  return folder / ("fastrtps_port" + std::to_string(port));
}

std::uint32_t DomainOf(std::uint32_t port) {
  return port > kLastPort ? port / kSharedPortsOfDomain - 1 : (port - kFirstPort) / kPortsOfDomain;
}

struct PortName {
  std::uint32_t number = 0;
  bool is_lock = false;  ///< Whether it is that of the lock of who listens at the port.
};

std::optional<PortName> ParsePortName(const fs::path& file) {
  static const std::regex kPort("(sem\\.)?fastrtps_port([1-9][0-9]{3,9})(_el|_mutex)?");
  const std::string name = file.filename().string();
  std::smatch parts;
  if (!std::regex_match(name, parts, kPort)) return std::nullopt;
  const std::uint64_t number = std::stoull(parts[2].str());
  const bool is_of_udp = number >= kFirstPort && number <= kLastPort;
  const bool is_shared =
      number >= kSharedPortsOfDomain && number < kSharedPortsOfDomain * kDomains + kSharedPortsOfDomain;
  if (!is_of_udp && !is_shared) return std::nullopt;
  return PortName{static_cast<std::uint32_t>(number), parts[3] == "_el"};
}

/// The port files in the folder, by domain, except for domains in which a process still listens.
std::map<std::uint32_t, std::set<fs::path>> DesertedPorts(const fs::path& folder) {
  std::map<std::uint32_t, std::set<fs::path>> ports;
  std::set<std::uint32_t> alive;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const auto name = ParsePortName(entry.path());
    if (!name) continue;
    ports[DomainOf(name->number)].insert(PortFile(folder, name->number));
    if (name->is_lock && IsLocked(entry.path())) alive.insert(DomainOf(name->number));
  }
  for (const std::uint32_t domain : alive) ports.erase(domain);
  return ports;
}

std::vector<fs::path> DesertedSegments(const fs::path& folder) {
  static const std::regex kSegmentLock("(fastrtps_[0-9a-f]{16})_el");
  std::vector<fs::path> segments;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    std::smatch parts;
    if (!std::regex_match(name, parts, kSegmentLock) || IsYoung(entry.path())) continue;
    if (!IsLocked(entry.path())) segments.push_back(folder / parts[1].str());
  }
  return segments;
}

/// What is known about a pair of ports that somebody has or had.
struct Traces {
  bool in_use = false;
  fs::file_time_type last = fs::file_time_type::min();
};

}  // namespace

std::vector<fs::path> StaleFiles(const fs::path& folder) {
  std::vector<fs::path> stale = DesertedSegments(folder);
  for (const auto& [domain, ports] : DesertedPorts(folder)) {
    for (const fs::path& port : ports) {
      if (!IsYoung(port) && !IsYoung(LockOf(port)) && !IsYoung(MutexOf(port))) stale.push_back(port);
    }
  }
  return stale;
}

int RemoveStaleFiles(const fs::path& folder) {
  int removed = 0;
  std::error_code error;
  for (const fs::path& file : StaleFiles(folder)) {
    const bool was_there = fs::remove(file, error);
    const bool had_lock = fs::remove(LockOf(file), error);
    fs::remove(MutexOf(file), error);
    if (was_there || had_lock) ++removed;
  }
  return removed;
}

std::uint32_t FreshSharedPorts(int domain, const fs::path& folder) {
  const std::uint32_t begin = (static_cast<std::uint32_t>(domain) + 1) * kSharedPortsOfDomain;
  std::map<std::uint32_t, Traces> traces;  // by pair
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const auto name = ParsePortName(entry.path());
    if (!name || name->number < begin || name->number >= begin + 2 * kPairsOfDomain) continue;
    Traces& its = traces[(name->number - begin) / 2];
    its.in_use = its.in_use || (name->is_lock && IsLocked(entry.path()));
    its.last = std::max(its.last, WrittenAt(entry.path()));
  }
  std::vector<std::uint32_t> choices;
  for (std::uint32_t pair = 0; pair < kPairsOfDomain; ++pair) {
    if (traces.count(pair) == 0) choices.push_back(pair);
  }
  if (choices.empty()) {
    const auto oldest = std::ranges::min_element(traces, [](const auto& a, const auto& b) {
      return std::pair(a.second.in_use, a.second.last) < std::pair(b.second.in_use, b.second.last);
    });
    choices.push_back(oldest->first);
  }
  std::random_device random;
  return begin + 2 * choices[std::uniform_int_distribution<std::size_t>(0, choices.size() - 1)(random)];
}

}  // namespace thalweg::dds
