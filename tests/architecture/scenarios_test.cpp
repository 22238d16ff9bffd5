#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/scenario/mistakes.h"
#include "common/scenario/scenario.h"
#include "services/explorer/adapter/options.h"
#include "services/mapper/core/occupancy_map.h"
#include "tests/support/places.h"

namespace thalweg {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> ShippedScenarios() {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(fs::path(test::SourceFolder()) / "deploy" / "scenarios")) {
    if (entry.path().extension() == ".txtpb") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string TextOf(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

class ShippedScenario : public testing::TestWithParam<std::string> {};

TEST_P(ShippedScenario, Loads) {
  if (TextOf(GetParam()).find("${THALWEG_DATA}/") != std::string::npos &&
      std::getenv("THALWEG_DATA") == nullptr) {
    GTEST_SKIP() << "set THALWEG_DATA to the folder of the scenes that are not part of this repository";
  }
  EXPECT_NO_THROW(LoadScenario(GetParam(), {}, {.mistakes = explorer::MistakesIn}));
}

std::string NameOf(const testing::TestParamInfo<std::string>& scenario) {
  std::string name = fs::path(scenario.param).stem().string();
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Deploy, ShippedScenario, testing::ValuesIn(ShippedScenarios()), NameOf);

TEST(ShippedScenarios, AreFoundByName) {
  for (const std::string& file : ShippedScenarios()) {
    EXPECT_TRUE(fs::is_regular_file(ScenarioFolder() / fs::path(file).filename())) << file;
  }
  EXPECT_FALSE(ShippedScenarios().empty());
}

TEST(Scenario, AllowsTheVoxelsWithinRangeThatTheMapperAllows) {
  Scenario scenario;
  scenario.mutable_mapper()->set_voxel_size_m(0.01);
  for (const int voxels : {kMostVoxelsOfRange, kMostVoxelsOfRange + 1}) {
    const double range = 0.01 * voxels;
    scenario.mutable_mapper()->set_max_range_m(range);
    if (voxels == kMostVoxelsOfRange) {
      EXPECT_NO_THROW(CheckScenario(scenario));
      EXPECT_NO_THROW(mapper::OccupancyMap({.voxel_size = 0.01, .max_range = range}));
    } else {
      EXPECT_THROW(CheckScenario(scenario), std::invalid_argument);
      EXPECT_THROW(mapper::OccupancyMap({.voxel_size = 0.01, .max_range = range}), std::invalid_argument);
    }
  }
}

}  // namespace
}  // namespace thalweg
