#pragma once

#include <cstdint>

#include "common/base/option_visitor.h"
#include "services/explorer/core/field/descent.h"
#include "services/explorer/core/field/harmonic_field.h"
#include "services/explorer/core/field/relaxation.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// The method of the source thesis as it is printed [Shade: Choosing Where To Go, DPhil thesis, Oxford 2011,
/// Ch. 6], where Potential is what became of it here.
///   - Frontiers are the free voxels with an unknown face neighbor (FreeFrontier); each is a sink,
///     phi = -1. The robot's voxel is the source, phi = +1.
///   - The domain is all other free voxels, with obstacles grown by the robot's size. Unknown voxels are no
///     obstacles: the robot may end where part of its body reaches into them.
///   - Relax, with walls mirrored [Eq. 6.28], from phi = 0 to the printed stop; FollowDescent.
///   - The robot follows that line itself, and ends in the frontier voxel in which it ends.
/// The rules of the loop around it (looking around, scanning on the way, ...) are those of LoopRules; as
/// printed they are all off.
///
/// Departure: obstacles are grown by the robot's radius with the safety margin, as for every strategy. The
/// text has half the radius, with which the body would touch them.
///
/// Where the printed text is silent: a driving robot's domain is the slice at its height; frontier voxels
/// among grown obstacles, and the robot's own, do not count. A line that reaches no frontier is followed to
/// its lowest point; where it has none, the printed robot would stand still, and the exploration ends.
///
/// One rule is added, and can be switched off: a frontier voxel counts only if steps through the domain
/// connect it with the robot. Without it, what slope the sweeps leave leads the robot to and fro where some
/// are cut off, until the loop sets them aside; without that, too, it never stops.
///
/// What Potential does otherwise can be had one by one, to see what each is worth: sinks at viewing places,
/// the candidates of all other strategies, the nearest of which is gone to where no line arrives; as the
/// domain what the body can reach; and the solution of the equation in place of what sweeps have left of it.
class PotentialThesis final : public Strategy {
 public:
  struct Options {
    enum class Sinks : std::uint8_t { kFrontierVoxels, kViewingPlaces };
    enum class Domain : std::uint8_t {
      kFree,
      kReachable,  ///< What PathSearch reaches; only with Sinks::kViewingPlaces.
    };
    Sinks sinks = Sinks::kFrontierVoxels;
    Domain domain = Domain::kFree;
    /// HarmonicField solves, with its own options; of `relaxation` only the walls count, which must be
    /// kDropped.
    bool solve = false;
    RelaxationOptions relaxation;
    DescentOptions descent;
    bool connected_only = true;
  };
  /// Throws std::invalid_argument naming the invalid option.
  explicit PotentialThesis(const Options& options);
  /// 26-connected components of frontier voxels, each a candidate whose goals are its frontier voxels and
  /// whose unknowns are their unknown neighbors. Lengths are those of straight lines. None of its own where
  /// sinks are viewing places.
  std::optional<std::vector<Candidate>> FindCandidates(const Surroundings& surroundings) override;
  /// Descends to one of the candidates' goals.
  Choice Choose(const Situation& situation) override;
  const DenseGrid<float>* field() const override { return &shown_; }

 private:
  DenseGrid<double> Solve(const DenseGrid<FieldCell>& cells);

  Options options_;
  HarmonicField solver_;
  DenseGrid<float> shown_;
};

void Visit(OptionVisitor& visitor, PotentialThesis::Options& options);  ///< Block `potential_thesis`.

}  // namespace thalweg::explorer
