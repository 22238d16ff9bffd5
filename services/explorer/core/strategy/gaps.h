#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "services/explorer/core/gaps/gap_tracker.h"
#include "services/explorer/core/path/island.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// The gap navigation tree of the source thesis' Algorithm 1 [Shade: Choosing Where To Go, DPhil thesis,
/// Oxford 2011, after Tovar, Murrieta-Cid, LaValle 2007], for a robot that drives where all that it can get
/// to is simply connected; FindMisfit says where it is not.
///
/// At each decision the columns of the map's band of heights are the cells of a plane: walls where one voxel
/// is occupied, free where one is free and none occupied. What is out of sight there are shadows
/// (FindShadows), from which GapTracker has the tree. A leaf is primitive where no candidate lies in what it
/// hides. The next leaf is chosen as GapExplorer does: the one chosen before while it is there and not
/// primitive, else the one with the fewest gaps above it, of those the one seen first most recently.
///
/// Departures from the algorithm, whose robot is a point with a perfect sensor, and chases a gap until an
/// event. This one has a map: it goes to the nearest of the leaf's candidates on the shortest path, and looks
/// again when it has arrived, by when several events may have come and gone. What stayed unknown in plain
/// sight, as that beyond the sensor's range, comes before any leaf, the nearest first.
class Gaps final : public Strategy {
 public:
  Choice Choose(const Situation& situation) override;
  std::optional<Eigen::Vector3d> FindMisfit(const PlanningMap& map, const PathSearch& search) const override {
    return FindIsland(map, search);
  }
  const GapTracker& tree() const { return tree_; }

 private:
  using Leaf = std::optional<GapTracker::Node>;
  /// Updates the tree. @return The leaf that hides each candidate; nothing for one in plain sight.
  std::vector<Leaf> FindLeaves(const Situation& situation);
  /// Where to go next, of what hides the candidates.
  Leaf NextLeaf(const std::vector<Leaf>& leaves);

  GapTracker tree_;
  std::optional<GapTracker::Node> chosen_;
};

}  // namespace thalweg::explorer
