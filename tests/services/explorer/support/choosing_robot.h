#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "services/explorer/core/target_chooser.h"
#include "tests/services/explorer/support/rooms.h"

/// What tests of the target chooser share.
namespace thalweg::explorer::test {

struct Orders {
  std::function<Choice(const Situation&)> choose = [](const Situation&) { return Choice{}; };
  std::optional<InspectionOptions> inspection = {};
  std::optional<std::vector<Candidate>> own = {};
  std::optional<Eigen::Vector3d> misfit_W = {};
};

/// Does what a test orders. Without orders, it finds nothing worth its path.
class Obedient final : public Strategy {
 public:
  explicit Obedient(Orders orders) : orders_(std::move(orders)) {}
  std::optional<std::vector<Candidate>> FindCandidates(const Surroundings& /*surroundings*/) override {
    return orders_.own;
  }
  std::optional<Eigen::Vector3d> FindMisfit(const PlanningMap& map, const PathSearch& search) const override {
    const bool is_from_robot = search.Reached(map.IndexOf(kHere.translation()));
    return is_from_robot ? orders_.misfit_W : std::nullopt;
  }
  Choice Choose(const Situation& situation) override { return orders_.choose(situation); }
  const InspectionOptions* inspection() const override {
    return orders_.inspection ? &*orders_.inspection : nullptr;
  }

 private:
  Orders orders_;
};

inline ConfiguredStrategy Obeying(const Orders& orders) {
  return {"obedient", [orders] { return std::make_unique<Obedient>(orders); }};
}

/// A robot at home, with all that it chooses by.
struct ChoosingRobot {
  ChoosingRobot(const ExplorerOptions& with, const std::vector<VoxelChange>& changes,
                const RigidTransform& at = kHere)
      : options(with), T_WB(at) {
    knowledge.Update(changes, {}, kStart);
    mission.Move(T_WB.translation());
    EXPECT_FALSE(mission.Spent(kStart));
    mission.FindPathsHome(knowledge.map(), T_WB.translation());
  }
  Task Choose(Time now = kStart) {
    return chooser.Choose(T_WB, now, TaskMaker(options, knowledge, nullptr), mission, knowledge, going_back,
                          timings);
  }

  ExplorerOptions options;
  RigidTransform T_WB;
  Knowledge knowledge{KnowledgeOptions(options)};
  Mission mission{MissionOptions(options)};
  GoingBack going_back{options};
  TargetChooser chooser{options, knowledge};
  StageTimings timings;
};

class TargetChooserTest : public testing::Test {
 protected:
  void Order(const Orders& orders) { options_.strategy = Obeying(orders); }

  ExplorerOptions options_ = GoingOptions();
};

}  // namespace thalweg::explorer::test
