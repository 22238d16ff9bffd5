// `thalweg surface` as typed by a user.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/outcome.h"
#include "tests/support/places.h"

namespace thalweg::cli {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::HasSubstr;

class SurfaceCommand : public testing::Test {
 protected:
  SurfaceCommand() { fs::create_directories(folder_); }
  ~SurfaceCommand() override { fs::remove_all(folder_); }

  Outcome Surface(const std::string& arguments) const {
    return test::OutcomeOf("cd '" + folder_.string() + "' && " + test::BinFolder() + "/thalweg surface " +
                           arguments);
  }

  fs::path folder_ = fs::temp_directory_path() / ("surface_command_" + std::to_string(getpid()));
};

TEST_F(SurfaceCommand, ExploresASimulatedRoomByItsRiftsAndLeavesPicturesAndPly) {
  const Outcome outcome = Surface(
      "--scenario tiny --set stereo_camera.width_px=160 --set stereo_camera.height_px=120 --exact "
      "--height-m 0.5 --views-per-move 3 --out out --json table.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("first view"));
  EXPECT_THAT(outcome.text, HasSubstr("move 1"));
  const nlohmann::json rows = nlohmann::json::parse(std::ifstream(folder_ / "table.json"))["rows"];
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0]["raw_points"], 160 * 120);
  EXPECT_EQ(rows[0]["edges"], 2 * 160 * 120 - 160 - 120);
  EXPECT_GT(rows[0]["rifts"], 0);
  EXPECT_GT(rows[1]["area_m2"], rows[0]["area_m2"]);
  EXPECT_NEAR(rows[0]["searches"][0]["length_m"], rows[0]["searches"][2]["length_m"], 1e-6);
  for (const char* const file :
       {"edges-00.png", "rifts-01.png", "trajectory-00.png", "graph.ply", "surface.ply"}) {
    EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
  }
}

TEST_F(SurfaceCommand, ExploresFromSeveralStartsAndComparesWithTheTruth) {
  const Outcome outcome = Surface(
      "--scenario tiny --set stereo_camera.width_px=160 --set stereo_camera.height_px=120 --exact "
      "--height-m 0.3 --moves 1 --starts 2 --json runs.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const nlohmann::json runs = nlohmann::json::parse(std::ifstream(folder_ / "runs.json"));
  ASSERT_EQ(runs.size(), 2U);
  for (const nlohmann::json& run : runs) {
    EXPECT_THAT(outcome.text, HasSubstr(run["end"].get<std::string>() + '\n'));
    EXPECT_GT(run["seen"], 0.0);
  }
  EXPECT_THAT(outcome.text, HasSubstr("seen, inspected: share of the observable surface"));
  EXPECT_FALSE(fs::exists(folder_ / "surface")) << "it leaves no pictures";
}

TEST_F(SurfaceCommand, MistakesAreNamedBeforeAnythingIsDone) {
  EXPECT_THAT(Surface("").text, HasSubstr("FOLDER, --scenario or --searches"));
  EXPECT_EQ(Surface("").exit_code, 2);
  EXPECT_THAT(Surface("nowhere").text, HasSubstr("nowhere: is not a folder"));
  for (const char* const option : {"--height-m", "--rift-edge-m", "--merge-distance-m"}) {
    for (const char* const value : {"-1", "0", "1e300", "nan"}) {
      const Outcome outcome = Surface("--scenario tiny " + std::string(option) + " " + value);
      EXPECT_EQ(outcome.exit_code, 2);
      EXPECT_THAT(outcome.text, HasSubstr(std::string(option) + ": is " + value + ", must be above 0"));
    }
  }
  EXPECT_THAT(Surface("--scenario tiny --seen-through 1").text, HasSubstr("--seen-through: is 1, must be"));
  EXPECT_THAT(Surface("--scenario tiny --views-per-move 0").text,
              HasSubstr("--views-per-move: Value 0 not in"));
  EXPECT_THAT(Surface("--scenario flat_doors --starts 1").text,
              HasSubstr("--starts needs a world that stays as it is"));
  EXPECT_THAT(Surface("--scenario nowhere").text, HasSubstr("nowhere"));
  EXPECT_EQ(Surface("nowhere --scenario tiny").exit_code, 2);
  for (const char* const views : {"''", "-1", "0,-1", "1.5"})
    EXPECT_THAT(Surface("nowhere --views " + std::string(views)).text,
                HasSubstr("is not a number of a view"));
  EXPECT_EQ(Surface("--searches --height-m 1").exit_code, 2);
  EXPECT_EQ(Surface("--scenario tiny --starts 1 --out there").exit_code, 2);
}

TEST_F(SurfaceCommand, ComparesTheSearches) {
  const Outcome outcome = Surface("--searches --out out");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("A*         no obstacle"));
  EXPECT_TRUE(fs::exists(folder_ / "out" / "searches.png"));
  EXPECT_FALSE(fs::exists(folder_ / "out" / "graph.ply"));
}

}  // namespace
}  // namespace thalweg::cli
