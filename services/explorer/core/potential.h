#pragma once

#include "services/explorer/core/field/harmonic_field.h"
#include "services/explorer/core/strategy.h"

namespace thalweg::explorer {

/// Follows the flow: solves Laplace's equation over the free space that the robot can reach, the robot as
/// source and the goals of all clusters as sinks [Shade, Newman: Choosing where to go, ICRA 2011].
///
/// Departures, measured in the README: the source has the robot's size, not one voxel, whose neighbourhood
/// would decide by noise; the cluster is chosen by flux per metre of path, since flux alone prefers large,
/// far frontiers and leaves pockets behind; the streamline is traced from the cluster back up to the robot,
/// which always arrives.
class Potential final : public Strategy {
 public:
  explicit Potential(const StrategyOptions& options) : options_(options) {}
  Choice Choose(const Situation& situation) override;

 private:
  DenseGrid<FieldCell> MakeCells(const Situation& situation) const;
  std::vector<Eigen::Vector3d> TraceBack(const Situation& situation, const DenseGrid<FieldCell>& cells,
                                         const Candidate& candidate) const;

  StrategyOptions options_;
  HarmonicField field_;
};

}  // namespace thalweg::explorer
