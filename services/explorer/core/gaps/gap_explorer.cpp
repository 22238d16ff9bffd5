#include "services/explorer/core/gaps/gap_explorer.h"

#include "common/base/check.h"

namespace thalweg::explorer {

GapExplorer::GapExplorer(const Polygon& polygon, const Eigen::Vector2d& start,
                         const PointRobot::Options& options)
    : robot_(polygon, start, options), tree_(robot_.gaps().size()) {}

bool GapExplorer::Step() {
  if (tree_.IsComplete()) return false;
  if (!chosen_ || !tree_.Contains(*chosen_)) chosen_ = Choose();
  Chase(*chosen_);
  return true;
}

void GapExplorer::GoTo(GapTree::Node node) {
  while (tree_.Level(node) > 0) Chase(node);
}

GapTree::Node GapExplorer::Choose() const {
  std::optional<GapTree::Node> best;
  for (const GapTree::Node leaf : tree_.Leaves()) {
    if (tree_.IsPrimitive(leaf)) continue;
    const bool better = !best || tree_.Level(leaf) < tree_.Level(*best) ||
                        (tree_.Level(leaf) == tree_.Level(*best) && leaf > *best);
    if (better) best = leaf;
  }
  THALWEG_CHECK(best);
  return *best;
}

void GapExplorer::Chase(GapTree::Node node) {
  const GapEvent event = robot_.Chase(tree_.SlotOf(node));
  tree_.Apply(event);
  THALWEG_CHECK(tree_.in_sight().size() == robot_.gaps().size());
  log_.push_back({event, robot_.position(), robot_.length()});
}

}  // namespace thalweg::explorer
