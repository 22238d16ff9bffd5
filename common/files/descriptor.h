#pragma once

#include <filesystem>
#include <string_view>
#include <utility>

namespace thalweg {

/// A file descriptor, closed on destruction.
class Descriptor {
 public:
  /// @param flags  As of open(2); O_CLOEXEC is added, and a new file is readable by all.
  Descriptor(const std::filesystem::path& file, int flags);
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)), error_(other.error_) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    std::swap(error_, other.error_);
    return *this;
  }
  int get() const { return fd_; }
  int error() const { return error_; }  ///< Errno of opening the file; 0 = none.

 private:
  int fd_;
  int error_;
};

/// Writes at the file's position. @return An errno; 0 if all bytes were written.
int WriteAll(const Descriptor& descriptor, std::string_view bytes);
/// Lets what was created, renamed or removed in a folder survive a power cut. @return An errno, or 0.
int SyncFolder(const std::filesystem::path& folder);

}  // namespace thalweg
