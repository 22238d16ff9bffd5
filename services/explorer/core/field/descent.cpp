#include "services/explorer/core/field/descent.h"

#include <cmath>

namespace thalweg::explorer {
namespace {

constexpr int kMostHalvings = 6;
constexpr double kLeastLength = 1e-3;  ///< Share of a step, below which it has turned back on itself.
constexpr double kLeastWeight = 1e-6;  ///< Least sum for the centers around a point that are no walls.

/// The face neighbor with the lowest phi.
std::optional<VoxelIndex> LowestNeighbor(const DenseGrid<FieldCell>& cells, const DenseGrid<double>& phi,
                                         const VoxelIndex& i) {
  std::optional<VoxelIndex> lowest;
  for (const VoxelIndex& step : kFaceNeighbors) {
    const VoxelIndex neighbor = i + step;
    if (cells.Get(neighbor, FieldCell::kWall) == FieldCell::kWall) continue;
    if (!lowest || phi[neighbor] < phi[*lowest]) lowest = neighbor;
  }
  return lowest;
}

}  // namespace

Eigen::Vector3d GradientField::AtCenter(const VoxelIndex& i) const {
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const VoxelIndex up = i + kFaceNeighbors[2 * axis];
    const VoxelIndex down = i + kFaceNeighbors[2 * axis + 1];
    if (!Open(up) || !Open(down)) continue;  // mirrored, both sides have one value
    gradient[axis] = (phi_[up] - phi_[down]) / (2.0 * cell_size_);
  }
  return gradient;
}

std::optional<Eigen::Vector3d> GradientField::At(const Eigen::Vector3d& p_W) const {
  const Eigen::Vector3d cell = p_W / cell_size_ - Eigen::Vector3d::Constant(0.5);
  const Eigen::Vector3d floor = cell.array().floor();
  const Eigen::Vector3d share = cell - floor;
  const VoxelIndex low{static_cast<std::int32_t>(floor.x()), static_cast<std::int32_t>(floor.y()),
                       static_cast<std::int32_t>(floor.z())};
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const VoxelIndex step{corner & 1, corner >> 1 & 1, corner >> 2};
    if (!Open(low + step)) continue;
    const double weight = (step.x != 0 ? share.x() : 1.0 - share.x()) *
                          (step.y != 0 ? share.y() : 1.0 - share.y()) *
                          (step.z != 0 ? share.z() : 1.0 - share.z());
    sum += weight * AtCenter(low + step);
    weights += weight;
  }
  if (!(weights > kLeastWeight)) return std::nullopt;
  return sum / weights;
}

std::optional<Eigen::Vector3d> GradientField::Downhill(const Eigen::Vector3d& p_W) const {
  const std::optional<Eigen::Vector3d> gradient = At(p_W);
  const double norm = gradient ? gradient->norm() : 0.0;
  if (!(norm > 0.0)) return std::nullopt;
  return -*gradient / norm;
}

Streamline FollowDescent(const DenseGrid<FieldCell>& cells, const DenseGrid<double>& phi, double cell_size,
                         const VoxelIndex& start, const DescentOptions& options) {
  const GradientField gradient(cells, phi, cell_size);
  const auto downhill = [&](const Eigen::Vector3d& p_W) { return gradient.Downhill(p_W); };
  const auto cell_at = [&](const Eigen::Vector3d& p_W) {
    return cells.Get(VoxelAt(p_W, cell_size), FieldCell::kWall);
  };
  Streamline line{.points_W = {VoxelCenter(start, cell_size)}};
  const std::optional<VoxelIndex> first = LowestNeighbor(cells, phi, start);
  if (!first || !(phi[*first] < phi[start])) return line;
  line.points_W.push_back(VoxelCenter(*first, cell_size));
  double length_cells = 1.0;
  while (!IsSink(cell_at(line.points_W.back()))) {
    if (length_cells > options.max_length_cells) {
      line.end = StreamlineEnd::kTooLong;
      return line;
    }
    std::optional<Eigen::Vector3d> next_W;
    double step_cells = options.step_cells;
    for (int halvings = 0; halvings <= kMostHalvings && !next_W; ++halvings, step_cells *= 0.5) {
      next_W = StepAlong(options.integrator, downhill, line.points_W.back(), step_cells * cell_size);
      if (next_W && !gradient.At(*next_W)) next_W.reset();
    }
    const double length = next_W ? (*next_W - line.points_W.back()).norm() : 0.0;
    if (length < kLeastLength * options.step_cells * cell_size) return line;
    length_cells += options.step_cells;
    line.points_W.push_back(*next_W);
  }
  line.end = StreamlineEnd::kArrived;
  return line;
}

}  // namespace thalweg::explorer
