#include "services/cli/adapter/evaluation_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "services/evaluator/adapter/scene.h"

namespace thalweg::cli {
namespace {

TEST(EvaluationFiles, TheTrueMapAsAGridAgreesWithTheTruthEverywhere) {
  const evaluator::Scene scene("tiny");
  const auto truth = scene.Truth(scene.Start(1).translation());
  const OccupancyGrid grid = GridOf(*truth, scene.Options("", 0).mapper.voxel_size);
  const auto agreement = truth->Compare(grid);
  EXPECT_EQ(agreement.share(), 1.0);
  EXPECT_EQ(agreement.coverage(), 1.0);
}

TEST(EvaluationFiles, AReportHasAPageAndThePicturesOfEachScenario) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("thalweg-evaluation-files-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  evaluator::Campaign::Options campaign;
  campaign.scenarios = {"tiny"};
  campaign.overrides = {"depth_sensor.disparity_noise_px=0.2"};
  campaign.strategies = {"closest"};
  campaign.runs = 1;
  campaign.threads = 1;
  WriteEvaluation(evaluator::Campaign(campaign).Run({}), campaign, folder);
  for (const char* const name : {"index.html", "tiny-coverage.png", "tiny-paths.png"}) {
    EXPECT_GT(std::filesystem::file_size(folder / name), 1000U) << name;
  }
  std::ostringstream page;
  page << std::ifstream(folder / "index.html").rdbuf();
  EXPECT_THAT(page.str(), testing::HasSubstr("All runs with depth_sensor.disparity_noise_px=0.2."));
  EXPECT_THAT(page.str(), testing::HasSubstr("Noise of the depth sensor"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace thalweg::cli
