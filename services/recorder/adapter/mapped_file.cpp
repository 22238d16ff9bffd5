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
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(file.string() + ": cannot be read: " + why);
  };
  // Without O_NONBLOCK a named pipe would wait for somebody to write to it.
  const int fd = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) fail(std::strerror(errno));
  struct stat status {};
  int error = fstat(fd, &status) == 0 ? 0 : errno;
  if (error == 0 && S_ISDIR(status.st_mode)) error = EISDIR;
  const bool is_special = error == 0 && !S_ISREG(status.st_mode);  // e.g. a pipe, which has no size
  const auto size = static_cast<std::size_t>(status.st_size);
  if (error == 0 && !is_special && size > 0) {  // an empty mapping is an error
    void* const address = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
    error = address == MAP_FAILED ? errno : 0;
    if (error == 0) bytes_ = Bytes(static_cast<const std::uint8_t*>(address), size);
  }
  close(fd);
  if (is_special) fail("it is not a regular file");
  if (error != 0) fail(std::strerror(error));
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
}

}  // namespace thalweg::recorder
