#include "services/surface/evaluation/experiment_report.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/common/surface_graph/scenes.h"

namespace thalweg::surface {
namespace {

namespace fs = std::filesystem;

TEST(ExperimentReport, HoldsEachRowAsTextAsJsonAndAsPictures) {
  const fs::path folder = fs::temp_directory_path() / ("experiment_report_" + std::to_string(getpid()));
  fs::create_directories(folder);
  for (const char* const earlier : {"edges-07.png", "rifts-100.png", "edges-of-mine.png"})
    std::ofstream(folder / earlier) << "of an earlier experiment";
  const StereoGeometry rig = test::Rig(40, 30, 30.0);
  const View step = test::ViewOf(rig, RigidTransform::Identity(), test::StepAt);
  const View plane = test::PlaneTwice(rig, 2.0, 0).first;

  std::ostringstream out;
  ExperimentReport report(out, folder, 2);
  std::string expected = RowHeading();
  std::size_t searches = 0;
  for (const View& view : {step, plane}) {
    Surface surface({});
    surface.Add(view);
    const Move move = surface.PlanMove();
    const SurfaceRow row = Measure("a view", surface, move);
    report.Add(row, surface, move);
    expected += ToText(row);
    for (const SearchRow& search : CompareSearches(surface, move)) {
      expected += ToText(search);
      ++searches;
    }
    report.WriteGraphs(surface);
  }
  EXPECT_EQ(out.str(), expected);
  EXPECT_EQ(searches, 3U) << "three ways to the rift of the step, and none on a plane";

  const nlohmann::ordered_json json = report.ToJson();
  ASSERT_EQ(json["rows"].size(), 2U);
  EXPECT_EQ(json["rows"][0]["searches"].size(), 3U);
  EXPECT_FALSE(json["rows"][1].contains("searches"));
  for (const char* const file : {"edges-00.png", "rifts-00.png", "trajectory-00.png", "edges-01.png",
                                 "rifts-01.png", "trajectory-01.png", "graph.ply", "surface.ply"}) {
    EXPECT_TRUE(fs::exists(folder / file)) << file;
  }
  EXPECT_FALSE(fs::exists(folder / "edges-07.png"));
  EXPECT_FALSE(fs::exists(folder / "rifts-100.png"));
  EXPECT_TRUE(fs::exists(folder / "edges-of-mine.png"));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace thalweg::surface
