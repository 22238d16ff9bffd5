#include "services/mapper/adapter/options.h"

#include <gtest/gtest.h>

namespace thalweg::mapper {
namespace {

TEST(MapperOptions, CloudsThatAreMissingAreCountedUnlessStereoMayLeaveThemOut) {
  Scenario scenario;
  EXPECT_TRUE(OptionsFrom(scenario, "x").counts_gaps);
  scenario.set_depth_source(DepthSource::EXTERNAL);
  EXPECT_TRUE(OptionsFrom(scenario, "x").counts_gaps);
  scenario.set_depth_source(DepthSource::STEREO);
  EXPECT_FALSE(OptionsFrom(scenario, "x").counts_gaps);
}

TEST(MapperOptions, ASensorThatReportsWhereNothingIsClearsNoFartherThanItsRange) {
  Scenario scenario;
  EXPECT_FALSE(OptionsFrom(scenario, "x").map.no_return);
  scenario.mutable_depth_sensor()->set_max_range_m(1.5);
  scenario.mutable_depth_sensor()->set_width_px(64);
  EXPECT_EQ(OptionsFrom(scenario, "x").map.max_range, OccupancyMap::Options().max_range);
  scenario.mutable_depth_sensor()->set_no_return_is_free(true);
  const OccupancyMap::Options options = OptionsFrom(scenario, "x").map;
  EXPECT_EQ(options.max_range, 1.5);
  ASSERT_TRUE(options.no_return);
  EXPECT_EQ(options.no_return->width_px, 64);
  scenario.mutable_depth_sensor()->set_max_range_m(50.0);
  EXPECT_EQ(OptionsFrom(scenario, "x").map.max_range, OccupancyMap::Options().max_range);
}

TEST(MapperOptions, ComeFromTheScenarioAndElseFromTheCore) {
  Scenario scenario;
  const OccupancyMap::Options core;
  EXPECT_EQ(OptionsFrom(scenario, "x").map.voxel_size, core.voxel_size);
  EXPECT_EQ(OptionsFrom(scenario, "x").out, "x");
  scenario.mutable_mapper()->set_voxel_size_m(0.07);
  scenario.mutable_mapper()->set_max_range_m(3.0);
  scenario.mutable_mapper()->set_fill(true);
  scenario.mutable_mapper()->set_protect(true);
  scenario.mutable_mapper()->set_checkpoint_period_s(0.0);
  scenario.mutable_mapper()->set_log_odds_hit(0.7);
  scenario.mutable_mapper()->mutable_filter()->set_type(Mapper::Filter::OUTLIER);
  scenario.mutable_mapper()->mutable_filter()->set_neighbors(12);
  const MapperOptions options = OptionsFrom(scenario, "x");
  EXPECT_EQ(options.map.voxel_size, 0.07);
  EXPECT_EQ(options.map.max_range, 3.0);
  EXPECT_TRUE(options.map.fill);
  EXPECT_TRUE(options.map.protect);
  EXPECT_EQ(options.map.log_odds_hit, 0.7F);
  EXPECT_EQ(options.checkpoint_period, Duration::zero());
  EXPECT_EQ(options.filter.type, FilterModel::Type::kOutlier);
  EXPECT_EQ(options.filter.neighbors, 12);
  EXPECT_EQ(options.filter.deviations, FilterModel().deviations);
}

}  // namespace
}  // namespace thalweg::mapper
