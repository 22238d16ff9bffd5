#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/voxel/occupancy_grid.h"
#include "services/mapper/core/map_copy.h"
#include "services/mapper/core/map_journal.h"
#include "services/mapper/core/voxel_colors.h"

namespace thalweg::mapper {

/// Everything a mapper needs to resume where another one stopped: the exact log-odds and the colors, and of
/// which map they are.
struct Checkpoint {
  OccupancyGrid grid;
  VoxelColors colors;
  MapPosition position = {};
};

/// Blocks that a map read from a file may have: 134 million voxels, more than the readers of map updates
/// take. A small file can list blocks that would take up gigabytes.
inline constexpr std::size_t kMostStoredBlocks = 1U << 18U;

/// Encodes a checkpoint in a format of its own rather than as .ot: OctoMap's reader trusts its input, and a
/// checkpoint is read after a crash.
///
/// Layout, little endian: "THALWEG2", number of bytes that follow (u64), their FNV-1a hash (u64); then
/// position (map, writer, number; 3 x u64), voxel size [m] (f64), number of patches (u32), and each with its
/// length (u32), see map_patch.h.
std::string EncodeCheckpoint(const OccupancyGrid& grid, const VoxelColors& colors,
                             const MapPosition& position = {});
/// Also reads "THALWEG1", the uncompressed format of versions up to 0.2, which has no position.
/// Error: whether the bytes are truncated, of another format or corrupt, and where.
Result<Checkpoint> DecodeCheckpoint(std::string_view bytes);

/// Where the whole records of a journal end.
struct JournalEnds {
  std::uint64_t base_number = 0;       ///< The number of the scan before the first record.
  std::vector<std::uint64_t> offsets;  ///< [bytes] First that of the head, then that of each record.

  std::uint64_t last_number() const { return base_number + offsets.size() - 1; }
};

/// What became of a journal.
struct JournalUse {
  std::uint64_t applied = 0;       ///< Scans.
  std::uint64_t unused_bytes = 0;  ///< From the first record that is not whole.
  std::string problem = {};        ///< Why it, or the rest of it, was not used; empty = all of it was.
  /// Where to append; nothing if this journal does not lead up to the map, so that a new one must be begun.
  std::optional<JournalEnds> ends = {};
};

/// Applies the scans of a journal that follow upon `checkpoint`, in order, and skips those that it contains.
/// A journal of another map, or of another course of this one, is not applied.
JournalUse ApplyJournal(Bytes journal, Checkpoint& checkpoint);

/// The journal that lies beside a checkpoint: checkpoint.journal beside checkpoint.map.
std::filesystem::path JournalOf(const std::filesystem::path& checkpoint_file);

struct StoredMap {
  Checkpoint checkpoint;  ///< With the journal's scans.
  JournalUse journal;
};

/// Loads the checkpoint in `file` and the journal beside it, or nothing if there is no checkpoint. Error: as
/// DecodeCheckpoint, preceded by the file's name.
Result<std::optional<StoredMap>> LoadStoredMap(const std::filesystem::path& file);
/// The same for those who do not go on writing it.
Result<std::optional<Checkpoint>> LoadCheckpoint(const std::filesystem::path& file);

}  // namespace thalweg::mapper
