#include "services/inspector/adapter/mistake_report.h"

#include <gmock/gmock.h>

#include <optional>
#include <vector>

#include "tests/support/test_bus.h"

namespace thalweg::inspector {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class MistakeReportTest : public testing::Test {
 protected:
  MistakeReportTest() {
    report_.emplace(listener_, [this](const auto& text) { said_.push_back(text); });
  }

  static OpenTopic Odometry() { return *FindOpenTopic(dds::InfoOf<dds::topics::Odometry>().name, "", {}); }
  void AwaitMatch() {
    ASSERT_TRUE(from_.SpinUntil([&] { return publisher_.readers() > 0; }, test::kPatience));
    ASSERT_TRUE(to_.SpinUntil([&] { return to_.Writers<dds::topics::Odometry>() > 0; }, test::kPatience));
  }
  /// Sends a message that ends within its header, and waits until it has arrived.
  void SendMalformed() {
    const std::uint64_t before = listener_.received();
    publisher_.Write(std::vector<std::uint8_t>{0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0xFF, 0, 0, 0});
    ASSERT_TRUE(to_.SpinUntil([&] { return listener_.received() > before; }, test::kPatience));
  }

  dds::Bus from_{test::BusOptionsForTest("publisher")};
  dds::Bus to_{test::BusOptionsForTest("listener")};
  TopicListener listener_{to_, Odometry(), [](const Value&, const dds::RawSample&) {}};
  dds::Bus::BytesPublisher publisher_ = from_.AdvertiseBytes(Odometry().info);
  std::vector<std::string> said_;
  std::optional<MistakeReport> report_;
};

TEST_F(MistakeReportTest, TheFirstMistakeIsNamedAtOnceAndAtTheEndTheirNumber) {
  AwaitMatch();
  SendMalformed();
  const std::string first = "malformed message: " + listener_.last_error();
  report_->Look();
  EXPECT_THAT(said_, ElementsAre(first));
  SendMalformed();
  report_->Look();
  EXPECT_THAT(said_, ElementsAre(first));
  report_.reset();
  EXPECT_THAT(said_,
              ElementsAre(first, "2 of 2 messages were malformed; the last: " + listener_.last_error()));
}

TEST_F(MistakeReportTest, AMistakeThatNobodyLookedAtIsNamedAtTheEnd) {
  AwaitMatch();
  SendMalformed();
  report_.reset();
  EXPECT_THAT(said_, ElementsAre("malformed message: " + listener_.last_error()));
}

TEST_F(MistakeReportTest, WithoutMistakesThereIsNothingToSay) {
  report_->Look();
  report_.reset();
  EXPECT_THAT(said_, IsEmpty());
}

}  // namespace
}  // namespace thalweg::inspector
