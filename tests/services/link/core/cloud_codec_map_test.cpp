#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "common/scenario/models.h"
#include "common/scenario/scenario.h"
#include "services/link/core/cloud_codec.h"
#include "services/mapper/core/occupancy_map.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/core/depth_sensor.h"
#include "services/simulator/tools/flight.h"

// What a coded cloud costs, and what it does to the map: the simulator's sensor on a flight through the
// kitchen, once as it measures and once as the other side of a link receives it.

namespace thalweg::link {
namespace {

TEST(CloudCodec, TheMapOfTheKitchenFromCodedCloudsIsThatFromTheCloudsThemselves) {
  const Scenario scenario = LoadScenario("kitchen");
  const simulator::World world = simulator::LoadWorld(scenario);
  DepthSensorModel model = DepthSensorFrom(scenario);
  const mapper::OccupancyMap::Options options{.voxel_size = MapFrom(scenario).voxel_size,
                                              .max_range = MapFrom(scenario).max_range};
  simulator::DepthSensor sensor(model, 1, false);
  mapper::OccupancyMap raw(options);
  mapper::OccupancyMap coded(options);
  CloudEncoder encoder({.depth_step = options.voxel_size / 20.0});
  CloudDecoder decoder;
  std::size_t bytes = 0;
  std::size_t raw_bytes = 0;
  std::size_t clouds = 0;
  std::shared_ptr<const Buffer> table;
  const simulator::Flight flight = simulator::FlyRounds(world, simulator::Motion::kSmooth, 20.0);
  const auto step = static_cast<std::size_t>(flight.rate / model.rate);
  for (std::size_t frame = 0; frame < flight.T_WCs.size(); frame += step, ++clouds) {
    const PointCloud cloud = sensor.Capture(world, flight.T_WCs[frame]);
    const CodedCloud sent = encoder.Encode(cloud);
    if (sent.table != table) {
      bytes += sent.table->size();
      ASSERT_FALSE(decoder.SetTable(*sent.table));
    }
    table = sent.table;
    bytes += sent.bytes.size();
    raw_bytes += 16 * cloud.points_C.size();  // with the color that clouds have on the wire
    const auto received = decoder.Decode(sent.bytes);
    ASSERT_TRUE(received) << received.error();
    raw.Integrate(cloud, flight.T_WCs[frame]);
    coded.Integrate(*received, flight.T_WCs[frame]);
  }
  std::size_t known = 0;
  std::size_t same = 0;
  const auto compare = [&](const OccupancyGrid& one, const OccupancyGrid& other, bool count_both) {
    one.ForEachKnown([&](const VoxelIndex& voxel, float log_odds) {
      const VoxelState state = other.State(voxel);
      if (!count_both && state != VoxelState::kUnknown) return;  // counted already
      ++known;
      same += state == OccupancyGrid::StateOf(log_odds) ? 1 : 0;
    });
  };
  compare(raw.grid(), coded.grid(), true);
  compare(coded.grid(), raw.grid(), false);
  const double per_cloud = static_cast<double>(bytes) / static_cast<double>(clouds);
  const double share = static_cast<double>(same) / static_cast<double>(known);
  std::cout << clouds << " clouds of " << raw_bytes / clouds << " bytes, coded " << per_cloud << ", "
            << per_cloud * 8 * model.rate / 1e6 << " Mbit/s at " << model.rate << " Hz; of " << known
            << " voxels " << 100 * share << " % are the same\n";
  RecordProperty("bytes_per_cloud", std::to_string(per_cloud));
  EXPECT_GT(known, 50'000U);
  EXPECT_GE(share, 0.995);
  EXPECT_LE(per_cloud * 8 * model.rate, 0.5e6);
}

}  // namespace
}  // namespace thalweg::link
