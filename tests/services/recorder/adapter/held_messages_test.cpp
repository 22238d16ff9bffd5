#include "services/recorder/adapter/held_messages.h"

#include <gmock/gmock.h>

#include "common/dds/convert.h"
#include "common/dds/map_log.h"

namespace thalweg::recorder {
namespace {

namespace topics = dds::topics;
using std::chrono_literals::operator""s;
using testing::ElementsAre;
using Payload = std::vector<std::uint8_t>;

Payload StaticFrames(const std::vector<std::string>& frames, double x = 0.0) {
  tf2_msgs::msg::TFMessage message;
  for (const std::string& frame : frames) {
    auto& transform = message.transforms().emplace_back();
    transform.child_frame_id(frame);
    transform.transform().translation().x(x);
  }
  return dds::Encode<topics::StaticTransforms>(message);
}

std::vector<Payload> PayloadsOf(const HeldMessages& held) {
  std::vector<Payload> payloads;
  for (const HeldMessages::Item& item : held.Items()) payloads.push_back(item.payload);
  return payloads;
}

TEST(HeldMessages, TheNewestMessageOfEachStateIsHeldWithItsTimes) {
  HeldMessages held;
  held.Hold(3, dds::InfoOf<topics::MotionStatus>());
  held.Hold(5, dds::InfoOf<topics::ExplorationStatus>());
  held.Hold(7, dds::InfoOf<topics::Odometry>());
  const Payload old = {1}, status = {2}, motion = {3};
  held.Take(3, 0, Time{1s}, Time{0s}, old);
  held.Take(5, 8, Time{4s}, Time{3s}, status);
  held.Take(3, 1, Time{6s}, Time{5s}, motion);
  held.Take(7, 0, Time{7s}, Time{7s}, old);
  held.Take(9, 0, Time{7s}, Time{7s}, old);
  EXPECT_THAT(PayloadsOf(held), ElementsAre(status, motion)) << "by log time, and none of a stream";
  const HeldMessages::Item last = held.Items().back();
  EXPECT_EQ(last.channel, 3U);
  EXPECT_EQ(last.sequence, 1U);
  EXPECT_EQ(last.publish_time, Time{5s});
  EXPECT_TRUE(held.Has(3, 1, Time{5s}, motion));
  EXPECT_FALSE(held.Has(3, 1, Time{6s}, motion));
  EXPECT_FALSE(held.Has(3, 0, Time{0s}, old));
}

TEST(HeldMessages, AMessageOfTransformsIsHeldUntilAllItsFramesAreSaidAgain) {
  HeldMessages held;
  held.Hold(0, dds::InfoOf<topics::StaticTransforms>());
  const Payload both = StaticFrames({"camera", "imu"});
  const Payload other = StaticFrames({"lidar"});
  const Payload camera = StaticFrames({"camera"}, 1.0);
  const Payload imu = StaticFrames({"imu"}, 1.0);
  held.Take(0, 0, Time{1s}, Time{1s}, both);
  held.Take(0, 1, Time{2s}, Time{2s}, other);
  held.Take(0, 2, Time{3s}, Time{3s}, camera);
  EXPECT_THAT(PayloadsOf(held), ElementsAre(both, other, camera));
  held.Take(0, 3, Time{4s}, Time{4s}, imu);
  EXPECT_THAT(PayloadsOf(held), ElementsAre(other, camera, imu));
  held.Take(0, 4, Time{5s}, Time{5s}, Payload{1, 2, 3});
  EXPECT_THAT(PayloadsOf(held), ElementsAre(other, camera, imu)) << "what does not decode says nothing";
}

TEST(HeldMessages, UpdatesAreHeldAsOneFullCopyToWhichTheNextOneFits) {
  HeldMessages held;
  held.Hold(0, dds::InfoOf<topics::MapUpdates>());
  dds::MapLog log(7, 0.1);
  held.Take(0, 0, Time{0s}, Time{0s}, dds::Encode<topics::MapUpdates>(log.TakeUpdate()));
  EXPECT_TRUE(held.Items().empty()) << "before the first full copy there is no map";
  held.Take(0, 1, Time{1s}, Time{1s}, dds::Encode<topics::MapUpdates>(log.FullCopy(OccupancyGrid(0.1))));
  held.Take(0, 2, Time{2s}, Time{2s}, dds::Encode<topics::MapUpdates>(log.TakeUpdate()));
  const std::vector<HeldMessages::Item> items = held.Items();
  ASSERT_EQ(items.size(), 1U);
  EXPECT_EQ(items[0].log_time, Time{2s});
  const auto copy = dds::Decode<topics::MapUpdates>(items[0].payload);
  ASSERT_TRUE(copy);
  EXPECT_TRUE(copy->full());
  EXPECT_EQ(copy->number() + 1, log.TakeUpdate().number());
}

}  // namespace
}  // namespace thalweg::recorder
