#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace thalweg {

/// Writes the whole file or nothing, even if the process dies meanwhile: the bytes go to a temporary file
/// beside it, are synced to disk, and the file is then renamed. Creates the folder if needed. A link, or an
/// existing file that is not regular, such as a pipe or /dev/stdout, is written in place. Throws
/// std::runtime_error "FILE: cannot be written: REASON".
void WriteFile(const std::filesystem::path& file, std::string_view bytes);

/// Where WriteFile collects a file's bytes until it is complete.
std::filesystem::path UnfinishedOf(const std::filesystem::path& file);

/// The error that WriteFile throws, for code that writes files in another way.
/// @param error  An errno; 0 = unknown.
std::runtime_error CannotWrite(const std::filesystem::path& file, int error);

/// Throws that error if WriteFile could not write the file, without changing it. For checking before hours of
/// work rather than after.
void CheckWritable(const std::filesystem::path& file);
/// The same for each of several files; skips empty names.
void CheckWritable(const std::vector<std::filesystem::path>& files);

/// Throws std::runtime_error "FOLDER: cannot be written: REASON" unless files can be created in the folder,
/// which is created if needed.
void CheckFolderWritable(const std::filesystem::path& folder);

/// Renames a file that cannot be used to FILE.unused, so that it is not written over, if possible. Returns
/// what became of it, for people: "it is now ...".
std::string SetAside(const std::filesystem::path& file);

/// Writes several files, each of them even if another one cannot be written: on a full disk, a small one may
/// still fit.
class SeparateWrites {
 public:
  /// Calls `write`, which may throw std::exception.
  template <class Write>
  void Try(Write&& write) {
    try {
      write();
    } catch (const std::exception& error) {
      errors_.emplace_back(error.what());
    }
  }
  const std::vector<std::string>& errors() const { return errors_; }
  /// Throws std::runtime_error with all errors, separated by "; ", if there are any.
  void ThrowErrors() const;

 private:
  std::vector<std::string> errors_;
};

}  // namespace thalweg
