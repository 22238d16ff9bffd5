#include "services/cli/adapter/rift_runs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace thalweg::cli {
namespace {

RiftRun Explored(int moves, int start) {
  surface::ExplorationOptions options{.surface = {}, .moves = moves, .views_per_move = 3};
  options.surface.height = 0.3;  // [m] The room is 1.6 m high.
  return RiftRuns("tiny", {"stereo_camera.width_px=160", "stereo_camera.height_px=120"}, true, options)
      .From(start);
}

TEST(RiftRuns, CountWhatTheExplorationDid) {
  for (const int start : {1, 2, 3}) {
    const RiftRun run = Explored(4, start);
    EXPECT_EQ(run.start, start);
    EXPECT_EQ(run.views + run.refused, 1U + 3U * static_cast<std::size_t>(run.moves));
    EXPECT_EQ(run.points, 160U * 120U * (run.views - 1)) << "a closed room, so all pixels are valid";
    EXPECT_EQ(run.vertices, 160U * 120U * run.views - run.merged);
    EXPECT_LE(run.cubes, run.vertices);
    EXPECT_LE(run.in_solid, run.poses);
    EXPECT_LE(run.hanging, run.rift_edges);
    EXPECT_GE(run.rift_edges, run.rifts);
    EXPECT_EQ(run.rifts == 0, run.end == surface::ExplorationEnd::kNoRift);
    EXPECT_LE(run.inspected, run.seen);
  }
}

TEST(RiftRuns, ViewsOnTheWayShowMoreOfTheTrueSurface) {
  const RiftRun first = Explored(0, 2);
  const RiftRun last = Explored(4, 2);
  EXPECT_EQ(first.views, 1U);
  EXPECT_EQ(first.path, 0.0);
  EXPECT_GT(first.seen, 0.01);
  ASSERT_GT(last.views, 1U);
  EXPECT_GT(last.seen, 2.0 * first.seen);
  EXPECT_LT(last.seen, 1.0);
  EXPECT_GT(last.path, 0.0);
}

TEST(RiftRuns, EveryLineOfTheTableHasTheColumnsOfItsHeading) {
  RiftRun run{.start = 7, .end = surface::ExplorationEnd::kNoWay, .moves = 2, .seen = 1.0, .inspected = 1.0};
  run.poses = run.in_solid = 10;
  const std::string heading = RiftRunHeading();
  const std::string line = ToText(run);
  EXPECT_EQ(heading.find("end\n"), line.find("no path to a rift\n"));
  EXPECT_THAT(line, testing::HasSubstr("100.0 %"));
}

}  // namespace
}  // namespace thalweg::cli
