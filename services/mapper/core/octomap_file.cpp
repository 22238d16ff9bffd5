#include "services/mapper/core/octomap_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/text.h"
#include "services/mapper/core/header_text.h"

namespace thalweg::mapper {
namespace {

constexpr std::string_view kOt = "# Octomap OcTree file";
constexpr std::string_view kBt = "# Octomap OcTree binary file";
constexpr int kLevels = 16;  ///< Levels of nodes below the root; the lowest are voxels.

struct Head {
  bool is_binary = false;  ///< .bt
  bool has_colors = false;
  double voxel_size = 0.0;  ///< [m]
  bool is_empty = false;
  std::size_t data = 0;  ///< [byte] Where the tree begins.
};

Result<Head> ReadHead(Bytes bytes) {
  std::string_view rest = TextOf(bytes);
  const auto first = TakeLine(rest);
  if (!first || (!first->starts_with(kOt) && !first->starts_with(kBt))) {
    return Error{"is no file of OctoMap: its first line is not \"" + std::string(kOt) + "\""};
  }
  Head head{.is_binary = first->starts_with(kBt)};
  bool has_type = false;
  std::optional<double> size;
  while (const auto line = TakeLine(rest)) {
    if (line->empty() || line->starts_with('#')) continue;
    if (*line == "data") {
      if (!has_type) return Error{"has no line \"id\" before its data"};
      if (head.voxel_size == 0.0) return Error{"has no line \"res\" before its data"};
      head.is_empty = size == 0.0;
      head.data = bytes.size() - rest.size();
      return head;
    }
    const std::size_t space = line->find(' ');
    const std::string_view key = line->substr(0, space);
    const std::string_view value = space == std::string_view::npos ? "" : Trimmed(line->substr(space));
    if (key == "id") {
      has_type = true;
      head.has_colors = value == "ColorOcTree" && !head.is_binary;
      if (value != "OcTree" && value != "ColorOcTree") {
        return Error{"holds a " + CleanText(value) + ", must be an OcTree or a ColorOcTree"};
      }
    } else if (key == "size") {
      size = NumberIn(value);
    } else if (key == "res") {
      const auto edge = NumberIn(value);
      if (!edge || !std::isfinite(*edge) || *edge <= 0.0) {
        return Error{"res is " + CleanText(value) + ", must be a voxel's edge in meters"};
      }
      head.voxel_size = *edge;
    }
  }
  return Error{"ends before its line \"data\""};
}

/// Reads the nodes in the order in which OctoMap writes them: each before its children, depth first.
class Reader {
 public:
  Reader(const Head& head, Bytes data, std::size_t most_blocks)
      : head_(head),
        data_(data.subspan(head.data)),
        whole_(data.size()),
        most_blocks_(most_blocks),
        map_{.grid = OccupancyGrid(head.voxel_size), .colors = {}} {}

  Result<ColoredMap> Read() {
    constexpr VoxelIndex kLowest{-kMaxVoxelIndex - 1, -kMaxVoxelIndex - 1, -kMaxVoxelIndex - 1};
    if (!head_.is_empty) head_.is_binary ? ReadInnerNode(kLowest, kLevels) : ReadNode(kLowest, kLevels);
    if (!problem_.empty()) return Error{problem_};
    return std::move(map_);
  }

 private:
  /// A child's corner of lowest index: bit 0 of its number is x, 1 is y, 2 is z.
  static VoxelIndex CornerOf(const VoxelIndex& parent, int child, int level) {
    const std::int32_t half = 1 << level;
    return {parent.x + ((child & 1) != 0 ? half : 0), parent.y + ((child & 2) != 0 ? half : 0),
            parent.z + ((child & 4) != 0 ? half : 0)};
  }

  bool Fail(const std::string& problem) {
    const std::size_t at = whole_ - data_.rest().size();
    if (problem_.empty()) problem_ = problem + ", at byte " + std::to_string(at);
    return false;
  }

