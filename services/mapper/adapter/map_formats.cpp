#include "services/mapper/adapter/map_formats.h"

#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/files/write_file.h"
#include "services/mapper/adapter/checkpoint.h"
#include "services/mapper/adapter/map_files.h"
#include "services/mapper/core/ply_map.h"

namespace thalweg::mapper {
namespace {

constexpr auto kOt = ".ot";
constexpr auto kBt = ".bt";
constexpr auto kPly = ".ply";
constexpr auto kCheckpoint = ".map";

constexpr auto kNoFreeSpace = ", no free space";

std::string ReadWhole(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) throw std::runtime_error(file.string() + ": is a folder");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream bytes;
  if (!stream || (stream.peek() != std::ifstream::traits_type::eof() && !(bytes << stream.rdbuf()))) {
    throw std::runtime_error(file.string() + ": cannot be read");
  }
  return std::move(bytes).str();
}

/// The value, unless there is none: then throws std::runtime_error naming the file and the reason.
template <class T>
T ValueOf(Result<T> result, const std::filesystem::path& file) {
  if (!result) throw std::runtime_error(file.string() + ": " + result.error());
  return *std::move(result);
}

}  // namespace

MapOrShape LoadMapOrShape(const std::filesystem::path& file) {
  const std::string text = ReadWhole(file);
  const Bytes bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  if (IsOctomap(bytes)) {
    const bool is_bt = text.starts_with("# Octomap OcTree binary file");
    return LoadedMap{ValueOf(DecodeOctomap(bytes, kMostStoredBlocks), file),
                     is_bt ? "OctoMap, free or occupied (.bt)" : "OctoMap, log-odds (.ot)"};
  }
  if (IsPly(bytes)) {
    PlyFile ply = ValueOf(DecodePly(bytes), file);
    if (!ply.map_voxel_size) return ply;
    return LoadedMap{ValueOf(MapOf(ply, *ply.map_voxel_size, kMostStoredBlocks), file),
                     std::string("occupied voxels as cubes (.ply)") + kNoFreeSpace};
  }
  if (!text.starts_with("THALWEG")) {
    throw std::runtime_error(file.string() + ": is no map of OctoMap (.ot, .bt), no checkpoint and no .ply");
  }
  Result<std::optional<StoredMap>> stored = LoadStoredMap(file);
  if (!stored) throw std::runtime_error(stored.error());
  if (!stored->has_value()) throw std::runtime_error(file.string() + ": cannot be read");
  StoredMap& whole = **stored;
  std::string format = "checkpoint";
  if (whole.journal.applied > 0)
    format += " and " + std::to_string(whole.journal.applied) + " scans of its journal";
  if (!whole.journal.problem.empty()) format += "; journal: " + whole.journal.problem;
  return LoadedMap{{std::move(whole.checkpoint.grid), std::move(whole.checkpoint.colors)}, std::move(format)};
}

LoadedMap LoadMap(const std::filesystem::path& file, std::optional<double> voxel_size) {
  return AsMap(LoadMapOrShape(file), file, voxel_size);
}

LoadedMap AsMap(MapOrShape loaded, const std::filesystem::path& file, std::optional<double> voxel_size) {
  if (auto* const map = std::get_if<LoadedMap>(&loaded)) return std::move(*map);
  const PlyFile& ply = std::get<PlyFile>(loaded);
  if (!voxel_size) {
    throw std::runtime_error(file.string() +
                             ": states no voxel size; `thalweg map convert` and `crop` take one with "
                             "--voxel-size");
  }
  return {ValueOf(MapOf(ply, *voxel_size, kMostStoredBlocks), file), FormatOf(ply) + kNoFreeSpace};
}

std::string FormatOf(const PlyFile& ply) {
  return ply.triangles.empty() ? "point cloud (.ply)" : "mesh (.ply)";
}

void CheckMapExtension(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  for (const char* known : {kOt, kBt, kPly, kCheckpoint}) {
    if (extension == known) return;
  }
  throw std::runtime_error(file.string() + ": a map is written as .ot, .bt, .ply or .map");
}

void SaveMapAs(const ColoredMap& map, const std::filesystem::path& file) {
  CheckMapExtension(file);
  const std::string extension = file.extension().string();
  if (extension == kPly) return WriteFile(file, EncodePly(map.grid, map.colors));
  if (extension == kCheckpoint) return WriteFile(file, EncodeCheckpoint(map.grid, map.colors));
  const auto tree = ToOcTree(map.grid);
  WriteFile(file, extension == kOt ? EncodeOt(*tree) : EncodeBt(*tree));
}

}  // namespace thalweg::mapper
