#pragma once

#include <optional>

#include "common/base/option_visitor.h"
#include "services/explorer/core/strategy/strategy.h"
#include "services/explorer/core/view/sensor_gain.h"

namespace thalweg::explorer {

/// Goes where the sensor would see most: to the position q, among samples of all reachable positions, that
/// maximizes
///   A(q) exp(-decay L(q)),
/// where A is the number of frontier voxels, doubtful ones counted by their weight, that the sensor would see
/// from q in its best orientation, and L is the path length
/// [González-Baños, Latombe: Navigation strategies for exploring indoor environments, IJRR 21(10-11), 2002].
///
/// Whether a voxel is sampled depends on its index alone, so that the samples stay the same between calls.
/// Positions are examined in descending order of an upper bound on their score, until no other can be better.
/// If no sampled position sees anything, the strategy goes to the nearest cluster, since the samples may miss
/// the last gaps.
class InformationGain final : public Strategy {
 public:
  struct Options {
    double sample_share = 0.05;  ///< Share of the reachable voxels that are sampled.
    double decay = 0.2;  ///< [1/m] Used by weighted_information_gain; see A(q) exp(-decay L(q)) above.
  };
  /// @param decay  [1/m] Used instead of options.decay; 0 = the path length does not matter.
  /// Throws std::invalid_argument naming the invalid option.
  InformationGain(const Options& options, double decay);
  Choice Choose(const Situation& situation) override;

  /// Whether a voxel belongs to the samples, which are a share `share` of all voxels.
  static bool Sampled(const VoxelIndex& i, double share);

 private:
  Options options_;
  double decay_;
  std::optional<SensorGain> gain_;
  double voxel_size_ = 0.0;
};

void Visit(OptionVisitor& visitor, InformationGain::Options& options);  ///< Block `gain`.

}  // namespace thalweg::explorer
