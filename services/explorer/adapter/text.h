#pragma once

#include <string>
#include <string_view>

#include "services/explorer/core/exploration_loop.h"

namespace thalweg::explorer {

/// One line for people: what a plan does and why; for an ending, what stayed unknown and why.
/// @param sensor_range  [m] Mentioned where it may be the reason why too much stayed unknown.
std::string PlanText(const Plan& plan, double sensor_range);

/// What stayed unknown at an ending, and why, and what to check; empty if nothing.
/// @param sensor_range  As above.
std::string DetailsText(const Ending& ending, double sensor_range);

/// Why the robot is paused: "by the operator", ...
std::string PauseText(const PauseCause& cause);

/// What an operator reads: what happens now, or why a command was refused, how the exploration ended
/// included.
std::string AnswerText(const Answer& answer);

/// Why a plan was interrupted: "the path is no longer clear", ...
std::string_view InterruptionText(Interruption interruption);

/// The text of the loop's plan, or what the loop is waiting for.
std::string ActivityText(const ExplorationLoop& loop, double sensor_range);

}  // namespace thalweg::explorer
