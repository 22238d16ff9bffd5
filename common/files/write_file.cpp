#include "common/files/write_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

namespace thalweg {
namespace {

namespace fs = std::filesystem;

/// An open file that is closed in any case.
class Descriptor {
 public:
  Descriptor(const fs::path& file, int flags) : fd_(open(file.c_str(), flags | O_CLOEXEC, 0644)) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

/// False, with errno set, when not all bytes could be written.
bool WriteAll(const Descriptor& descriptor, std::string_view bytes) {
  if (descriptor.get() < 0) return false;
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

void MakeFolder(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw CannotWrite(file, error.value());
}

fs::path FolderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

}  // namespace

std::runtime_error CannotWrite(const fs::path& file, int error) {
  return std::runtime_error(file.string() + ": cannot be written" +
                            (error == 0 ? std::string() : std::string(": ") + std::strerror(error)));
}

void WriteFile(const fs::path& file, std::string_view bytes) {
  std::error_code unknown;
  const fs::file_status status = fs::status(file, unknown);
  if (fs::is_directory(status)) throw CannotWrite(file, EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    if (!WriteAll(Descriptor(file, O_WRONLY), bytes)) throw CannotWrite(file, errno);
    return;
  }
  const fs::path folder = FolderOf(file);
  MakeFolder(folder, file);
  fs::path unfinished = file;
  unfinished += ".unfinished";
  {
    const Descriptor descriptor(unfinished, O_WRONLY | O_CREAT | O_TRUNC);
    if (!WriteAll(descriptor, bytes) || fsync(descriptor.get()) != 0) throw CannotWrite(file, errno);
  }
  if (std::rename(unfinished.c_str(), file.c_str()) != 0) throw CannotWrite(file, errno);
  const Descriptor directory(folder, O_RDONLY | O_DIRECTORY);
  if (directory.get() < 0 || fsync(directory.get()) != 0) throw CannotWrite(file, errno);
}

void CheckWritable(const fs::path& file) {
  const bool existed = fs::exists(file);
  MakeFolder(FolderOf(file), file);
  if (Descriptor(file, O_WRONLY | O_CREAT | O_APPEND).get() < 0) throw CannotWrite(file, errno);
  if (!existed) fs::remove(file);
}

}  // namespace thalweg
