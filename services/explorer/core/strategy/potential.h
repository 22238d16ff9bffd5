#pragma once

#include "services/explorer/core/field/sealed_field.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// Follows the flow: solves Laplace's equation over the free space that the robot can reach, the robot as
/// source (+1) and the goals of all clusters as sinks (-1), no flux through walls; goes where the streamline
/// from the robot ends, along it [Shade, Newman: Choosing where to go, ICRA 2011]. The goals of clusters that
/// are only doubtful are weak sinks, of phi = -weight; where a goal is of both kinds it is a sink.
///
/// Switches, each for a hypothesis (README): a source of some size, since most of the drop lies within a few
/// voxels of a small one, where noise decides; screening, which makes far sinks weaker; which cluster, and
/// which way. As any path it is then pulled straight. Explored dead ends may be sealed
/// (field/sealed_field.h).
class Potential final : public Strategy {
 public:
  /// Throws std::invalid_argument naming the bad option.
  explicit Potential(const PotentialOptions& options);
  Choice Choose(const Situation& situation) override;
  const DenseGrid<float>* field() const override { return has_field_ ? &field_.phi() : nullptr; }

 private:
  DenseGrid<FieldCell> MakeCells(const Situation& situation) const;
  void Solve(const Situation& situation, DenseGrid<FieldCell>& cells);
  Choice FollowStreamline(const Situation& situation, const DenseGrid<FieldCell>& cells,
                          const DenseGrid<std::int32_t>& groups) const;
  Choice ByFlux(const Situation& situation, const DenseGrid<FieldCell>& cells,
                const DenseGrid<std::int32_t>& groups) const;
  std::vector<Eigen::Vector3d> TraceBack(const Situation& situation, const DenseGrid<FieldCell>& cells,
                                         const Candidate& candidate) const;

  PotentialOptions options_;
  SealedField field_;
  bool has_field_ = false;  ///< Of the last choice.
};

/// The switches as strategy potential_flux has them: a source of 0.3 m, most flux per metre, traced back.
PotentialOptions FluxPerLengthOptions();

}  // namespace thalweg::explorer