  /// .ot: value, color where the type has one, and which children follow. `level` 0 is a voxel.
  bool ReadNode(const VoxelIndex& corner, int level) {
    const float log_odds = std::bit_cast<float>(data_.U32());
    std::optional<Rgb> color;
    if (head_.has_colors) color = Rgb{data_.U8(), data_.U8(), data_.U8()};
    const unsigned children = data_.U8();
    if (!data_.good()) return Fail("is cut off");
    if (!std::isfinite(log_odds)) return Fail("has a node whose log-odds are no number");
    if (children == 0) return Fill(corner, level, log_odds, color);
    if (level == 0) return Fail("has nodes below its voxels");
    for (int child = 0; child < 8; ++child) {
      if (((children >> child) & 1U) == 0) continue;
      if (!ReadNode(CornerOf(corner, child, level - 1), level - 1)) return false;
    }
    return true;
  }

  /// .bt: two bits for each child: 0 unknown, 1 free, 2 occupied, 3 followed by its own children.
  bool ReadInnerNode(const VoxelIndex& corner, int level) {
    constexpr unsigned kFree = 1;
    constexpr unsigned kOccupied = 2;
    constexpr unsigned kInner = 3;
    if (level == 0) return Fail("has nodes below its voxels");
    const unsigned children = data_.U16();
    if (!data_.good()) return Fail("is cut off");
    const auto kind = [&](int child) { return (children >> (2 * child)) & 3U; };
    for (int child = 0; child < 8; ++child) {
      const float log_odds = kind(child) == kOccupied ? kOccupiedOfBt : kFreeOfBt;
      if (kind(child) != kFree && kind(child) != kOccupied) continue;
      if (!Fill(CornerOf(corner, child, level - 1), level - 1, log_odds, std::nullopt)) return false;
    }
    for (int child = 0; child < 8; ++child) {
      if (kind(child) == kInner && !ReadInnerNode(CornerOf(corner, child, level - 1), level - 1))
        return false;
    }
    return true;
  }

  /// Sets all voxels of a leaf.
  bool Fill(const VoxelIndex& corner, int level, float log_odds, const std::optional<Rgb>& color) {
    const std::int32_t edge = 1 << level;
    const std::size_t edge_blocks = std::size_t{1} << std::max(level - OccupancyGrid::kBlockBits, 0);
    // Leaves do not overlap, so only one within a block may lie in a block that is there already.
    if (edge_blocks > most_blocks_ ||
        edge_blocks * edge_blocks * edge_blocks + map_.grid.block_count() > most_blocks_) {
      return Fail("has more than " + std::to_string(most_blocks_) + " blocks of 8 x 8 x 8 voxels");
    }
    VoxelIndex i{};
    for (i.z = corner.z; i.z < corner.z + edge; ++i.z) {
      for (i.y = corner.y; i.y < corner.y + edge; ++i.y) {
        for (i.x = corner.x; i.x < corner.x + edge; ++i.x) {
          map_.grid.Set(i, log_odds);
          if (color && log_odds >= 0.0F && IsSet(*color)) map_.colors.Add(i, *color);
        }
      }
    }
    return true;
  }

  /// OctoMap keeps white for nodes without a color.
  static bool IsSet(const Rgb& color) { return color.r != 255 || color.g != 255 || color.b != 255; }

  const Head& head_;
  ByteReader data_;
  const std::size_t whole_;  ///< [byte] Size of the file.
  const std::size_t most_blocks_;
  ColoredMap map_;
  std::string problem_;
};

}  // namespace

Result<ColoredMap> DecodeOctomap(Bytes bytes, std::size_t most_blocks) {
  const Result<Head> head = ReadHead(bytes);
  if (!head) return Error{head.error()};
  return Reader(*head, bytes, most_blocks).Read();
}

bool IsOctomap(Bytes bytes) {
  return TextOf(bytes).starts_with(kOt) || TextOf(bytes).starts_with(kBt);
}

}  // namespace thalweg::mapper
