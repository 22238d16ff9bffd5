#include "common/dds/shared_memory_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <random>
#include <regex>
#include <string>
#include <system_error>
#include <vector>

namespace thalweg::dds {
namespace {

namespace fs = std::filesystem;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""h;

// Of the RTPS standard, section 9.6.2: 7400 + 250 domain + 10 + 2 id for discovery, and the next one for
// data.
constexpr int kFirstPort = 7410;
constexpr int kPortsOfDomain = 250;
constexpr int kLastIdOfDomain = 119;
constexpr int kLastPort = 65535;

bool IsOlderThan(const fs::path& file, std::chrono::seconds age) {
  std::error_code error;
  const auto written = fs::last_write_time(file, error);
  return !error && fs::file_time_type::clock::now() - written >= age;
}

/// Whether a process holds this lock, or may.
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

std::string PortName(int port) {
  return "fastrtps_port" + std::to_string(port);
}

bool IsLeftBehind(const fs::path& folder, int port) {
  const std::string name = PortName(port);
  return fs::exists(folder / name) || fs::exists(folder / (name + "_el")) ||
         fs::exists(folder / ("sem." + name + "_mutex"));
}

}  // namespace

int RemoveStaleFiles(const fs::path& folder) {
  static const std::regex kSegmentLock("(fastrtps_[0-9a-f]{16})_el");
  static const std::regex kPort("fastrtps_port[0-9]+");
  std::error_code error;
  std::vector<fs::path> stale;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    std::smatch parts;
    if (std::regex_match(name, parts, kSegmentLock)) {
      if (IsOlderThan(entry.path(), 10s) && !IsLocked(entry.path())) stale.push_back(folder / parts[1].str());
    } else if (std::regex_match(name, kPort)) {
      if (IsOlderThan(entry.path(), 24h) && !IsLocked(LockOf(entry.path()))) stale.push_back(entry.path());
    }
  }
  int removed = 0;
  for (const fs::path& file : stale) {
    if (fs::remove(file, error)) ++removed;
    fs::remove(LockOf(file), error);
    fs::remove(folder / ("sem." + file.filename().string() + "_mutex"), error);
  }
  return removed;
}

int FreshParticipantId(int domain, const fs::path& folder) {
  const int first_port = kFirstPort + kPortsOfDomain * domain;
  std::vector<int> fresh;
  for (int id = 0; id <= std::min(kLastIdOfDomain, (kLastPort - 1 - first_port) / 2); ++id) {
    const int port = first_port + 2 * id;
    if (!IsLeftBehind(folder, port) && !IsLeftBehind(folder, port + 1)) fresh.push_back(id);
  }
  if (fresh.empty()) return -1;
  std::random_device random;
  return fresh[std::uniform_int_distribution<std::size_t>(0, fresh.size() - 1)(random)];
}

}  // namespace thalweg::dds
