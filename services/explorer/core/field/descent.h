#pragma once

#include <Eigen/Core>
#include <optional>

#include "services/explorer/core/field/integrator.h"
#include "services/explorer/core/field/streamline.h"

namespace thalweg::explorer {

/// The gradient of a potential: at the cells' centers, and trilinear interpolation between them, as the
/// source thesis has it. The thesis does not say from which differences: these are central, and a wall
/// mirrors the value opposite to it, as in its stencil.
class GradientField {
 public:
  /// Both grids, over the same box, must outlive this.
  GradientField(const DenseGrid<FieldCell>& cells, const DenseGrid<double>& phi, double cell_size)
      : cells_(cells), phi_(phi), cell_size_(cell_size) {}

  /// [1/m] At the center of a cell that is no wall.
  Eigen::Vector3d AtCenter(const VoxelIndex& i) const;
  /// [1/m] Among the eight centers around the point, walls are left out, and the others' weights sum to 1.
  /// Empty where all of them are walls: so a point may lie up to half a cell inside a wall.
  std::optional<Eigen::Vector3d> At(const Eigen::Vector3d& p_W) const;
  /// The unit vector of steepest descent; empty where the gradient is, and where there is no slope. The
  /// thesis does not say whether it normalizes; the line is the same, and its steps then have equal lengths.
  std::optional<Eigen::Vector3d> Downhill(const Eigen::Vector3d& p_W) const;

 private:
  bool Open(const VoxelIndex& i) const { return cells_.Get(i, FieldCell::kWall) != FieldCell::kWall; }

  const DenseGrid<FieldCell>& cells_;
  const DenseGrid<double>& phi_;
  double cell_size_;
};

struct DescentOptions {
  Integrator integrator = Integrator::kRungeKutta4;
  double step_cells = 0.25;  ///< The thesis prints none.
  double max_length_cells = 5000.0;
};

/// Follows the line of steepest descent from the center of cell `start` to a sink, as the source thesis does:
/// the first step leads to the center of the face neighbor with the lowest phi, the others follow the
/// gradient. Nothing keeps the line out of walls but the field, whose slope into them is zero at the centers
/// beside them: around an edge it may cut through half a cell. A step to where there is no gradient is
/// halved, six times at most; there, and where steps turn back on themselves, the line ends as kStuck. That
/// happens: in a corner with a wall on each axis the mirrored differences are all zero, though a neighbor may
/// be lower.
Streamline FollowDescent(const DenseGrid<FieldCell>& cells, const DenseGrid<double>& phi, double cell_size,
                         const VoxelIndex& start, const DescentOptions& options);

}  // namespace thalweg::explorer
