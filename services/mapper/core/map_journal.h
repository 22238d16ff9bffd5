#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"

namespace thalweg::mapper {

/// Says of which map something is, and of which state of it.
struct MapPosition {
  std::uint64_t map = 0;     ///< Drawn at random when the map was begun; 0 = not drawn yet.
  std::uint64_t writer = 0;  ///< Drawn at random by the process that fused scan `number`.
  std::uint64_t number = 0;  ///< Scans fused so far, in all processes.

  bool operator==(const MapPosition&) const = default;
};

/// The beginning of a journal: what its scans follow upon.
struct JournalHead {
  double voxel_size = 0.0;  ///< [m]
  MapPosition base;
};

/// One scan of a journal.
struct JournalRecord {
  MapPosition position;  ///< After this scan.
  Bytes content;         ///< Within the journal's bytes.
};

/// A journal is a head and the records of consecutive scans, only ever appended to. Little endian:
///   head: "THALWEGJ", voxel size (f64), map, writer, number (3 x u64), hash of these (u64)
///   record: length of the content (u32), writer, number (2 x u64), hash (u64), content
/// A record's hash covers all of it and the map, so that no other map's record is taken for this one's.
std::vector<std::uint8_t> EncodeHead(const JournalHead& head);
std::vector<std::uint8_t> EncodeRecord(const MapPosition& position, Bytes content);
inline constexpr std::size_t kJournalHeadBytes = 48;
inline constexpr std::size_t kJournalRecordBytes = 28;  ///< What a record has before its content.

/// Reads a journal record by record, up to the first that is torn, corrupt or out of order: nothing behind
/// it is trusted. The bytes may be anybody's and must outlive the reader.
class JournalReader {
 public:
  /// Error: why this is no journal.
  static Result<JournalReader> Open(Bytes journal);

  const JournalHead& head() const { return head_; }
  /// The next record, or nothing at the end of what is whole.
  std::optional<JournalRecord> Next();
  /// Ends of the head and of the records read so far, as offsets.
  std::uint64_t whole_until() const { return whole_until_; }
  /// After the last record: why the rest of the journal was not read; empty = there is none.
  const std::string& problem() const { return problem_; }

 private:
  JournalReader(Bytes journal, const JournalHead& head);
  std::optional<JournalRecord> Stop(std::string problem);

  Bytes journal_;
  JournalHead head_;
  std::uint64_t number_;  ///< The last record's that was read.
  std::uint64_t whole_until_ = kJournalHeadBytes;
  std::string problem_;
};

}  // namespace thalweg::mapper
