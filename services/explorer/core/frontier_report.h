#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/explorer/core/candidate_search.h"
#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/outcome.h"
#include "services/explorer/core/shut_ways.h"
#include "services/explorer/core/strategy/strategy.h"
#include "services/explorer/core/tight_ways.h"

namespace thalweg::explorer {

/// A frontier cluster as seen by the last plan.
struct FrontierReport {
  enum class Fate : std::uint8_t {
    kLeft,
    kChosen,  ///< The goal of the plan.
    kSetAside,
  };
  Eigen::Vector3d center_W{0, 0, 0};  ///< [m]
  std::size_t voxels = 0;             ///< Unknown voxels, or doubtful ones.
  double length = 0.0;  ///< [m] Length of the shortest path to a position that sees it; NaN when set aside.
  double score = 0.0;   ///< From the strategy, larger is better; NaN when it gives none.
  Fate fate = Fate::kLeft;
  AsideReason reason = AsideReason::kNone;  ///< Why it was set aside.
  bool doubtful = false;                    ///< Whether its voxels are known, but uncertain.
};

/// The candidates of a plan, with the chosen one marked, and connected components of what is set aside.
std::vector<FrontierReport> ReportFrontiers(const Knowledge& knowledge, std::span<const Candidate> candidates,
                                            const Choice& choice);

/// How much was set aside for one reason.
struct SetAsideCount {
  AsideReason reason = AsideReason::kNone;
  bool doubtful = false;  ///< Whether the voxels are known, but uncertain.
  std::size_t clusters = 0;
  std::size_t voxels = 0;
};
/// Everything that is set aside, and the clusters dropped as too small.
std::vector<SetAsideCount> CountSetAside(const Knowledge& knowledge, const Frontiers& frontiers);

/// The ending when there is nothing left to go to: what stayed unknown, and whether that is too much to call
/// the exploration complete.
/// @param max_missed_share  Share of the border of free space (OpenBorder).
/// @param search  Its candidates are those that the strategy found not worth the path.
/// @param tight   The exploration is not complete if what could be seen by these is more than 1 % of what is
///                known, in voxels.
Ending EndingWithNothingLeft(const Knowledge& knowledge, double max_missed_share,
                             const CandidateSearch& search, std::span<const ShutWays::Way> shut = {},
                             std::span<const TightWay> tight = {});
/// Share of the candidates' unknown voxels in the border of free space.
double ShareOfBorder(const Knowledge& knowledge, std::span<const Candidate> candidates);

}  // namespace thalweg::explorer
