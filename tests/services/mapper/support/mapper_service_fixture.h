#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <vector>

#include "common/dds/map_replica.h"
#include "services/mapper/adapter/mapper_service.h"
#include "tests/services/mapper/adapter/example_map.h"
#include "tests/services/mapper/support/each_engine.h"
#include "tests/support/test_bus.h"

/// A mapper on a bus, a robot that sends it poses and clouds, and a reader of its map.
namespace thalweg::mapper::test {

namespace topics = dds::topics;
using thalweg::test::AwaitMatch;
using thalweg::test::BusOptionsForTest;
using thalweg::test::kPatience;
using thalweg::test::TestFolder;

inline Time At(double seconds) {
  return Time{FromSeconds(seconds)};
}

/// The pose of the test's robot, and below what it sees.
inline RigidTransform PoseAt(double seconds) {
  return MakeTransform(RotationFromYawPitch(0.3 * seconds, 0.0), {-1.5 + 0.2 * seconds, 0.1, 0.0});
}

inline PointCloud CloudAt(double seconds) {
  const RigidTransform T_WC = PoseAt(seconds) * MapperOptions{}.T_BC;
  PointCloud cloud =
      thalweg::test::AnalyticRoom::Furnished().Render(PinholeCamera::FromFieldOfView(40, 30, 1.3), T_WC);
  cloud.colors.assign(cloud.points_C.size(), Rgb{200, 100, 50});
  return cloud;
}

/// Spins the two buses in turn until `done`.
inline bool SpinTogether(dds::Bus& a, dds::Bus& b, const std::function<bool()>& done) {
  constexpr auto kTurn = std::chrono::milliseconds(5);
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!b.SpinUntil(done, kTurn)) {
    if (std::chrono::steady_clock::now() > end) return false;
    a.SpinUntil([] { return false; }, kTurn);
  }
  return true;
}

/// A reader of the map, as the explorer is one.
class Listener {
 public:
  Listener() : bus_(BusOptionsForTest("listener")), requests_(bus_.Advertise<topics::MapRequests>()) {
    bus_.Subscribe<topics::MapUpdates>([this](const thalweg_msgs::msg::MapUpdate& update) {
      full_copies_ += update.full() ? 1 : 0;
      scans_.insert(scans_.end(), update.scans().begin(), update.scans().end());
      EXPECT_TRUE(replica_.Apply(update));
      RequestWhatIsMissing();
    });
    // A request may be sent before the mapper listens, so it is repeated, as real readers do.
    bus_.EveryWall(std::chrono::milliseconds(200), [this] { RequestWhatIsMissing(); });
  }

  void RequestWhatIsMissing() {
    if (replica_.missing()) requests_.Write(replica_.MakeRequest(bus_.Now(), "listener"));
  }
  /// Spins both until the listener has the map under `number` or a later one, of a session other than
  /// `session_before`.
  bool Follow(dds::Bus& mapper_bus, std::uint64_t session_before, std::uint64_t number) {
    return SpinTogether(mapper_bus, bus_, [&] {
      return !replica_.missing() && replica_.session() != session_before && replica_.number() >= number;
    });
  }

  dds::Bus& bus() { return bus_; }
  const dds::Bus::Publisher<topics::MapRequests>& requests() const { return requests_; }
  const dds::MapReplica& replica() const { return replica_; }
  int full_copies() const { return full_copies_; }
  const std::vector<thalweg_msgs::msg::ScanView>& scans() const { return scans_; }

 private:
  dds::Bus bus_;
  dds::Bus::Publisher<topics::MapRequests> requests_;
  dds::MapReplica replica_;
  int full_copies_ = 0;
  std::vector<thalweg_msgs::msg::ScanView> scans_;
};

/// Each test holds whichever engine fuses the map.
class MapperServiceTest : public testing::TestWithParam<MapEngine> {
 protected:
  MapperServiceTest()
      : robot_(BusOptionsForTest("robot")),
        odometry_(robot_.Advertise<topics::Odometry>()),
        points_(robot_.Advertise<topics::DepthPoints>()) {
    options_.engine = GetParam();
    options_.out = folder_.path();
    options_.checkpoint_period = std::chrono::hours(1);
    options_.snapshot_period = std::chrono::hours(1);
    options_.full_copy_period = std::chrono::milliseconds(20);
  }

  void Start() {
    mapper_.reset();
    bus_.emplace(BusOptionsForTest("mapper"));
    mapper_.emplace(options_, *bus_);
    AwaitMatch(robot_, odometry_, *bus_);
    AwaitMatch(robot_, points_, *bus_);
  }
  /// Stops the mapper as kill -9 does: without Save().
  void Kill() {
    mapper_.reset();
    bus_.reset();
  }

  void SendPose(double seconds) {
    odometry_.Write(dds::OdometryToIdl(At(seconds), PoseAt(seconds), {0, 0, 0}, {0, 0, 0}));
  }
  void SendCloud(double seconds) { points_.Write(dds::ToIdl(At(seconds), CloudAt(seconds))); }

  bool SpinUntil(const std::function<bool()>& done) { return bus_->SpinUntil(done, kPatience); }
  unsigned long long Scans() { return mapper_->updates(); }
  unsigned long long Dropped() { return bus_->health().dropped(); }
  unsigned long long Rejected() { return bus_->health().rejected(); }

  bool SaysThatItResumed() {
    const auto timings = bus_->health().ToMessage(Time{}).timings();
    return std::ranges::any_of(
        timings, [](const auto& timing) { return timing.name() == MapperService::kResumeTiming; });
  }

  /// Sends a cloud and its pose and waits until the cloud is in the map.
  void Scan(double seconds) {
    const auto before = Scans();
    SendPose(seconds);
    SendCloud(seconds);
    ASSERT_TRUE(SpinUntil([&] { return Scans() == before + 1; })) << seconds;
  }
  void Connect(Listener& listener) {
    ASSERT_TRUE(listener.bus().SpinUntil([&] { return listener.bus().Writers<topics::MapUpdates>() > 0; },
                                         kPatience));
    AwaitMatch(listener.bus(), listener.requests(), *bus_);
    ASSERT_TRUE(SpinUntil([&] { return mapper_->listeners() > 0; }));
    listener.RequestWhatIsMissing();
  }

  TestFolder folder_;
  MapperOptions options_;
  dds::Bus robot_;
  dds::Bus::Publisher<topics::Odometry> odometry_;
  dds::Bus::Publisher<topics::DepthPoints> points_;
  std::optional<dds::Bus> bus_;
  std::optional<MapperService> mapper_;
};

}  // namespace thalweg::mapper::test
