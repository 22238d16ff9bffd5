#include "services/explorer/core/strategy/surface.h"

#include <gtest/gtest.h>

#include <vector>

#include "services/explorer/core/strategy/registry.h"
#include "tests/services/explorer/support/situations.h"
#include "tests/support/recording_visitor.h"

namespace thalweg::explorer {
namespace {

TEST(Surface, WantsInspectedWhatItsOptionsSay) {
  Surface::Options options;
  thalweg::test::RecordingVisitor visitor;
  visitor.Give("surface.distance_m", 1.5);
  visitor.Give("surface.max_angle_deg", 30.0);
  visitor.Give("surface.min_area_m2", 0.2);
  visitor.Give("surface.stop_cost_m", 0.7);
  visitor.Give("surface.least_strip", 0.4);
  visitor.Give("surface.eagerness", 3.0);
  Visit(visitor, options);
  const Surface surface(options, Flow::Options{});
  ASSERT_NE(surface.inspection(), nullptr);
  EXPECT_EQ(surface.inspection()->criterion.distance, 1.5);
  EXPECT_NEAR(surface.inspection()->criterion.max_angle, 30.0 * kDegree, 1e-12);
  EXPECT_EQ(surface.inspection()->min_area, 0.2);
  EXPECT_EQ(surface.inspection()->stop_cost, 0.7);
  EXPECT_EQ(surface.inspection()->least_strip, 0.4);
  EXPECT_EQ(surface.inspection()->eagerness, 3.0);
}

class SurfaceAmongSpecks : public test::RoomWithSpecks {};

TEST_F(SurfaceAmongSpecks, ExploresAsFlowDoesWithTheSameOptions) {
  PutSpecks({{10, 4, 6}, {58, 26, 6}, {67, 26, 6}});
  for (const double sight_worth : {0.0, 100.0}) {
    std::vector<Choice> choices;
    for (const char* name : {"flow", "surface"}) {
      ConfiguredStrategy strategy = Configure(name);
      thalweg::test::RecordingVisitor visitor;
      visitor.Give("flow.eagerness", 0.0);
      visitor.Give("flow.sight_worth_m_per_m2", sight_worth);
      Visit(visitor, strategy);
      choices.push_back(strategy.make()->Choose(situation()));
    }
    EXPECT_EQ(choices[1].path_W, choices[0].path_W);
    EXPECT_EQ(choices[1].target, choices[0].target);
    EXPECT_EQ(choices[0].target.size(), sight_worth > 0.0 ? 2U : 1U) << "the options make a difference";
  }
}

}  // namespace
}  // namespace thalweg::explorer
