#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "services/explorer/core/saved_exploration.h"

namespace thalweg::explorer {

/// In the explorer's folder while it runs; it stays there only if the process was killed.
inline constexpr auto kExplorationFile = "exploration.json";

inline constexpr std::size_t kLongestPlace = 200;  ///< [characters] of SavedExploration::place

/// Where an exploration is kept, so that the process that follows a killed one continues it.
struct ExplorationFile {
  std::filesystem::path path{};  ///< Empty: it is not kept.
  std::string place{};           ///< See SavedExploration.
};

/// A saved exploration as JSON: lengths in meters, points as [x, y, z] in the map frame.
std::string EncodeExploration(const SavedExploration& saved);

/// Error: not what EncodeExploration wrote, naming the field; a number that is not finite; too many points.
Result<SavedExploration> DecodeExploration(std::string_view text);

/// Reads a file. Error: as DecodeExploration, or the file cannot be read; begins with the file's name.
Result<SavedExploration> LoadExploration(const std::filesystem::path& file);

}  // namespace thalweg::explorer
