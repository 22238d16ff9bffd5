#include "services/mapper/adapter/write_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

namespace thalweg::mapper {
namespace {

[[noreturn]] void Fail(const std::filesystem::path& file, const char* what) {
  throw std::runtime_error("cannot " + std::string(what) + ' ' + file.string() + ": " + std::strerror(errno));
}

/// A file descriptor, closed on destruction.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& file, int flags)
      : fd_(open(file.c_str(), flags | O_CLOEXEC, 0644)) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

void WriteAll(const Descriptor& descriptor, const std::filesystem::path& file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) Fail(file, "write");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

void WriteFileAtomically(const std::filesystem::path& file, std::string_view bytes) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  std::filesystem::create_directories(folder);
  std::filesystem::path unfinished = file;
  unfinished += ".unfinished";
  {
    const Descriptor descriptor(unfinished, O_WRONLY | O_CREAT | O_TRUNC);
    if (descriptor.get() < 0) Fail(unfinished, "open");
    WriteAll(descriptor, unfinished, bytes);
    if (fsync(descriptor.get()) != 0) Fail(unfinished, "write");
  }
  std::filesystem::rename(unfinished, file);
  const Descriptor directory(folder, O_RDONLY | O_DIRECTORY);
  if (directory.get() < 0 || fsync(directory.get()) != 0) Fail(folder, "write");
}

}  // namespace thalweg::mapper
