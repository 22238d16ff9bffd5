#include "services/cli/adapter/flown_outcomes.h"

#include <stdexcept>
#include <string>

#include "services/evaluator/adapter/scene.h"
#include "services/visual_odometry/adapter/trajectory_file.h"

namespace thalweg::cli {

std::vector<evaluator::Outcome> JudgeTrajectories(const std::vector<std::filesystem::path>& files,
                                                  const evaluator::Campaign::Options& campaign,
                                                  const std::stop_token& stop) {
  if (files.empty()) return {};
  if (campaign.scenarios.size() != 1) {
    throw std::runtime_error("--trajectory: give the one scenario in which it was flown");
  }
  const evaluator::Scene scene(campaign.scenarios.front(), campaign.overrides);
  std::vector<evaluator::Outcome> outcomes;
  for (const std::filesystem::path& file : files) {
    if (stop.stop_requested()) break;
    try {
      const auto poses = visual_odometry::ReadTumTrajectory(file);
      outcomes.push_back(scene.JudgeTrajectory(poses, file.stem().string(), stop));
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(file.string() + ": " + error.what());
    }
  }
  return outcomes;
}

}  // namespace thalweg::cli
