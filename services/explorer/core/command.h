#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <variant>

#include "services/explorer/core/errand.h"
#include "services/explorer/core/outcome.h"

namespace thalweg::explorer {

/// What an operator may command while the robot explores. Nothing here overrides the robot's own safety:
/// every path is planned, checked and interrupted as those of the exploration are, and budgets hold.
namespace command {
struct Pause {};   ///< Stops the robot wherever it is, and waits.
struct Resume {};  ///< Continues exploring after a pause, or instead of an errand.
struct Step {};    ///< Makes one decision, or finishes the present one, and pauses.
struct Stop {};    ///< Ends the exploration where the robot is.
struct GoHome {};  ///< Ends the exploration where the robot set out.
struct Run {
  Errand errand;  ///< Carried out before anything else; then the robot waits, paused.
};
struct Ignore {
  Eigen::Vector3d p_W;  ///< [m] The frontier nearest to it is no longer a target.
};
struct DrawNoGo {
  Eigen::AlignedBox3d box_W;  ///< [m] The robot stays out of it until the boxes are cleared.
};
struct ClearNoGo {};
struct UseStrategy {
  std::string name;  ///< Decides from the next decision on.
};
}  // namespace command

using Command =
    std::variant<command::Pause, command::Resume, command::Step, command::Stop, command::GoHome, command::Run,
                 command::Ignore, command::DrawNoGo, command::ClearNoGo, command::UseStrategy>;

/// The answer to a command.
struct Answer {
  bool accepted = false;
  std::string text;                  ///< What happens now, or why the command was refused.
  std::optional<Ending> ended = {};  ///< How the exploration has ended, if that is why.
};

}  // namespace thalweg::explorer
