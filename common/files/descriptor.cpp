#include "common/files/descriptor.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>

namespace thalweg {

Descriptor::Descriptor(const std::filesystem::path& file, int flags)
    : fd_(open(file.c_str(), flags | O_CLOEXEC, 0644)), error_(fd_ < 0 ? errno : 0) {}

Descriptor::~Descriptor() {
  if (fd_ >= 0) close(fd_);
}

int WriteAll(const Descriptor& descriptor, std::string_view bytes) {
  if (descriptor.get() < 0) return descriptor.error();
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

int SyncFolder(const std::filesystem::path& folder) {
  const Descriptor directory(folder, O_RDONLY | O_DIRECTORY);
  if (directory.get() < 0) return directory.error();
  return fsync(directory.get()) == 0 ? 0 : errno;
}

}  // namespace thalweg
