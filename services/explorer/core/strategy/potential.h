#pragma once

#include <cstdint>

#include "common/base/option_visitor.h"
#include "services/explorer/core/field/sealed_field.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// Solves Laplace's equation over the free space that the robot can reach, with the robot as the source
/// (phi = +1), the goals of all clusters as sinks (phi = -1) and no flux through walls. Then follows the
/// streamline of steepest descent from the robot to the sink where it ends, after [Shade, Newman: Choosing
/// where to go, ICRA 2011]; PotentialThesis is the method as it is printed. The goals of doubtful clusters
/// are weak sinks with phi = -weight; a goal of clusters of both kinds is a full sink.
///
/// The options depart further from that method, each to test a hypothesis
/// (docs/decisions/0016-strategies-behind-one-interface.md): a larger source, because most of the drop in phi
/// lies within a few voxels of a small one, where noise decides the direction; screening, which weakens
/// distant sinks; another choice of the cluster; another path to it. The path is pulled straight, as with
/// every strategy. Explored dead ends can be sealed (field/sealed_field.h).
class Potential final : public Strategy {
 public:
  /// The defaults are those nearest to the printed method; PotentialThesis is that method itself.
  struct Options {
    enum class Cluster : std::uint8_t {
      kStreamline,     ///< The one where the streamline of steepest descent from the robot ends.
      kFlux,           ///< The one with the largest inflow.
      kFluxPerLength,  ///< The one with the largest inflow per meter of shortest path.
    };
    enum class Path : std::uint8_t {
      kStreamline,  ///< The streamline itself; only with Cluster::kStreamline.
      kShortest,    ///< The shortest path.
      kTraceBack,   ///< The streamline of steepest ascent from the cluster to the robot.
    };
    double source_radius = 0.0;     ///< [m] The source is a sphere around the robot; 0 = the robot's voxel.
    double screening_length = 0.0;  ///< [m] 0 = no screening.
    /// The solver stops when the relative residual is below it.
    double relative_residual = HarmonicField::Options{}.relative_residual;
    Cluster cluster = Cluster::kStreamline;
    Path path = Path::kStreamline;
    bool seal = false;  ///< Treats explored dead ends as walls: faster, and the field hardly changes.
    HarmonicField::Solver solver = HarmonicField::Options{}.solver;
    int threads = HarmonicField::Options{}.threads;  ///< The solver's, on the CPU.

    /// These options with what makes strategy potential_flux: a source of 0.3 m, the cluster with the largest
    /// inflow per meter of path, the path traced back from it, dead ends sealed.
    Options FluxPerLength() const;
  };
  /// Throws std::invalid_argument naming the invalid option.
  explicit Potential(const Options& options);
  Choice Choose(const Situation& situation) override;
  const DenseGrid<float>* field() const override { return has_field_ ? &field_.phi() : nullptr; }
  std::vector<VoxelIndex> sealed() const override;

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
  bool has_field_ = false;  ///< Whether the last choice needed the field.
};

void Visit(OptionVisitor& visitor, Potential::Options& options);  ///< Block `potential`.

}  // namespace thalweg::explorer
