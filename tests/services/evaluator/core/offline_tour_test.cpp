#include "services/evaluator/core/offline_tour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "services/mapper/core/occupancy_map.h"
#include "services/simulator/core/depth_sensor.h"
#include "tests/support/meshes.h"

namespace thalweg::evaluator {
namespace {

using Box = Eigen::AlignedBox3d;
using Point = Eigen::Vector3d;

/// A low room with two walls, open at opposite ends, between which the path winds.
test::AnalyticRoom WindingRoom() {
  return {Box(Point(0.03, 0.04, 0.05), Point(3.03, 2.04, 0.85)),
          {Box(Point(1.03, 0.04, 0.05), Point(1.12, 1.41, 0.85)),
           Box(Point(1.93, 0.62, 0.05), Point(2.04, 2.04, 0.85))}};
}

struct Place {
  Place()
      : world(test::MeshOf(room), room.walls),
        truth(std::make_shared<const simulator::TrueMap>(world, start_W, of_truth)) {}
  TourGround Ground(const TourGround::Options& options) const {
    return {world, truth, of_truth, start_W, options};
  }

  test::AnalyticRoom room = WindingRoom();
  simulator::World world;
  Point start_W{0.35, 0.35, 0.45};
  simulator::TrueMap::Options of_truth{.voxel_size = 0.1, .robot = {.radius = 0.1}, .view_range = 1.2};
  std::shared_ptr<const simulator::TrueMap> truth;
};

/// The least length of a walk from the start over the ground's places that sees a share of all observable
/// voxels: the best order of each subset [Held, Karp 1962], with all voxels and no sample.
class BruteForce {
 public:
  BruteForce(const Place& place, const TourGround& ground)
      : lattice_(ground.lattice()),
        sight_(place.world, *place.truth, place.start_W, place.of_truth),
        count_(std::size_t{1} << lattice_.places.size(), 0) {
    for (std::size_t n = 0; n < sight_.voxels().size(); ++n) {
      std::size_t seers = 0;
      for (std::size_t p = 0; p < lattice_.places.size(); ++p) {
        const Point p_W = VoxelCenter(lattice_.places[p], place.of_truth.voxel_size);
        if (sight_.Sees(p_W, n)) seers |= std::size_t{1} << p;
      }
      for (std::size_t subset = 0; subset < count_.size(); ++subset) count_[subset] += (subset & seers) != 0;
    }
  }

  double LeastLength(std::size_t start, double share) const {
    constexpr double kUnreached = std::numeric_limits<double>::infinity();
    const std::size_t places = lattice_.places.size();
    ShortestPaths paths(lattice_.graph);
    std::vector<double> least(count_.size() * places, kUnreached);  // by subset and last place
    least[(std::size_t{1} << start) * places + start] = 0.0;
    double best = kUnreached;
    for (std::size_t subset = 0; subset < count_.size(); ++subset) {
      for (std::size_t last = 0; last < places; ++last) {
        const double length = least[subset * places + last];
        if (length == kUnreached) continue;
        if (static_cast<double>(count_[subset]) >=
            share * static_cast<double>(sight_.voxels().size()) - 1e-9) {
          best = std::min(best, length);
        }
        for (std::size_t next = 0; next < places; ++next) {
          const std::size_t more = subset | std::size_t{1} << next;
          if (more == subset) continue;
          double& known = least[more * places + next];
          known = std::min(known, length + paths.Length(last, next));
        }
      }
    }
    return best;
  }

