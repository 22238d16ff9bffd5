#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "services/explorer/core/map/look_memory.h"
#include "services/explorer/core/outcome.h"

namespace thalweg::explorer {

/// What an exploration must not forget when its process dies: the mission, what an operator commanded,
/// whether it has gone a tight way, and what is set aside. The map comes from the mapper, and plans are made
/// again.
struct SavedExploration {
  std::string place{};                       ///< Names what is explored; another place's is not continued.
  std::optional<Eigen::Vector3d> home_W{};   ///< [m] Where the robot set out.
  double distance = 0.0;                     ///< [m] Traveled.
  Duration elapsed = Duration::zero();       ///< How much of the time budget is spent.
  std::optional<Outcome> homeward{};         ///< Why the robot is on its way home, if it is.
  std::optional<PauseCause> paused{};        ///< Why the robot waits, if it does.
  bool gone_tight_way = false;               ///< See TargetChooser::gone_tight_way.
  std::string strategy{};                    ///< Name.
  std::vector<Eigen::AlignedBox3d> drawn{};  ///< [m] No-go boxes.
  struct Aside {
    Eigen::Vector3d p_W;  ///< [m] Center of a voxel.
    AsideReason reason;
    bool operator==(const Aside&) const = default;
  };
  std::vector<Aside> aside{};
};

}  // namespace thalweg::explorer
