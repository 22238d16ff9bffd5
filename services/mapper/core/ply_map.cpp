#include "services/mapper/core/ply_map.h"

#include <algorithm>
#include <string>
#include <utility>

#include "common/base/text.h"
#include "common/geometry/triangle.h"
#include "common/voxel/dense_grid.h"

namespace thalweg::mapper {
namespace {

/// Boxes that may be looked at for each block that the map may have: a billion for the largest map, which takes
/// minutes.
constexpr std::uint64_t kCutsPerBlock = 8 * OccupancyGrid::kBlockVoxels;

class PlyVoxels {
 public:
  PlyVoxels(const PlyFile& file, double voxel_size, std::size_t most_blocks)
      : file_(file), most_blocks_(most_blocks), map_{.grid = OccupancyGrid(voxel_size), .colors = {}} {}

  Result<ColoredMap> Read() {
    if (!(file_.map_voxel_size ? ReadCubes() : ReadSurfaces())) return Error{problem_};
    return std::move(map_);
  }

 private:
  using Corners = std::array<std::uint32_t, 3>;

  Triangle TriangleOf(const Corners& corners) const {
    return {file_.points[corners[0]], file_.points[corners[1]], file_.points[corners[2]]};
  }

  std::optional<Rgb> ColorOf(std::size_t point) const {
    return file_.colors.empty() ? std::nullopt : std::optional(file_.colors[point]);
  }

  /// The voxel behind the middle of each triangle, which lies on a side of it and looks outward.
  bool ReadCubes() {
    std::vector<bool> is_corner(file_.points.size(), false);
    for (const Corners& corners : file_.triangles) {
      const auto& [a, b, c] = TriangleOf(corners);
      const Eigen::Vector3d outward = (b - a).cross(c - a).normalized();
      const Eigen::Vector3d within = (a + b + c) / 3.0 - 0.5 * map_.grid.voxel_size() * outward;
      if (!ReadVoxel(within, corners[0])) return false;
      for (const std::uint32_t corner : corners) is_corner[corner] = true;
    }
    for (std::size_t k = 0; k < file_.points.size(); ++k) {
      if (!is_corner[k] && !ReadVoxel(file_.points[k], k)) return false;
    }
    return true;
  }

  bool ReadVoxel(const Eigen::Vector3d& p_W, std::size_t point) {
    std::optional<Rgb> color = ColorOf(point);
    if (color == kPlyNoColor) color.reset();
    const auto voxel = VoxelOf(p_W);
    return voxel && Occupy(*voxel, map_.colors.At(*voxel) ? std::nullopt : color);
  }

  bool ReadSurfaces() {
    for (std::size_t k = 0; k < file_.points.size(); ++k) {
      const auto voxel = VoxelOf(file_.points[k]);
      if (!voxel || !Occupy(*voxel, ColorOf(k))) return false;
    }
    for (const Corners& corners : file_.triangles) {
      const Triangle triangle = TriangleOf(corners);
      Eigen::AlignedBox3d extent;
      for (const Eigen::Vector3d& corner : triangle) extent.extend(corner);
      // As for points, the lower sides of a voxel belong to it: a floor in one leaves the voxel below alone.
      const VoxelBox around = {map_.grid.IndexOf(extent.min()),
                               map_.grid.IndexOf(extent.max()) + VoxelIndex{1, 1, 1}};
      if (!Cut(triangle, MeanColor(corners), around)) return false;
    }
    return true;
  }

  std::optional<Rgb> MeanColor(const Corners& corners) const {
    if (file_.colors.empty()) return std::nullopt;
    const auto mean = [&](std::uint8_t Rgb::*channel) {
      int sum = 0;
      for (const std::uint32_t corner : corners) sum += file_.colors[corner].*channel;
      return static_cast<std::uint8_t>((sum + 1) / 3);
    };
    return Rgb{mean(&Rgb::r), mean(&Rgb::g), mean(&Rgb::b)};
  }

  /// Halves the box until it is one voxel, and leaves out what the triangle does not pass through.
  bool Cut(const Triangle& triangle, const std::optional<Rgb>& color, const VoxelBox& box) {
    constexpr double kRounding = 1e-9;
    const double voxel_size = map_.grid.voxel_size();
    const auto corner = [voxel_size](const VoxelIndex& i) {
      return Eigen::Vector3d(voxel_size * Eigen::Vector3d(i.x, i.y, i.z));
    };
    if (++cuts_ > kCutsPerBlock * most_blocks_) {
      problem_ = "has triangles that pass through too many voxels of " + NumberText(voxel_size) + " m";
      return false;
    }
    if (OverlapDepth(triangle, {corner(box.min), corner(box.max)}) < -kRounding * voxel_size) return true;
    const int size = std::max({box.size_x(), box.size_y(), box.size_z()});
    if (size == 1) {
      const bool is_new = map_.grid.State(box.min) == VoxelState::kUnknown;
      return Occupy(box.min, is_new ? color : std::nullopt);
    }
    VoxelBox lower = box;
    VoxelBox upper = box;
    const auto halve = [&](std::int32_t VoxelIndex::*axis) {
      lower.max.*axis = upper.min.*axis = box.min.*axis + size / 2;
    };
    if (size == box.size_x()) {
      halve(&VoxelIndex::x);
    } else if (size == box.size_y()) {
      halve(&VoxelIndex::y);
    } else {
      halve(&VoxelIndex::z);
    }
    return Cut(triangle, color, lower) && Cut(triangle, color, upper);
  }

  /// The voxel at a point; nothing, and a problem, if the grid does not reach it.
  std::optional<VoxelIndex> VoxelOf(const Eigen::Vector3d& p_W) {
    constexpr double kReach = kMaxVoxelIndex + 1.0;
    const double voxel_size = map_.grid.voxel_size();
    // VoxelAt cannot say where integers end.
    if ((p_W.array().abs() * (1.0 / voxel_size) <= kReach).all()) {
      const VoxelIndex voxel = map_.grid.IndexOf(p_W);
      if (InIndexRange(voxel)) return voxel;
    }
    problem_ = "has a point at " + NumberText(p_W.x()) + ' ' + NumberText(p_W.y()) + ' ' +
               NumberText(p_W.z()) + " m, beyond " + NumberText(kReach * voxel_size) +
               " m, where the grid of voxels of " + NumberText(voxel_size) + " m ends";
    return std::nullopt;
  }

  bool Occupy(const VoxelIndex& voxel, const std::optional<Rgb>& color) {
    map_.grid.Set(voxel, kOccupiedOfBt);
    if (color) map_.colors.Add(voxel, *color);
    if (map_.grid.block_count() <= most_blocks_) return true;
    problem_ = "has more than " + std::to_string(most_blocks_) + " blocks of 8 x 8 x 8 voxels of " +
               NumberText(map_.grid.voxel_size()) + " m";
    return false;
  }

  const PlyFile& file_;
  const std::size_t most_blocks_;
  std::uint64_t cuts_ = 0;
  ColoredMap map_;
  std::string problem_;
};

}  // namespace

Result<ColoredMap> MapOf(const PlyFile& file, double voxel_size, std::size_t most_blocks) {
  return PlyVoxels(file, voxel_size, most_blocks).Read();
}

}  // namespace thalweg::mapper
