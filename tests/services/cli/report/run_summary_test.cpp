#include "services/cli/report/run_summary.h"

#include <gtest/gtest.h>

namespace thalweg::cli {
namespace {

TEST(RunSummary, SaysHowFarHowLongAndWhatIsKnown) {
  RunRecord record;
  record.stop_reason = "complete";
  record.distance = 12.34;
  record.duration = 83.0;
  record.wall = 21.0;
  record.free_volume = 40.0;
  record.occupied_volume = 5.6;
  EXPECT_EQ(SummaryText(record, true),
            "complete: 12.3 m in 1:23 simulated, 0:21 wall clock; 45.6 m3 explored");
  EXPECT_EQ(SummaryText(record, false), "complete: 12.3 m in 1:23, 0:21 wall clock; 45.6 m3 explored");
}

TEST(RunSummary, ComparesWithTheTruthWhereThatIsKnown) {
  RunRecord record;
  record.stop_reason = "interrupted";
  record.coverage = 0.99;
  EXPECT_EQ(SummaryText(record, false).find("coverage"), std::string::npos) << "without an agreement";
  record.agreement = 0.975;
  record.true_collisions = 2;
  EXPECT_TRUE(SummaryText(record, false).ends_with("; coverage 99.0 %, agreement 97.5 %; 2 collisions"));
}

TEST(RunSummary, ReportsOfCloudsThatAreMissingInTheMap) {
  RunRecord record;
  EXPECT_EQ(SummaryText(record, false).find("cloud"), std::string::npos);
  record.clouds_not_mapped = 3;
  record.clouds_not_mapped_why = "lost on the way";
  EXPECT_TRUE(SummaryText(record, false).ends_with("; 3 clouds not mapped (lost on the way)"));
}

TEST(RunSummary, SaysHowMuchOfTheSurfaceWasSeenAndWhatIsMissingInIt) {
  RunRecord record;
  EXPECT_EQ(SummaryText(record, false).find("surface"), std::string::npos) << "nobody fuses it";
  record.surface = {
      .seen = 249.56, .inspected = 51.8, .observable = {}, .clouds_not_fused = 0, .clouds_not_fused_why = ""};
  EXPECT_TRUE(SummaryText(record, false).ends_with("; 249.6 m2 of surface seen, 51.8 m2 of it inspected"));
  record.surface->observable = 260.04;
  EXPECT_TRUE(SummaryText(record, false)
                  .ends_with("; 249.6 m2 of surface seen of 260.0 m2 that can be, 51.8 m2 of it inspected"));
  record.surface->clouds_not_fused = 679;
  record.surface->clouds_not_fused_why = "clouds come faster than they are fused";
  EXPECT_TRUE(SummaryText(record, false)
                  .ends_with("; 679 clouds not in the surface (clouds come faster than they are fused)"));
}

}  // namespace
}  // namespace thalweg::cli
