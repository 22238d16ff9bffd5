#include <gtest/gtest.h>

#include <cstring>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <random>
#include <string>
#include <vector>

#include "common/dds/bus.h"
#include "common/dds/convert.h"
#include "tests/support/test_bus.h"

namespace thalweg::dds {
namespace {

using test::BusOptionsForTest;
using test::kPatience;
using Bytes = std::vector<std::uint8_t>;
using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;

/// Claims to be `Topic`'s type, but sends arbitrary bytes.
template <class Topic>
class LyingType : public eprosima::fastdds::dds::TopicDataType {
 public:
  LyingType() {
    setName(NameOf(TypeSupportOf<Topic>()).c_str());
    m_typeSize = 1 << 16;
  }
  bool serialize(void* data, Payload* payload) override {
    const Bytes& bytes = *static_cast<Bytes*>(data);
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    return true;
  }
  bool deserialize(Payload*, void*) override { return false; }
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
    const auto size = static_cast<std::uint32_t>(static_cast<Bytes*>(data)->size());
    return [size] { return size; };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

template <class Topic>
struct Lying {
  using Message = Bytes;
  static TypeSupport NewTypeSupport() { return TypeSupport(new LyingType<Topic>()); }
  static constexpr auto kName = Topic::kName;
  static constexpr auto kDelivery = Topic::kDelivery;
};

thalweg_msgs::msg::MapUpdate SomeUpdate() {
  thalweg_msgs::msg::MapUpdate update;
  update.header(MakeHeader(Time{std::chrono::seconds(3)}, kMapFrame));
  update.session(1);
  update.voxel_size_m(0.1);
  update.scans().resize(2);
  update.scans()[1].measured().resize(64, 255);
  update.blocks().resize(3);
  for (auto& block : update.blocks()) block.log_odds({0.5F, -0.4F});
  return update;
}

/// Sends each of `lies`, then a valid message, and waits until that one has arrived.
void SendLies(const std::vector<Bytes>& lies, Bus& reader, int& honest_come) {
  Bus liar(BusOptionsForTest("liar"));
  const auto lying = liar.Advertise<Lying<topics::MapUpdates>>();
  ASSERT_TRUE(liar.SpinUntil([&] { return lying.readers() == 1; }, kPatience));
  for (const Bytes& lie : lies) {
    ASSERT_TRUE(lying.Write(lie));
    ASSERT_TRUE(reader.SpinUntil(
        [&, before = honest_come] { return reader.health().rejected() > 0 || honest_come > before; },
        kPatience));
  }
  const int before = honest_come;
  ASSERT_TRUE(lying.Write(Encode<topics::MapUpdates>(SomeUpdate())));
  ASSERT_TRUE(reader.SpinUntil([&] { return honest_come > before; }, kPatience));
}

TEST(LyingBytes, AreCountedAndTheNextHonestMessageComes) {
  Bus reader(BusOptionsForTest("reader"));
  int come = 0;
  reader.Subscribe<topics::MapUpdates>([&](const auto& m) { come += m.session() == 1 ? 1 : 0; });
  Bytes too_many = Encode<topics::MapUpdates>(SomeUpdate());
  const std::size_t half = too_many.size() / 2;
  const std::vector<Bytes> lies = {
      Bytes(too_many.begin(), too_many.begin() + static_cast<std::ptrdiff_t>(half)),  // truncated
      {0x00},                                                                         // less than a header
      {0xFF, 0xFF, 0xFF, 0xFF, 1, 2, 3, 4},                                           // unknown encapsulation
      Bytes(4096, 0xFF),                                                              // endless sequences
  };
  SendLies(lies, reader, come);
  EXPECT_EQ(come, 1);
  EXPECT_GE(reader.health().rejected(), 4U);
}

TEST(LyingBytes, MemoryGrowsWithWhatIsDecodedNotWithWhatIsClaimed) {
  Bytes lie = Encode<topics::Path>(nav_msgs::msg::Path());  // ends with the number of poses
  constexpr std::uint32_t kClaimed = 1'000'000;
  std::memcpy(&lie[lie.size() - 4], &kClaimed, 4);
  lie.resize(lie.size() + kClaimed, 0xFF);  // as many bytes, but no frame name is that long
  nav_msgs::msg::Path path;
  EXPECT_FALSE(DecodeSample(TypeSupportOf<topics::Path>(), lie, &path));
  EXPECT_LE(path.poses().capacity(), 64U);
}

TEST(LyingBytes, SequencesOfAnyLengthComeWhole) {
  for (const std::size_t count : {0, 1, 63, 64, 65, 200}) {
    nav_msgs::msg::Path path;
    path.poses().resize(count);
    for (std::size_t k = 0; k < count; ++k) path.poses()[k].header().stamp().sec(static_cast<int>(k));
    const auto decoded = Decode<topics::Path>(Encode<topics::Path>(path));
    ASSERT_TRUE(decoded);
    EXPECT_EQ(*decoded, path);
  }
}

TEST(LyingBytes, MoreThanATopicMayHaveIsNotDecoded) {
  Bus reader(BusOptionsForTest("reader"));
  Bus sender(BusOptionsForTest("sender"));
  std::vector<std::size_t> come;
  reader.Subscribe<topics::Path>([&](const auto& m) { come.push_back(m.header().frame_id().size()); });
  const auto path_out = sender.Advertise<topics::Path>();
  ASSERT_TRUE(sender.SpinUntil([&] { return path_out.readers() == 1; }, kPatience));
  nav_msgs::msg::Path path;
  path.header().frame_id(std::string((1U << 20) + 1, 'x'));
  ASSERT_TRUE(path_out.Write(path));
  ASSERT_TRUE(reader.SpinUntil([&] { return reader.health().rejected() == 1; }, kPatience));
  const std::string reason = reader.health().ToMessage(Time{}).rejected()[0].last();
  EXPECT_NE(reason.find("more than the 1048576"), std::string::npos) << reason;
  path.header().frame_id("map");
  ASSERT_TRUE(path_out.Write(path));
  ASSERT_TRUE(reader.SpinUntil([&] { return !come.empty(); }, kPatience));
  EXPECT_EQ(come, std::vector<std::size_t>{3});
}

TEST(LyingBytes, CutOrDisturbedAnywhereNeverCrash) {
  const Bytes honest = Encode<topics::MapUpdates>(SomeUpdate());
  std::vector<Bytes> lies;
  for (std::size_t length = 1; length < honest.size(); length += 3) {
    lies.emplace_back(honest.begin(), honest.begin() + static_cast<std::ptrdiff_t>(length));
  }
  std::mt19937 random(7);
  for (int k = 0; k < 200; ++k) {
    Bytes& lie = lies.emplace_back(honest);
    for (int flips = 0; flips < 4; ++flips) {
      lie[std::uniform_int_distribution<std::size_t>(0, lie.size() - 1)(random)] =
          static_cast<std::uint8_t>(std::uniform_int_distribution(0, 255)(random));
    }
  }
  Bus reader(BusOptionsForTest("reader"));
  int come = 0;
  reader.Subscribe<topics::MapUpdates>([&](const auto& m) { come += m.session() == 1 ? 1 : 0; });
  SendLies(lies, reader, come);
  EXPECT_GT(reader.health().rejected(), 0U);
}

}  // namespace
}  // namespace thalweg::dds
