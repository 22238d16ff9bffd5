#pragma once

#include <cstdint>

#include "common/base/option_visitor.h"
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
  /// The defaults are the thesis's method.
  struct Options {
    enum class Cluster : std::uint8_t {
      kStreamline,     ///< Where the streamline of steepest descent from the robot ends.
      kFlux,           ///< The one into which most flows.
      kFluxPerLength,  ///< Most flux per meter of shortest path.
    };
    enum class Way : std::uint8_t {
      kStreamline,  ///< Along that streamline; only with Cluster::kStreamline.
      kShortest,
      kTraceBack,  ///< The streamline of steepest ascent from the cluster to the robot.
    };
    double source_radius = 0.0;       ///< [m] Of the source about the robot; 0 = the robot's voxel.
    double screening_length = 0.0;    ///< [m] 0 = none
    double relative_residual = 1e-6;  ///< At which the solver stops.
    Cluster cluster = Cluster::kStreamline;
    Way way = Way::kStreamline;
    bool seal = false;  ///< Explored dead ends are walls to the solver: faster, and hardly another field.

    /// As strategy potential_flux has them: a source of 0.3 m, most flux per meter, traced back.
    static Options FluxPerLength();
  };
  /// Throws std::invalid_argument naming the bad option.
  explicit Potential(const Options& options);
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

  Options options_;
  SealedField field_;
  bool has_field_ = false;  ///< Of the last choice.
};

void Visit(OptionVisitor& visitor, Potential::Options& options);  ///< Block `potential`.

}  // namespace thalweg::explorer
