#include "services/mapper/adapter/map_files.h"

#include <fmt/format.h>

#include <limits>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "common/base/check.h"
#include "common/dds/convert.h"
#include "common/files/ply.h"
#include "common/files/write_file.h"
#include "common/geometry/height_color.h"
#include "services/mapper/core/octomap_keys.h"
#include "services/mapper/core/ply_file.h"

namespace thalweg::mapper {
namespace {

/// An OcTree whose clamping limits do not alter the values set. They would otherwise clamp our log-odds,
/// though nothing updates this tree after it has been built.
class UnclampedOcTree : public octomap::OcTree {
 public:
  explicit UnclampedOcTree(double voxel_size) : OcTree(voxel_size) {
    clamping_thres_min = std::numeric_limits<float>::lowest();
    clamping_thres_max = std::numeric_limits<float>::max();
  }
};

/// As OcTree::write and OcTree::writeBinary have it; Debian's OctoMap prints what it does while it writes
/// with these, which has no place in a log.
std::string HeaderOf(const octomap::OcTree& tree, std::string_view first_line) {
  return fmt::format(
      "{}\n# (feel free to add / change comments, but leave the first line as it is!)\n#\n"
      "id {}\nsize {}\nres {:g}\ndata\n",
      first_line, tree.getTreeType(), tree.size(), tree.getResolution());
}

/// Vertices and faces of a PLY file.
class PlyMesh {
 public:
  void AddSquare(const std::array<Eigen::Vector3d, 4>& corners_W, const Rgb& color) {
    for (const Eigen::Vector3d& corner_W : corners_W) PutVertex(vertices_, corner_W, color);
    Put(faces_, std::uint8_t{4});
    for (int corner = 0; corner < 4; ++corner) Put(faces_, 4 * squares_ + corner);
    ++squares_;
  }

  /// Adds a vertex without a face, which is not seen where meshes are shown.
  void AddPoint(const Eigen::Vector3d& p_W, const Rgb& color) {
    PutVertex(points_, p_W, color);
    ++point_count_;
  }

  std::string Encode(double voxel_size) const {
    std::ostringstream out;
    out << "ply\nformat binary_little_endian 1.0\ncomment occupied voxels of a map, in meters\n"
        << kPlyVoxelSize << fmt::format("{}", voxel_size) << "\nelement vertex "
        << 4 * squares_ + point_count_ << "\nproperty float x\nproperty float y\nproperty float z\n"
        << kPlyColors << "element face " << squares_
        << "\nproperty list uchar int vertex_indices\nend_header\n"
        << vertices_ << points_ << faces_;
    return out.str();
  }

