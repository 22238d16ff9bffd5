#pragma once

#include <filesystem>
#include <stop_token>
#include <vector>

#include "services/evaluator/adapter/campaign.h"

namespace thalweg::cli {

/// Judges trajectories that other programs flew, see evaluator::Scene::JudgeTrajectory; each has its file's
/// name in place of a strategy's. When stopped, those not yet judged are missing.
/// @param files     In TUM's format.
/// @param campaign  Its one scenario, with its overrides, is where they were flown.
/// Throws std::runtime_error if there are files and not exactly one scenario, and naming a file that is
/// invalid.
std::vector<evaluator::Outcome> JudgeTrajectories(const std::vector<std::filesystem::path>& files,
                                                  const evaluator::Campaign::Options& campaign,
                                                  const std::stop_token& stop);

}  // namespace thalweg::cli
