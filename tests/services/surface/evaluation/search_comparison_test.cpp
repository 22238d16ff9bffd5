#include "services/surface/evaluation/search_comparison.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

namespace thalweg::surface {
namespace {

TEST(SearchGrids, AStarIsAsShortAsDijkstraAndLooksAtLess) {
  const std::vector<GridSearch> searches = SearchGrids();
  ASSERT_EQ(searches.size(), 6U);
  for (const std::size_t first : {0U, 3U}) {
    const FoundPath& dijkstra = searches[first].found;
    const FoundPath& best_first = searches[first + 1].found;
    const FoundPath& a_star = searches[first + 2].found;
    EXPECT_EQ(a_star.length, dijkstra.length);
    EXPECT_LT(a_star.looked_at.size(), dijkstra.looked_at.size());
    EXPECT_GE(best_first.length, dijkstra.length);
  }
  EXPECT_EQ(searches[0].found.length, 36.0) << "30 to the right and 6 down";
  EXPECT_EQ(searches[1].found.looked_at.size(), 37U);
}

TEST(SearchGrids, PathsStepFromFreePlaceToFreePlace) {
  for (const GridSearch& search : SearchGrids()) {
    ASSERT_FALSE(search.found.vertices.empty());
    for (std::size_t i = 0; i < search.found.vertices.size(); ++i) {
      const std::size_t place = search.place_of[search.found.vertices[i]];
      EXPECT_TRUE(search.is_free[place]);
      if (i == 0) continue;
      const std::size_t before = search.place_of[search.found.vertices[i - 1]];
      const auto side = static_cast<std::size_t>(search.side);
      const int steps = std::abs(static_cast<int>(place % side) - static_cast<int>(before % side)) +
                        std::abs(static_cast<int>(place / side) - static_cast<int>(before / side));
      EXPECT_EQ(steps, 1);
    }
  }
}

TEST(SearchGrids, AreDrawnAPanelEach) {
  const std::vector<GridSearch> searches = SearchGrids();
  const cv::Mat picture = Draw(searches);
  EXPECT_GT(picture.cols, 3 * searches[0].side);
  EXPECT_GT(picture.rows, 2 * searches[0].side);
  std::set<int> dark;  // rows with an obstacle: only in the lower half
  for (int v = 0; v < picture.rows; ++v) {
    for (int u = 0; u < picture.cols; ++u) {
      if (picture.at<cv::Vec3b>(v, u) == cv::Vec3b(60, 60, 60)) dark.insert(v);
    }
  }
  ASSERT_FALSE(dark.empty());
  EXPECT_GT(*dark.begin(), picture.rows / 2);
}

}  // namespace
}  // namespace thalweg::surface
