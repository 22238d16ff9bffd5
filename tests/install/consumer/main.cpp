#include <unistd.h>

#include <cstdlib>
#include <iostream>

#include "common/base/version.h"
#include "common/dds/bus.h"
#include "common/dds/convert.h"
#include "services/mapper/core/occupancy_map.h"

/// Fuses a wall 2 m ahead into a map, and sends a path from one Bus to another.
int main() {
  using namespace thalweg;
  mapper::OccupancyMap map({});
  PointCloud wall{.width_px = 41, .height_px = 31, .points_C = {}, .colors = {}};
  for (int v = -15; v <= 15; ++v)
    for (int u = -20; u <= 20; ++u) wall.points_C.emplace_back(0.04F * u, 0.04F * v, 2.0F);
  map.Integrate(wall, RigidTransform::Identity());
  const auto state = [&](double z) { return map.grid().State(map.grid().IndexOf({0.05, 0.05, z})); };
  const bool mapped = state(2.01) == VoxelState::kOccupied && state(1.05) == VoxelState::kFree &&
                      state(3.05) == VoxelState::kUnknown;

  dds::BusOptions options{.name = "sender", .domain = 1 + getpid() % 99};
  options.partition = "consumer." + std::to_string(getpid());
  dds::Bus sender(options);
  options.name = "receiver";
  dds::Bus receiver(options);
  std::size_t poses = 0;
  receiver.Subscribe<dds::topics::Path>([&](const auto& message) {
    if (const auto path = dds::FromIdl(message)) poses = path->T_WBs.size();
  });
  const auto out = sender.Advertise<dds::topics::Path>();
  constexpr auto kPatience = std::chrono::seconds(20);
  const bool matched =
      sender.SpinUntil([&] { return out.readers() > 0; }, kPatience) &&
      receiver.SpinUntil([&] { return receiver.Writers<dds::topics::Path>() > 0; }, kPatience);
  out.Write(
      dds::ToIdl(dds::StampedPath{sender.Now(), {RigidTransform::Identity(), RigidTransform::Identity()}}));
  const bool received = matched && receiver.SpinUntil([&] { return poses == 2; }, kPatience);

  std::cout << "thalweg " << Version() << (mapped ? ", mapped" : ", NOT mapped")
            << (received ? ", received" : ", NOT received") << '\n';
  return mapped && received ? EXIT_SUCCESS : EXIT_FAILURE;
}
