#include "common/files/write_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "common/files/descriptor.h"

namespace thalweg {
namespace {

namespace fs = std::filesystem;

/// Writes a new file, whose bytes have been synced to disk on return. @return An errno, or 0.
int WriteToDisk(const fs::path& file, std::string_view bytes) {
  const Descriptor descriptor(file, O_WRONLY | O_CREAT | O_TRUNC);
  if (const int error = WriteAll(descriptor, bytes)) return error;
  return fsync(descriptor.get()) == 0 ? 0 : errno;
}

/// Whether to write in place: a link must keep its target, and a file that is not regular, such as a pipe or
/// /dev/null, cannot be replaced.
bool IsWrittenInPlace(const fs::path& file) {
  std::error_code unknown;
  const fs::file_status status = fs::symlink_status(file, unknown);
  return fs::exists(status) && !fs::is_regular_file(status);
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

fs::path UnfinishedOf(const fs::path& file) {
  fs::path unfinished = file;
  unfinished += ".unfinished";
  return unfinished;
}

std::runtime_error CannotWrite(const fs::path& file, int error) {
  return std::runtime_error(file.string() + ": cannot be written" +
                            (error == 0 ? std::string() : std::string(": ") + std::strerror(error)));
}

void WriteFile(const fs::path& file, std::string_view bytes) {
  std::error_code unknown;
  if (fs::is_directory(file, unknown)) throw CannotWrite(file, EISDIR);
  if (IsWrittenInPlace(file)) {
    const Descriptor descriptor(file, O_WRONLY | O_CREAT | O_TRUNC);
    if (const int error = WriteAll(descriptor, bytes)) throw CannotWrite(file, error);
    return;
  }
  const fs::path folder = FolderOf(file);
  MakeFolder(folder, file);
  const fs::path unfinished = UnfinishedOf(file);
  if (const int error = WriteToDisk(unfinished, bytes)) {
    unlink(unfinished.c_str());
    throw CannotWrite(file, error);
  }
  if (std::rename(unfinished.c_str(), file.c_str()) != 0) {
    const int error = errno;
    unlink(unfinished.c_str());
    throw CannotWrite(file, error);
  }
  if (const int error = SyncFolder(folder)) throw CannotWrite(file, error);
}

void CheckWritable(const fs::path& file) {
  std::error_code unknown;
  if (fs::is_directory(file, unknown)) throw CannotWrite(file, EISDIR);
  if (IsWrittenInPlace(file)) {
    if (access(file.c_str(), W_OK) != 0 && errno != ENOENT) throw CannotWrite(file, errno);
    return;
  }
  MakeFolder(FolderOf(file), file);
  const fs::path unfinished = UnfinishedOf(file);
  const int error = WriteToDisk(unfinished, "");
  unlink(unfinished.c_str());
  if (error != 0) throw CannotWrite(file, error);
}

void CheckWritable(const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    if (!file.empty()) CheckWritable(file);
  }
}

void CheckFolderWritable(const fs::path& folder) {
  MakeFolder(folder, folder);
  const fs::path probe = UnfinishedOf(folder / "probe");
  const int error = WriteToDisk(probe, "");
  unlink(probe.c_str());
  if (error != 0) throw CannotWrite(folder, error);
}

std::string SetAside(const std::filesystem::path& file) {
  std::filesystem::path aside = file;
  aside += ".unused";
  std::error_code error;
  std::filesystem::rename(file, aside, error);
  return error ? "it will be written over" : "it is now " + aside.string();
}

void SeparateWrites::ThrowErrors() const {
  if (errors_.empty()) return;
  std::string text;
  for (const std::string& error : errors_) text += (text.empty() ? "" : "; ") + error;
  throw std::runtime_error(text);
}

}  // namespace thalweg
