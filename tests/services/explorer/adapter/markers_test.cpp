#include "services/explorer/adapter/markers.h"

#include <gtest/gtest.h>

namespace thalweg::explorer {
namespace {

thalweg_msgs::msg::FrontierList ListOf(const std::vector<thalweg_msgs::msg::FrontierFate>& fates) {
  thalweg_msgs::msg::FrontierList list;
  list.header().frame_id("map");
  for (const auto fate : fates) {
    thalweg_msgs::msg::Frontier frontier;
    frontier.center().x(static_cast<double>(list.frontiers().size()));
    frontier.voxels(100);
    frontier.fate(fate);
    if (fate == thalweg_msgs::msg::FRONTIER_SET_ASIDE) {
      frontier.reason(thalweg_msgs::msg::ASIDE_OUT_OF_SIGHT);
      frontier.doubtful(true);
    }
    list.frontiers().push_back(frontier);
  }
  return list;
}

TEST(Markers, ASphereStandsAtEachFrontierAndAReasonAboveThoseSetAside) {
  using namespace thalweg_msgs::msg;
  const auto markers = MarkersOf(ListOf({FRONTIER_LEFT, FRONTIER_CHOSEN, FRONTIER_SET_ASIDE})).markers();
  ASSERT_EQ(markers.size(), 5U);
  EXPECT_EQ(markers[0].action(), 3) << "those of the plan before are deleted first";
  for (std::size_t k = 1; k <= 3; ++k) {
    EXPECT_EQ(markers[k].type(), 2) << "sphere";
    EXPECT_EQ(markers[k].header().frame_id(), "map");
    EXPECT_EQ(markers[k].pose().position().x(), static_cast<double>(k - 1));
    EXPECT_EQ(markers[k].pose().orientation().w(), 1.0);
    EXPECT_GT(markers[k].scale().x(), 0.0);
    EXPECT_GT(markers[k].color().a(), 0.0F) << "else it is invisible";
  }
  EXPECT_GT(markers[2].color().g(), markers[2].color().b()) << "the chosen one is green";
  EXPECT_EQ(markers[4].text(), "doubtful: seen from no reachable place");
  EXPECT_GT(markers[4].pose().position().z(), markers[3].pose().position().z());
}

TEST(Markers, OfNoFrontierDeleteThoseBefore) {
  const auto markers = MarkersOf(ListOf({})).markers();
  ASSERT_EQ(markers.size(), 1U);
  EXPECT_EQ(markers[0].action(), 3);
}

}  // namespace
}  // namespace thalweg::explorer
