#include "services/recorder/adapter/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

namespace thalweg::recorder {

MappedFile::MappedFile(const std::filesystem::path& file) {
  const auto fail = [&](int error) {
    throw std::runtime_error(file.string() + ": cannot be read: " + std::strerror(error));
  };
  // Without O_NONBLOCK a named pipe would wait for somebody to write to it.
  const int fd = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) fail(errno);
  struct stat status {};
  int error = fstat(fd, &status) == 0 ? 0 : errno;
  if (error == 0 && S_ISDIR(status.st_mode)) error = EISDIR;
  if (error == 0 && !S_ISREG(status.st_mode)) {
    close(fd);
    throw std::runtime_error(file.string() + ": cannot be read: it is not a regular file");
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  if (error == 0 && size > 0) {  // an empty mapping is an error
    void* const address = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
    error = address == MAP_FAILED ? errno : 0;
    if (error == 0) bytes_ = Bytes(static_cast<const std::uint8_t*>(address), size);
  }
  close(fd);
  if (error != 0) fail(error);
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
}

}  // namespace thalweg::recorder