 private:
  static void PutVertex(std::string& bytes, const Eigen::Vector3d& p_W, const Rgb& color) {
    for (const double value : p_W) Put(bytes, static_cast<float>(value));
    Put(bytes, color);
  }
  template <class T>
  static void Put(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  std::string vertices_;  ///< Corners of the squares.
  std::string points_;
  std::string faces_;
  std::int32_t squares_ = 0;
  std::int32_t point_count_ = 0;
};

/// The square between a voxel and its face neighbor, counterclockwise as seen from that neighbor.
std::array<Eigen::Vector3d, 4> SquareTowards(const VoxelIndex& voxel, const VoxelIndex& side,
                                             double voxel_size) {
  const Eigen::Vector3d normal(side.x, side.y, side.z);
  const Eigen::Vector3d u(std::abs(side.y), std::abs(side.z), std::abs(side.x));
  const Eigen::Vector3d v = normal.cross(u);
  const Eigen::Vector3d middle = VoxelCenter(voxel, voxel_size) + 0.5 * voxel_size * normal;
  const double half = 0.5 * voxel_size;
  return {middle + half * (-u - v), middle + half * (u - v), middle + half * (u + v),
          middle + half * (v - u)};
}

}  // namespace

std::unique_ptr<octomap::OcTree> ToOcTree(const OccupancyGrid& grid) {
  auto tree = std::make_unique<UnclampedOcTree>(grid.voxel_size());
  grid.ForEachKnown([&tree](const VoxelIndex& i, float log_odds) {
    tree->setNodeValue(KeyOf(i), log_odds, /*lazy_eval=*/true);
  });
  tree->updateInnerOccupancy();
  tree->prune();
  return tree;
}

std::string EncodeOt(const octomap::OcTree& tree) {
  std::ostringstream out;
  out << HeaderOf(tree, "# Octomap OcTree file");
  if (!tree.writeData(out)) throw std::runtime_error("cannot encode the map as .ot");
  return out.str();
}

std::string EncodeBt(octomap::OcTree& tree) {
  tree.toMaxLikelihood();
  tree.prune();
  std::ostringstream out;
  out << HeaderOf(tree, "# Octomap OcTree binary file");
  if (!tree.writeBinaryData(out)) throw std::runtime_error("cannot encode the map as .bt");
  return out.str();
}

std::string EncodePly(const OccupancyGrid& grid, const VoxelColors& colors) {
  PlyMesh mesh;
  grid.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    if (OccupancyGrid::StateOf(log_odds) != VoxelState::kOccupied) return;
    const Rgb color = colors.At(voxel).value_or(kPlyNoColor);
    bool is_inside = true;
    for (const VoxelIndex& side : kFaceNeighbors) {
      if (grid.State(voxel + side) == VoxelState::kOccupied) continue;
      is_inside = false;
      mesh.AddSquare(SquareTowards(voxel, side, grid.voxel_size()), color);
    }
    if (is_inside) mesh.AddPoint(grid.CenterOf(voxel), color);
  });
  return mesh.Encode(grid.voxel_size());
}

void SaveMap(const OccupancyGrid& grid, const VoxelColors& colors, const std::filesystem::path& folder) {
  const std::unique_ptr<octomap::OcTree> tree = ToOcTree(grid);
  SeparateWrites writes;
  // EncodeBt reduces the tree, so .ot is encoded before; .bt is the smallest and written first.
  std::string ot;
  writes.Try([&] { ot = EncodeOt(*tree); });
  writes.Try([&] { WriteFile(folder / "map.bt", EncodeBt(*tree)); });
  if (!ot.empty()) writes.Try([&] { WriteFile(folder / "map.ot", ot); });
  writes.Try([&] { WriteFile(folder / "map.ply", EncodePly(grid, colors)); });
  writes.ThrowErrors();
}

octomap_msgs::msg::Octomap ToIdl(Time stamp, const octomap::OcTree& tree) {
  std::ostringstream data;
  tree.writeData(data);
  const std::string bytes = data.str();
  octomap_msgs::msg::Octomap message;
  message.header(dds::MakeHeader(stamp, dds::kMapFrame));
  message.binary(false);
  message.id(tree.getTreeType());
  message.resolution(tree.getResolution());
  message.data().assign(bytes.begin(), bytes.end());
  return message;
}

std::vector<dds::ColoredPoint> OccupiedPoints(const OccupancyGrid& grid) {
  std::vector<dds::ColoredPoint> points;
  float low = std::numeric_limits<float>::max();
  float high = std::numeric_limits<float>::lowest();
  grid.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    if (OccupancyGrid::StateOf(log_odds) != VoxelState::kOccupied) return;
    points.push_back({grid.CenterOf(voxel).cast<float>(), {}});
    low = std::min(low, points.back().p_W.z());
    high = std::max(high, points.back().p_W.z());
  });
  const float span = std::max(high - low, 1e-3F);
  for (dds::ColoredPoint& point : points) point.color = HeightColor((point.p_W.z() - low) / span);
  return points;
}

std::vector<dds::ColoredPoint> ColoredPoints(const OccupancyGrid& grid, const VoxelColors& colors) {
  std::vector<dds::ColoredPoint> points;
  grid.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
    if (OccupancyGrid::StateOf(log_odds) != VoxelState::kOccupied) return;
    if (const std::optional<Rgb> color = colors.At(voxel)) {
      points.push_back({grid.CenterOf(voxel).cast<float>(), *color});
    }
  });
  return points;
}

}  // namespace thalweg::mapper
