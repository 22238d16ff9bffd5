#pragma once

#include <optional>

#include "common/base/option_visitor.h"
#include "services/explorer/core/strategy/strategy.h"
#include "services/explorer/core/view/sensor_gain.h"

namespace thalweg::explorer {

/// Goes where most can be seen: the place q, of those sampled among all that can be reached, with the largest
///   A(q) exp(-decay L(q)),
/// A the frontier voxels, doubtful ones by their weight, that the sensor would see from q in its best
/// direction, L the path length
/// [González-Baños, Latombe: Navigation strategies for exploring indoor environments, IJRR 21(10-11), 2002].
///
/// Which voxels are candidates is a matter of their index alone, so that a place once sampled stays one.
/// Places are tried in order of an upper bound, until no other can be better. When no sampled place sees
/// anything, the nearest cluster is gone to: the samples may miss the last gaps.
class InformationGain final : public Strategy {
 public:
  struct Options {
    double sample_share = 0.05;  ///< Of the voxels that can be reached, so many are candidate places.
    double decay = 0.2;          ///< [1/m] weighted: a gain A at a path length L counts A exp(-decay L).
  };
  /// @param decay  [1/m] 0 = whatever it costs to get there. Throws std::invalid_argument naming the bad
  ///               option.
  InformationGain(const Options& options, double decay);
  Choice Choose(const Situation& situation) override;

  /// Whether a voxel is a candidate place when it can be reached.
  static bool Sampled(const VoxelIndex& i, double share);

 private:
  Options options_;
  double decay_;
  std::optional<SensorGain> gain_;
  double voxel_size_ = 0.0;
};

void Visit(OptionVisitor& visitor, InformationGain::Options& options);  ///< Block `gain`.

}  // namespace thalweg::explorer
