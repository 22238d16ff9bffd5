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

constexpr int kLastIdOfDomain = 119;
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

fs::path PortFile(const fs::path& folder, int port) {
  return folder / ("fastrtps_port" + std::to_string(port));
}

int DomainOf(int port) {
  return (port - kFirstPort) / kPortsOfDomain;
}

/// The port files in the folder, by domain, except for domains in which a process still listens.
std::map<int, std::set<fs::path>> DesertedPorts(const fs::path& folder) {
  static const std::regex kPort("fastrtps_port([0-9]{4,5})(_el)?");
  std::map<int, std::set<fs::path>> ports;
  std::set<int> alive;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    std::smatch parts;
    if (!std::regex_match(name, parts, kPort)) continue;
    const int port = std::stoi(parts[1].str());
    ports[DomainOf(port)].insert(PortFile(folder, port));
    if (parts[2].matched && IsLocked(entry.path())) alive.insert(DomainOf(port));
  }
  for (const int domain : alive) ports.erase(domain);
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

/// What is known about one participant ID.
struct Traces {
  bool any = false;
  bool in_use = false;
  fs::file_time_type last = fs::file_time_type::min();
};

Traces TracesOf(const fs::path& folder, int first_port) {
  Traces traces;
  for (const int number : {first_port, first_port + 1}) {
    const fs::path port = PortFile(folder, number);
    for (const fs::path& file : {port, LockOf(port), MutexOf(port)}) {
      if (!fs::exists(file)) continue;
      traces.any = true;
      traces.last = std::max(traces.last, WrittenAt(file));
    }
    traces.in_use = traces.in_use || IsLocked(LockOf(port));
  }
  return traces;
}

}  // namespace

std::vector<fs::path> StaleFiles(const fs::path& folder) {
  std::vector<fs::path> stale = DesertedSegments(folder);
  for (const auto& [domain, ports] : DesertedPorts(folder)) {
    for (const fs::path& port : ports) {
      if (!IsYoung(port) && !IsYoung(LockOf(port))) stale.push_back(port);
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

int FreshParticipantId(int domain, const fs::path& folder) {
  const int first_port = FirstPortOf(domain, 0);
  std::vector<int> fresh;
  std::optional<std::pair<fs::file_time_type, int>> oldest;
  for (int id = 0; id <= std::min(kLastIdOfDomain, (kLastPort - 1 - first_port) / 2); ++id) {
    const Traces traces = TracesOf(folder, FirstPortOf(domain, id));
    if (!traces.any) fresh.push_back(id);
    if (traces.in_use) continue;
    if (!oldest || traces.last < oldest->first) oldest = {traces.last, id};
  }
  if (fresh.empty()) return oldest ? oldest->second : -1;
  std::random_device random;
  return fresh[std::uniform_int_distribution<std::size_t>(0, fresh.size() - 1)(random)];
}

}  // namespace thalweg::dds
