#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "services/mapper/core/octomap_file.h"
#include "services/mapper/core/ply_file.h"

namespace thalweg::mapper {

/// A map and what kind of file it came from.
struct LoadedMap {
  ColoredMap map;
  std::string format;  ///< For people: "OctoMap, log-odds (.ot)".
};

/// What a file holds: a map, or a point cloud or mesh (.ply), of which a map can be made once somebody says
/// how large its voxels are.
using MapOrShape = std::variant<LoadedMap, PlyFile>;

/// Loads a map of OctoMap's (.ot, .bt), a mapper's checkpoint with the journal beside it, or a .ply, by what
/// the file holds, whatever it is called. Throws std::runtime_error naming the file and what is wrong with
/// it.
MapOrShape LoadMapOrShape(const std::filesystem::path& file);

/// What was loaded as a map.
/// @param file        From which it was.
/// @param voxel_size  [m] For a point cloud or mesh, which throws without it; a map has its own.
LoadedMap AsMap(MapOrShape loaded, const std::filesystem::path& file, std::optional<double> voxel_size);

/// Both in one.
LoadedMap LoadMap(const std::filesystem::path& file, std::optional<double> voxel_size = std::nullopt);

/// For people: "point cloud (.ply)" or "mesh (.ply)".
std::string FormatOf(const PlyFile& ply);

/// Throws std::runtime_error if SaveMapAs does not know the file's extension.
void CheckMapExtension(const std::filesystem::path& file);

/// Writes a map in the format of the file's extension: .ot (OctoMap, log-odds), .bt (OctoMap, free or
/// occupied), .ply (occupied voxels as cubes) or .map (checkpoint, without a journal: a mapper goes on with
/// it as with a new map). Throws std::runtime_error naming the file and the reason.
void SaveMapAs(const ColoredMap& map, const std::filesystem::path& file);

}  // namespace thalweg::mapper