 private:
  ViewLattice lattice_;
  simulator::VoxelSight sight_;
  std::vector<std::size_t> count_;  ///< Voxels seen from each subset of the places.
};

TEST(OfflineTour, InATinyWorldIsAsShortAsTheBestOfAllWalksOverItsPlaces) {
  const Place place;
  const TourGround ground = place.Ground({.clearance = 0.15, .spacing = 1.0, .iterations = 60});
  const std::size_t places = ground.lattice().places.size();
  ASSERT_GE(places, 6U);
  ASSERT_LE(places, 16U) << "for all subsets";
  const BruteForce brute(place, ground);
  // From the center of a place, so that the start adds none.
  for (const std::size_t start : {std::size_t{0}, places / 2}) {
    const Point start_W = VoxelCenter(ground.lattice().places[start], 0.1);
    const OfflineTours tours = ground.ToursFrom(start_W);
    EXPECT_FALSE(tours.out_of_time);
    EXPECT_EQ(tours.places, places);
    std::size_t found = 0;
    for (std::size_t k = 0; k < kTourCoverages.size(); ++k) {
      const double least = brute.LeastLength(start, kTourCoverages.at(k));
      EXPECT_EQ(tours.to.at(k).length.has_value(), std::isfinite(least));
      if (!tours.to.at(k).length) continue;
      ++found;
      EXPECT_NEAR(*tours.to.at(k).length, least, 2e-3) << kTourCoverages.at(k);
      EXPECT_GE(tours.to.at(k).coverage, kTourCoverages.at(k));
    }
    EXPECT_GE(found, 1U);
  }
}

TEST(OfflineTour, ASampleOfTheVoxelsLeadsToToursThatSeeEnoughOfAll) {
  const Place place;
  const TourGround all = place.Ground({.spacing = 0.3, .iterations = 60});
  const TourGround some = place.Ground({.spacing = 0.3, .max_samples = 700, .iterations = 60});
  EXPECT_EQ(all.samples(), place.truth->observable_count());
  EXPECT_EQ(some.samples(), 700U);
  const OfflineTours by_all = all.ToursFrom(place.start_W);
  const OfflineTours by_some = some.ToursFrom(place.start_W);
  for (std::size_t k = 0; k < kTourCoverages.size(); ++k) {
    ASSERT_TRUE(by_all.to.at(k).length);
    ASSERT_TRUE(by_some.to.at(k).length);
    EXPECT_GE(by_some.to.at(k).coverage, kTourCoverages.at(k));
    EXPECT_LT(*by_some.to.at(k).length, 1.3 * *by_all.to.at(k).length);
  }
}

TEST(OfflineTour, IsTheSameForTheSameOptionsAndNoLongerTheLessThereIsToSee) {
  const Place place;
  const TourGround ground = place.Ground({.spacing = 0.3, .iterations = 40});
  const OfflineTours tours = ground.ToursFrom(place.start_W);
  EXPECT_EQ(ground.ToursFrom(place.start_W), tours);
  EXPECT_EQ(place.Ground({.spacing = 0.3, .iterations = 40}).ToursFrom(place.start_W), tours);
  EXPECT_LE(*tours.to[0].length, *tours.to[1].length);
  EXPECT_LE(*tours.to[1].length, *tours.to[2].length);
  EXPECT_LE(*tours.to[2].length, *tours.to[3].length);
  EXPECT_GT(*tours.to[3].length, 1.5) << "no place sees past both walls";
  EXPECT_EQ(tours.to[3].path_W.front(), place.start_W);
}

/// What the mapper knows after spheres of images at the tour's places, of what is observable.
TEST(OfflineTour, OurMapperKnowsThatMuchAfterLookingAllAroundAtItsPlaces) {
  const Place place;
  const OfflineTours tours = place.Ground({.spacing = 0.3, .iterations = 40}).ToursFrom(place.start_W);
  DepthSensorModel model;
  model.camera = PinholeCamera::FromFieldOfView(160, 160, 0.5 * std::numbers::pi);
  model.max_range = 8.0;  // walls farther away than what is mapped show that the line to there is free
  simulator::DepthSensor sensor(model, 1, /*colors=*/false);
  for (const OfflineTour& tour : tours.to) {
    mapper::OccupancyMap map({.voxel_size = 0.1, .max_range = place.of_truth.view_range});
    for (std::size_t n = 1; n < tour.path_W.size(); ++n) {
      for (int side = 0; side < 6; ++side) {
        const double yaw = side < 4 ? 0.5 * std::numbers::pi * side : 0.0;
        const double pitch = side < 4 ? 0.0 : (side == 4 ? 0.5 : -0.5) * std::numbers::pi;
        const RigidTransform T_WC =
            MakeTransform(RotationFromYawPitch(yaw, pitch) * BodyFromOptical(), tour.path_W[n]);
        map.Integrate(sensor.Capture(place.world, T_WC), T_WC);
      }
    }
    EXPECT_GE(place.truth->Compare(map.grid()).coverage(), tour.coverage - 0.01);
  }
}

TEST(OfflineTour, EndsWhenItsBudgetIsUsedUpAndSaysSo) {
  const Place place;
  const TourGround ground = place.Ground({.spacing = 0.3, .iterations = 1'000'000, .budget = 4.0});
  int asked = 0;
  const auto elapsed = [&] { return 0.1 * ++asked; };  // as if each iteration took 0.1 s
  const OfflineTours tours = ground.ToursFrom(place.start_W, {}, elapsed);
  EXPECT_TRUE(tours.out_of_time);
  EXPECT_GE(tours.iterations, 25);
  EXPECT_LE(tours.iterations, 40);
  EXPECT_TRUE(tours.to[3].length) << "the first tour that sees enough";
}

TEST(OfflineTour, NeedsRoomForItsClearanceAtTheStart) {
  const Place place;
  EXPECT_TRUE(TourGround::Fits(place.world, place.of_truth.robot, place.start_W, 0.15));
  EXPECT_FALSE(TourGround::Fits(place.world, place.of_truth.robot, {0.15, 0.5, 0.45}, 0.15));
  EXPECT_TRUE(place.Ground({.spacing = 0.8}).HoldsFor({2.7, 1.0, 0.45}));
  EXPECT_FALSE(place.Ground({.spacing = 0.8}).HoldsFor({0.12, 0.5, 0.45}));
}

}  // namespace
}  // namespace thalweg::evaluator
