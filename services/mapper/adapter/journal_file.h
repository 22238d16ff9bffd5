#pragma once

#include <cstdint>
#include <filesystem>

#include "common/base/bytes.h"
#include "common/files/descriptor.h"
#include "services/mapper/adapter/checkpoint.h"
#include "services/mapper/core/map_journal.h"

namespace thalweg::mapper {

/// A journal on disk, to which whole records are appended. All functions throw std::runtime_error
/// "FILE: cannot be written: REASON".
///
/// Threading: one caller at a time, except that Sync may run beside Append.
class JournalFile {
 public:
  /// Begins a journal in FILE.unfinished; it becomes FILE by Publish, and is removed if that never happens.
  JournalFile(std::filesystem::path file, const JournalHead& head);
  /// Goes on with an existing one and cuts off what lies behind its whole records.
  JournalFile(std::filesystem::path file, JournalEnds ends);
  ~JournalFile();
  JournalFile(JournalFile&& other) noexcept;
  JournalFile& operator=(JournalFile&& other) noexcept;

  const JournalEnds& ends() const { return ends_; }
  std::uint64_t size() const { return ends_.offsets.back(); }  ///< [bytes]

  /// Appends the record of scan ends().last_number() + 1, whole or not at all. A record handed over survives
  /// the process, but a power cut only after Sync.
  void Append(Bytes record);
  /// Appends those records of another journal up to `until` that follow upon this one's, if there are any.
  void AppendFrom(const JournalFile& other, const JournalEnds& until);
  void Sync() const;
  /// Puts this journal in the place of the one before.
  void Publish();
  /// Whether FILE still leads to this journal, which somebody may have removed.
  bool IsInPlace() const;

 private:
  std::filesystem::path file_;
  bool published_;
  Descriptor descriptor_;
  JournalEnds ends_;
  bool torn_ = false;  ///< Whether part of a record is left at the end and could not be cut off.
};

}  // namespace thalweg::mapper
