#include "services/explorer/core/no_go_boxes.h"

#include <algorithm>
#include <optional>

namespace thalweg::explorer {

void NoGoBoxes::PutUp(const Eigen::Vector3d& p_W, Knowledge& knowledge) {
  std::vector<Eigen::AlignedBox3d> up = options_.fixed;
  lifted_.clear();
  for (const Eigen::AlignedBox3d& box : drawn_) {
    (knowledge.map().Touches(box, p_W, options_.robot_radius) ? lifted_ : up).push_back(box);
  }
  knowledge.SetNoGo(up);
}

void NoGoBoxes::ClearDrawn(Knowledge& knowledge) {
  drawn_.clear();
  lifted_.clear();
  knowledge.SetNoGo(options_.fixed);
}

bool NoGoBoxes::ReachIntoLifted(const PlanningMap& map, const VoxelIndex& i) const {
  return std::ranges::any_of(lifted_, [&](const auto& box) { return map.ReachesInto(box, i); });
}

void NoGoBoxes::PutUpAll(Knowledge& knowledge) const {
  std::vector<Eigen::AlignedBox3d> all = options_.fixed;
  all.insert(all.end(), drawn_.begin(), drawn_.end());
  knowledge.SetNoGo(all);
}

bool NoGoBoxes::DrawnTouch(const PlanningMap& map, const Eigen::Vector3d& p_W) const {
  return std::ranges::any_of(drawn_,
                             [&](const auto& box) { return map.Touches(box, p_W, options_.robot_radius); });
}

std::vector<Eigen::Vector3d> NoGoBoxes::PathOut(const PlanningMap& map, const Eigen::Vector3d& p_W,
                                                const std::function<bool(const VoxelIndex&)>& may_end) const {
  PathSearch search;
  for (const PathSearch::Exemption& exemption :
       {PathSearch::Exemption{options_.exemption}, PathSearch::Exemption{options_.wide_exemption, true}}) {
    search.Flood(map, PathSearch::StartAt(map, p_W, options_.robot_radius, exemption));
    std::optional<VoxelIndex> exit;
    for (std::size_t k = 0; k < search.costs().size(); ++k) {
      if (search.costs()[k] == PathSearch::kUnreached) continue;
      const VoxelIndex i = search.costs().IndexAt(k);
      if (exit && search.Cost(i) >= search.Cost(*exit)) continue;
      if (!ReachIntoLifted(map, i) && may_end(i)) exit = i;
    }
    if (exit) return search.PathFrom(map, p_W, *exit);
  }
  return {};
}

}  // namespace thalweg::explorer
