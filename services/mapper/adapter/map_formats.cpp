#include "services/mapper/adapter/map_formats.h"

#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/files/write_file.h"
#include "services/mapper/adapter/checkpoint.h"
#include "services/mapper/adapter/map_files.h"

namespace thalweg::mapper {
namespace {

constexpr auto kOt = ".ot";
constexpr auto kBt = ".bt";
constexpr auto kPly = ".ply";
constexpr auto kCheckpoint = ".map";

std::string ReadWhole(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) throw std::runtime_error(file.string() + ": is a folder");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream bytes;
  if (!stream || (stream.peek() != std::ifstream::traits_type::eof() && !(bytes << stream.rdbuf()))) {
    throw std::runtime_error(file.string() + ": cannot be read");
  }
  return std::move(bytes).str();
}

}  // namespace

LoadedMap LoadMap(const std::filesystem::path& file) {
  const std::string text = ReadWhole(file);
  const Bytes bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  if (IsOctomap(bytes)) {
    Result<ColoredMap> map = DecodeOctomap(bytes, kMostStoredBlocks);
    if (!map) throw std::runtime_error(file.string() + ": " + map.error());
    const bool is_bt = text.starts_with("# Octomap OcTree binary file");
    return {*std::move(map), is_bt ? "OctoMap, free or occupied (.bt)" : "OctoMap, log-odds (.ot)"};
  }
  if (!text.starts_with("THALWEG")) {
    throw std::runtime_error(file.string() + ": is neither a map of OctoMap (.ot, .bt) nor a checkpoint");
  }
  Result<std::optional<StoredMap>> stored = LoadStoredMap(file);
  if (!stored) throw std::runtime_error(stored.error());
  if (!stored->has_value()) throw std::runtime_error(file.string() + ": cannot be read");
  StoredMap& whole = **stored;
  std::string format = "checkpoint";
  if (whole.journal.applied > 0)
    format += " and " + std::to_string(whole.journal.applied) + " scans of its journal";
  if (!whole.journal.problem.empty()) format += "; journal: " + whole.journal.problem;
  return {{std::move(whole.checkpoint.grid), std::move(whole.checkpoint.colors)}, std::move(format)};
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
