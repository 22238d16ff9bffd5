#include "services/cli/report/report_json.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/services/cli/report/example_run.h"

namespace thalweg::cli {
namespace {

using test::ARun;

TEST(ReportJson, HasEveryKeyAndItsValue) {
  const auto json = ToJson(ARun());
  for (const char* key : {"scenario",        "strategy",
                          "outcome",         "succeeded",
                          "stop_reason",     "stop_details",
                          "distance_m",      "duration_s",
                          "wall_s",          "explored_m3",
                          "free_m3",         "occupied_m3",
                          "true_collisions", "least_clearance_m",
                          "agreement",       "coverage",
                          "coverage_over",   "frontiers_set_aside",
                          "frontiers_left",  "plans",
                          "replans",         "planning",
                          "integration",     "messages_rejected",
                          "messages_dropped"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["outcome"], "complete");
  EXPECT_EQ(json["succeeded"], true);
  EXPECT_EQ(json["explored_m3"], 48.0);
  EXPECT_EQ(json["messages_rejected"]["total"], 3);
  EXPECT_EQ(json["messages_dropped"]["total"], 0);
  EXPECT_EQ(json["frontiers_set_aside"][0]["voxels"], 41);
  EXPECT_EQ(json["planning"][0]["p95_ms"], 60.5);
  EXPECT_EQ(json["stop_details"], "1 m2 of frontier stayed unknown");
  EXPECT_EQ(json["coverage_over"].size(), 241U);
  EXPECT_EQ(nlohmann::json::parse(json.dump())["stop_reason"], "complete");
}

TEST(ReportJson, WhatIsNotKnownIsNull) {
  RunRecord record = ARun();
  record.true_collisions.reset();
  record.agreement.reset();
  record.least_clearance = std::nan("");
  record.progress.front().coverage.reset();
  record.outcome.reset();
  const auto json = ToJson(record);
  EXPECT_TRUE(json["outcome"].is_null());
  EXPECT_TRUE(json["true_collisions"].is_null());
  EXPECT_TRUE(json["agreement"].is_null());
  EXPECT_TRUE(json["least_clearance_m"].is_null());
  EXPECT_TRUE(json["coverage_over"][0]["coverage"].is_null());
}

}  // namespace
}  // namespace thalweg::cli
