#include "common/dds/stale_segments.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <regex>
#include <string>
#include <system_error>
#include <vector>

namespace thalweg::dds {
namespace {

namespace fs = std::filesystem;

/// Whether no process holds the lock.
bool IsAbandoned(const fs::path& lock) {
  std::error_code error;
  const auto age = fs::file_time_type::clock::now() - fs::last_write_time(lock, error);
  if (error || age < std::chrono::seconds(10)) return false;
  const int file = open(lock.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return false;
  const bool locked = flock(file, LOCK_EX | LOCK_NB) == 0;
  close(file);
  return locked;
}

}  // namespace

int RemoveStaleSegments(const fs::path& folder) {
  static const std::regex kLock("fastrtps_[0-9a-f]{16}_el");  // not the ports, which are small and shared
  std::error_code error;
  std::vector<fs::path> abandoned;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (std::regex_match(entry.path().filename().string(), kLock) && IsAbandoned(entry.path())) {
      abandoned.push_back(entry.path());
    }
  }
  int removed = 0;
  for (const fs::path& lock : abandoned) {
    std::string segment = lock.string();
    segment.resize(segment.size() - 3);
    if (fs::remove(segment, error)) ++removed;
    fs::remove(lock, error);
  }
  return removed;
}

}  // namespace thalweg::dds
