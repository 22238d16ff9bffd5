#pragma once

#include <filesystem>
#include <string>

#include "services/mapper/core/octomap_file.h"

namespace thalweg::mapper {

/// A map and what kind of file it came from.
struct LoadedMap {
  ColoredMap map;
  std::string format;  ///< For people: "OctoMap, log-odds (.ot)".
};

/// Loads a map of OctoMap's (.ot, .bt) or a mapper's checkpoint with the journal beside it, by what the file
/// holds, whatever it is called. Throws std::runtime_error naming the file and what is wrong with it.
LoadedMap LoadMap(const std::filesystem::path& file);

/// Throws std::runtime_error if SaveMapAs does not know the file's extension.
void CheckMapExtension(const std::filesystem::path& file);

/// Writes a map in the format of the file's extension: .ot (OctoMap, log-odds), .bt (OctoMap, free or
/// occupied), .ply (occupied voxels as cubes) or .map (checkpoint, without a journal: a mapper goes on with
/// it as with a new map). Throws std::runtime_error naming the file and the reason.
void SaveMapAs(const ColoredMap& map, const std::filesystem::path& file);

}  // namespace thalweg::mapper
