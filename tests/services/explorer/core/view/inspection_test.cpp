#include "services/explorer/core/view/inspection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include "tests/services/explorer/support/inspected_scene.h"

namespace thalweg::explorer {
namespace {

class InspectionViewsTest : public testing::TestWithParam<unsigned> {
 protected:
  test::InspectedScene scene_{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Seeds, InspectionViewsTest, testing::Range(1U, 7U));

TEST_P(InspectionViewsTest, OneReachedVoxelOfEachCubeIsAPlaceAndNoneIsNearerToItsMiddle) {
  using Cube = std::tuple<int, int, int>;
  const auto cube_of = [](const VoxelIndex& i) { return Cube{i.x >> 2, i.y >> 2, i.z >> 2}; };
  const auto off = [](const VoxelIndex& i) {
    const Eigen::Vector3d middle(4 * (i.x >> 2) + 1.5, 4 * (i.y >> 2) + 1.5, 4 * (i.z >> 2) + 1.5);
    return (Eigen::Vector3d(i.x, i.y, i.z) - middle).squaredNorm();
  };
  std::map<Cube, double> least;
  test::ForEachVoxel(scene_.map.box(), [&](const VoxelIndex& i) {
    if (!scene_.search.Reached(i)) return;
    const auto known = least.try_emplace(cube_of(i), off(i)).first;
    known->second = std::min(known->second, off(i));
  });
  const std::vector<VoxelIndex> places = PlacesToLook(scene_.search);
  EXPECT_EQ(places.size(), least.size());
  std::set<Cube> cubes;
  for (const VoxelIndex& place : places) {
    EXPECT_TRUE(scene_.search.Reached(place));
    EXPECT_TRUE(cubes.insert(cube_of(place)).second) << "each cube has one";
    EXPECT_EQ(off(place), least.at(cube_of(place)));
  }
}

TEST_P(InspectionViewsTest, AViewIsTheBestOfAllAndInspectsWhatItPromises) {
  int views = 0;
  for (const VoxelIndex& place : PlacesToLook(scene_.search)) {
    if (++views % 7 != 0) continue;  // a sample
    const InspectionViews all = scene_.Views();
    const auto view = all.Best(place, Eigen::Matrix3d::Identity(), 1);
    // By brute force: the open facets that each orientation shows, of those that can be inspected.
    std::size_t most = 0;
    for (const Eigen::Matrix3d& R_WB : scene_.views.candidates()) {
      std::size_t shown = 0;
      for (const Facet& facet : scene_.surface.OpenFacets(scene_.map)) {
        const Eigen::Vector3d eye_W = scene_.map.CenterOf(place);
        if (scene_.surface.InspectableFrom(scene_.map, eye_W, facet) &&
            scene_.views.Shows(R_WB, {facet.voxel, CenterOf(scene_.map, facet) - eye_W}))
          ++shown;
      }
      most = std::max(most, shown);
    }
    ASSERT_EQ(view.has_value(), most > 0);
    if (!view) continue;
    EXPECT_EQ(view->facets.size(), most);
    EXPECT_EQ(view->place, place);
    EXPECT_FALSE(all.Best(place, Eigen::Matrix3d::Identity(), most + 1)) << "that is not enough";
    for (const Facet& facet : view->facets) EXPECT_TRUE(all.CanInspect(place, facet));
    scene_.Take(*view);
    EXPECT_TRUE(std::ranges::none_of(
        view->facets, [&](const Facet& facet) { return scene_.surface.Open(scene_.map, facet); }));
  }
  EXPECT_GT(views, 7);
}

TEST(NearIndex, HasAllThatIsNear) {
  std::mt19937 random(1);
  const VoxelBox box{{-20, -20, -20}, {20, 20, 20}};
  std::vector<VoxelIndex> at;
  NearIndex index(5);
  for (std::size_t n = 0; n < 500; ++n) {
    at.push_back(test::RandomVoxel(random, box));
    index.Add(at.back(), n);
  }
  for (int k = 0; k < 50; ++k) {
    const VoxelIndex here = test::RandomVoxel(random, box);
    const std::vector<std::size_t> numbers = index.Near(here);
    const std::set<std::size_t> found(numbers.begin(), numbers.end());
    EXPECT_EQ(found.size(), numbers.size()) << "each once";
    EXPECT_LT(numbers.size(), at.size()) << "not simply all";
    for (std::size_t n = 0; n < at.size(); ++n) {
      const VoxelIndex d = at[n] - here;
      const bool is_near = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) <= 5;
      EXPECT_TRUE(!is_near || found.contains(n));
    }
  }
}

}  // namespace
}  // namespace thalweg::explorer
