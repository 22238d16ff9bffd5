#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "services/mapper/adapter/checkpoint.h"
#include "services/mapper/adapter/journal_file.h"
#include "services/mapper/core/map_patch.h"

namespace thalweg::mapper {

/// Keeps a map on disk as a checkpoint and a journal of the scans after it, so that a process killed at any
/// moment loses its last scan at most; a power cut, what came after the last Maintain.
///
/// Each scan is coded and appended on a thread of the keeper. When the journal has grown too long,
/// NeedsCheckpoint says so, and WriteCheckpoint replaces the checkpoint and then the journal, each by a
/// rename. Killed between the two, the new checkpoint and the old journal remain: its records carry the
/// scans' numbers, so those that the checkpoint contains are skipped.
///
/// What the disk does not take stays in memory, up to a bound, and is tried again by Maintain; beyond the
/// bound scans are forgotten and a checkpoint is needed, which contains them.
///
/// Threading: Add, position and NeedsCheckpoint on the thread that owns the map, which they do not hold up
/// (Add: at most `patience`, once, while the disk hangs); WriteCheckpoint and Maintain on any thread, for as
/// long as the disk takes.
class MapKeeper {
 public:
  struct Event {
    enum class Kind {
      kStored,     ///< A scan is in the journal.
      kFailed,     ///< An attempt to write failed.
      kRecovered,  ///< All scans are on disk again.
    };
    Kind kind = Kind::kStored;
    std::string text = {};      ///< kFailed: file and reason.
    double milliseconds = 0.0;  ///< kStored: coding and appending.
    std::size_t bytes = 0;      ///< kStored: of the record.
  };
  struct Options {
    std::filesystem::path checkpoint_file;  ///< The journal lies beside it, see JournalOf.
    /// A journal longer than this and than the checkpoint is folded into a new one.
    std::uint64_t most_journal_bytes = 1U << 20U;
    std::size_t most_waiting_bytes = 32U << 20U;  ///< For scans that the disk does not take.
    /// How long Add waits for the scan before, so that no two of them can be lost.
    std::chrono::milliseconds patience{1000};
    std::function<void()> before_append = [] {};  ///< Called before each write: a test's slow disk.
  };

  /// @param voxel_size  [m]
  /// @param at          State of the map: MapPosition{} for a new one.
  /// @param journal     The journal that leads up to it, if there is one; what lies behind is cut off.
  /// @param report      Called on the keeper's threads, and on those that call it.
  /// Removes files that a killed process left unfinished. Throws nothing if the disk fails: that is reported.
  MapKeeper(Options options, double voxel_size, const MapPosition& at, std::optional<JournalEnds> journal,
            std::function<void(const Event&)> report);
  ~MapKeeper();  ///< Appends what waits, if the disk takes it.
  MapKeeper(const MapKeeper&) = delete;
  MapKeeper& operator=(const MapKeeper&) = delete;

  /// State of the map after the last Add; belongs into its checkpoint.
  const MapPosition& position() const { return position_; }
  /// Takes what the next scan has changed.
  void Add(MapPatch patch);
  /// Whether the journal is too long or cannot contain all scans, or the last checkpoint failed; then not
  /// before the next Maintain.
  bool NeedsCheckpoint() const;
  /// Writes a copy of the map, taken at its `position`, and begins a new journal. Throws std::runtime_error
  /// naming file and reason, which is also reported; the files from before stay whole.
  void WriteCheckpoint(const Checkpoint& copy);
  /// Lets everything appended so far survive a power cut, notices files that were removed, and tries again
  /// what failed. To be called from time to time.
  void Maintain();

 private:
  struct Waiting {
    std::uint64_t number = 0;
    MapPatch patch;
    std::size_t bytes = 0;
  };
  struct Record {
    std::uint64_t number = 0;
    std::vector<std::uint8_t> bytes;
    double milliseconds = 0.0;
  };

  void Work(const std::stop_token& stop);
  void Code(const Waiting& waiting);
  void AppendRecords();
  void BeginJournal(const MapPosition& base);
  /// Notes that a scan can no longer come into the journal.
  void Forget(std::uint64_t number, const std::string& why);
  void Fail(const std::string& text);
  void NoteJournal();
  void TryAgain();
  void RecoverIfWhole();

  const Options options_;
  const std::filesystem::path journal_file_;
  const double voxel_size_;
  const std::function<void(const Event&)> report_;
  MapPosition position_;        ///< Changes with mutex_ locked.
  const std::uint64_t map_;     ///< Session of every position.
  const std::uint64_t writer_;  ///< Session of the scans added here.

  std::mutex checkpoint_mutex_;      ///< Held while a checkpoint is written. Locked before the others.
  std::uint64_t checkpoint_number_;  ///< Scans in the newest checkpoint written.
  /// Held while journal_ is appended to or replaced; the latter with checkpoint_mutex_ held as well. Locked
  /// before mutex_.
  std::mutex journal_mutex_;
  std::optional<JournalFile> journal_;

  // Used by the keeper's thread alone.
  std::deque<Record> records_;  ///< Coded, in order, and not yet in the journal.
  std::size_t record_bytes_ = 0;

  mutable std::mutex mutex_;  ///< Guards what follows; never held while the disk works.
  std::condition_variable_any changed_;
  std::deque<Waiting> waiting_;  ///< Scans to be coded.
  std::size_t waiting_bytes_ = 0;
  bool retry_ = false;             ///< Whether to append although that failed.
  bool append_fails_ = false;      ///< Whether the last attempt failed.
  bool checkpoint_fails_ = false;  ///< Likewise.
  bool may_try_checkpoint_ = true;
  bool failing_ = false;         ///< From a report of kFailed to that of kRecovered.
  bool patient_ = true;          ///< Whether Add waits.
  bool has_journal_ = false;     ///< One that is in place.
  std::uint64_t stored_;         ///< Scans up to this number are on disk.
  std::uint64_t forgotten_ = 0;  ///< The last scan that can only come to the disk by a checkpoint.
  std::uint64_t journal_bytes_ = 0;
  std::uint64_t checkpoint_bytes_ = 0;

  std::jthread thread_;  ///< Last, so that it is joined before the members it uses are destroyed.
};

}  // namespace thalweg::mapper
