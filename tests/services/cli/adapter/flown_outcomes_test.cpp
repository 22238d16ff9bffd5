#include "services/cli/adapter/flown_outcomes.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "services/evaluator/adapter/scene.h"

namespace thalweg::cli {
namespace {

using testing::HasSubstr;

class FlownOutcomes : public testing::Test {
 protected:
  FlownOutcomes() {
    std::filesystem::create_directories(folder_);
    campaign_.scenarios = {"tiny"};
  }
  ~FlownOutcomes() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path FileOf(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  /// A second at the start, moved.
  std::filesystem::path FileOfStand(const std::string& name, double moved_m = 0.0) const {
    const RigidTransform T_WB = evaluator::Scene("tiny").Start(0);
    const Eigen::Quaterniond q(T_WB.linear());
    std::ostringstream text;
    for (const char* const stamp : {"0.0", "1.0"}) {
      text << stamp << ' ' << T_WB.translation().x() + moved_m << ' ' << T_WB.translation().y() << ' '
           << T_WB.translation().z() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
    }
    return FileOf(name, text.str());
  }
  std::string MistakeOf(const std::vector<std::filesystem::path>& files) const {
    try {
      JudgeTrajectories(files, campaign_, {});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("thalweg-flown-outcomes-" + std::to_string(getpid()));
  evaluator::Campaign::Options campaign_;
};

TEST_F(FlownOutcomes, ATrajectoryIsAnOutcomeUnderTheNameOfItsFile) {
  const std::vector<std::filesystem::path> files = {FileOfStand("other.tum"), FileOfStand("third.tum")};
  const auto outcomes = JudgeTrajectories(files, campaign_, {});
  ASSERT_EQ(outcomes.size(), 2U);
  EXPECT_EQ(outcomes[0].strategy, "other");
  EXPECT_EQ(outcomes[0].scenario, "tiny");
  EXPECT_EQ(outcomes[1].strategy, "third");
  EXPECT_GT(outcomes[0].coverage, 0.0);
}

TEST_F(FlownOutcomes, AnInvalidFileIsNamed) {
  const auto outside = FileOfStand("outside.tum", 50.0);
  EXPECT_THAT(MistakeOf({outside}), testing::StartsWith(outside.string() + ": "));
  const auto broken = FileOf("broken.tum", "0.0 1 2\n");
  EXPECT_THAT(MistakeOf({broken}), HasSubstr(broken.string()));
}

TEST_F(FlownOutcomes, TheScenarioMustBeClearOnlyWhereThereIsATrajectory) {
  campaign_.scenarios = {"tiny", "kitchen"};
  EXPECT_THAT(MistakeOf({"other.tum"}), HasSubstr("the one scenario"));
  EXPECT_EQ(MistakeOf({}), "");
}

TEST_F(FlownOutcomes, WhatIsNotJudgedBeforeAStopIsMissing) {
  std::stop_source source;
  source.request_stop();
  EXPECT_TRUE(JudgeTrajectories({FileOfStand("other.tum")}, campaign_, source.get_token()).empty());
}

}  // namespace
}  // namespace thalweg::cli
