#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "common/dds/map_replica.h"
#include "common/voxel/for_each_voxel.h"
#include "tests/system/run_fixture.h"

namespace thalweg::test {
namespace {

/// The map as it grows, and what it held and holds of where things stood at first.
class ChangingWorld : public RunSystemTest {
 protected:
  ChangingWorld() {
    bus_.Subscribe<dds::topics::MapUpdates>([this](const thalweg_msgs::msg::MapUpdate& update) {
      EXPECT_TRUE(replica_.Apply(update));
      if (replica_.missing()) requests_.Write(replica_.MakeRequest(bus_.Now(), "test"));
      if (replica_.missing() || !replica_.has_map()) return;
      for (Place* const place : {&door_, &chair_}) {
        ForEachVoxel(place->voxels, [&](const VoxelIndex& i) {
          const VoxelState state = replica_.grid().State(i);
          if (state == VoxelState::kOccupied) place->stood.insert(Key(i));
          if (state == VoxelState::kFree && place->stood.contains(Key(i))) place->forgotten.insert(Key(i));
        });
      }
    });
  }

  /// Voxels that something fills at first and leaves later.
  struct Place {
    VoxelBox voxels;
    std::set<std::tuple<int, int, int>> stood = {};      ///< Those that were occupied at any time.
    std::set<std::tuple<int, int, int>> forgotten = {};  ///< Those of them that were free later.
  };
  static std::tuple<int, int, int> Key(const VoxelIndex& i) { return {i.x, i.y, i.z}; }

  dds::Bus::Publisher<dds::topics::MapRequests> requests_ = bus_.Advertise<dds::topics::MapRequests>();
  dds::MapReplica replica_;
  /// In flat_doors: the shut door from x = 2.5 to 3.48 and y = 4.1 to 4.14, and the chair's first place, from
  /// x = 2.8 to 3.25 and y = 1.3 to 1.75.
  Place door_{.voxels = {{26, 41, 4}, {34, 42, 18}}};
  Place chair_{.voxels = {{28, 13, 2}, {33, 18, 9}}};
};

TEST_F(ChangingWorld, IsExploredWithoutACollisionAndTheMapForgetsWhereAChairStood) {
  StartScenario("flat_doors");
  ASSERT_TRUE(bus_.SpinUntil([this] { return run_->ended(); }, std::chrono::seconds(240))) << Printed();
  ExpectComplete(0.5);  // of a flat half of which may be shut off when nothing else is left to see
  EXPECT_GE(chair_.stood.size(), 20U);
  EXPECT_GE(chair_.forgotten.size(), 10U);
  const auto free_at_last = std::ranges::count_if(chair_.forgotten, [this](const auto& key) {
    const auto [x, y, z] = key;
    return replica_.grid().State({x, y, z}) == VoxelState::kFree;
  });
  EXPECT_GE(free_at_last, 10) << "the chair does not return, and neither does its image";
}

TEST_F(ChangingWorld, ADoorThatShutsBeforeTheRobotsEyesAppearsInTheMapAndIsForgottenWhenItOpens) {
  StartScenario("flat_doors",
                {"--without", "explorer", "--set", "simulator.start_position_m={x: 2.9 y: 2.9 z: 1.2}",
                 "--set", "simulator.start_yaw_deg=90"});
  ASSERT_TRUE(Until([this] { return door_.stood.size() >= 60; })) << Printed();
  EXPECT_TRUE(Until([this] { return door_.forgotten.size() >= 60; })) << Printed();
}

}  // namespace
}  // namespace thalweg::test
