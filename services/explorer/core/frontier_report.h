#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "services/explorer/core/knowledge.h"
#include "services/explorer/core/outcome.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// A frontier as the last plan saw it.
struct FrontierReport {
  enum class Fate : std::uint8_t {
    kLeft,
    kChosen,    ///< The plan goes there.
    kSetAside,  ///< See reason.
  };
  Eigen::Vector3d center_W{0, 0, 0};  ///< [m]
  std::size_t voxels = 0;             ///< Unknown ones, or doubtful ones: then the reason says so.
  double length = 0.0;                ///< [m] Of the shortest path to where it is seen; NaN when set aside.
  double score = 0.0;                 ///< The strategy's, larger is better; NaN where it gives none.
  Fate fate = Fate::kLeft;
  std::string reason;
};

/// The candidates of a plan with what was chosen, and what is set aside, by connected components.
std::vector<FrontierReport> ReportFrontiers(const Knowledge& knowledge, std::span<const Candidate> candidates,
                                            const Choice& choice);

/// How much was set aside for one reason.
struct SetAsideCount {
  std::string reason;
  std::size_t clusters = 0;
  std::size_t voxels = 0;
};
/// All that is set aside, and what was dropped as too small.
std::vector<SetAsideCount> CountSetAside(const Knowledge& knowledge, const Frontiers& frontiers);

/// What stays unknown at an end where nothing is left to go to, and whether it is too much to call the end
/// complete.
/// @param max_missed_share  Of what free space ends at (OpenBorder).
Ending EndingWithNothingLeft(const Knowledge& knowledge, double max_missed_share);

}  // namespace thalweg::explorer
