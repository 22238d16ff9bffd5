#pragma once

#include <vector>

#include "common/base/result.h"
#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/map/frontier.h"
#include "services/explorer/core/saved_exploration.h"

namespace thalweg::explorer {

/// Places that stay set aside when the map is replaced or another process continues: those that an operator
/// ignores, for good, and those that an earlier process set aside, once.
class RememberedAsides {
 public:
  /// Sets the frontier nearest to a point aside, for good: also one that is set aside for another reason.
  /// Error: there is none within 1 m.
  Result<Cluster> Ignore(const Eigen::Vector3d& p_W, const FrontierOptions& frontier, Knowledge& knowledge,
                         Time now);
  /// Number of voxels that an operator ignores.
  std::size_t ignored() const { return ignored_.size(); }

  /// Sets all of them aside in a map that is new.
  void SetAsideAgain(Knowledge& knowledge, Time now);

  /// Appends them, and what is set aside in the map.
  void SaveTo(std::vector<SavedExploration::Aside>& saved, const Knowledge& knowledge) const;
  void Restore(const std::vector<SavedExploration::Aside>& saved);

 private:
  std::vector<SavedExploration::Aside> ignored_;
  std::vector<SavedExploration::Aside> restored_;
};

/// Whether an operator ignores a voxel.
bool IsIgnored(const LookMemory& memory, const VoxelIndex& i);

}  // namespace thalweg::explorer
