#pragma once

#include <filesystem>

#include "common/base/bytes.h"

namespace thalweg::recorder {

/// A file's bytes in memory, read when they are used. The file may grow meanwhile, but must not be cut.
class MappedFile {
 public:
  /// Throws std::runtime_error "FILE: cannot be read: REASON".
  explicit MappedFile(const std::filesystem::path& file);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  Bytes bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

}  // namespace thalweg::recorder
