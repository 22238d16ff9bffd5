#include "common/dds/network_interfaces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "common/dds/bus.h"
#include "tests/support/test_bus.h"

namespace thalweg::dds {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr auto kNowhere = "192.0.2.77";  // reserved for documentation [RFC 5737], so no machine has it

std::string ErrorOfBusAt(const std::string& address) {
  BusOptions options = test::BusOptionsForTest("bus");
  options.network_interface = address;
  try {
    const Bus bus(options);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

TEST(NetworkInterfaces, AnAddressThatIsNotThereIsRefusedWithThoseThatAre) {
  EXPECT_THAT(
      ErrorOfBusAt(kNowhere),
      AllOf(HasSubstr(kNowhere), HasSubstr("this machine has no such address"), HasSubstr("127.0.0.1 (lo)")));
}

TEST(NetworkInterfaces, EachAddressThatIsListedIsAccepted) {
  const std::vector<InterfaceAddress> addresses = InterfaceAddresses();
  ASSERT_FALSE(addresses.empty());
  for (const InterfaceAddress& entry : addresses) EXPECT_NO_THROW(CheckInterfaceExists(entry.address));
  EXPECT_EQ(ErrorOfBusAt(addresses.front().address), "no error");
}

TEST(NetworkInterfaces, AChangeIsNoticedOnce) {
  const InterfaceAddress loopback{.interface = "lo", .address = "127.0.0.1", .is_loopback = true};
  const InterfaceAddress at_home{.interface = "wlan0", .address = "10.0.0.2", .has_multicast = true};
  const InterfaceAddress elsewhere{.interface = "wlan0", .address = "10.9.0.7", .has_multicast = true};
  AddressWatch watch({loopback, at_home});
  EXPECT_EQ(watch.Changes({at_home, loopback}), "");
  EXPECT_EQ(watch.Changes({loopback, elsewhere}), "10.0.0.2 (wlan0) gone, 10.9.0.7 (wlan0) new");
  EXPECT_EQ(watch.Changes({loopback, elsewhere}), "");
  EXPECT_EQ(watch.Changes({loopback}), "10.9.0.7 (wlan0) gone");
}

TEST(NetworkInterfaces, AParticipantDoesNotKnowAddressesThatCameLater) {
  const InterfaceAddress loopback{.interface = "lo", .address = "127.0.0.1", .is_loopback = true};
  const InterfaceAddress at_home{.interface = "wlan0", .address = "10.0.0.2", .index = 3};
  const InterfaceAddress plugged_in_again{.interface = "wlan0", .address = "10.0.0.2", .index = 4};
  AddressWatch watch({loopback, at_home});
  EXPECT_TRUE(watch.began_in_a_network());
  watch.Changes({loopback});
  EXPECT_FALSE(watch.has_unknown());
  watch.Changes({loopback, at_home});
  EXPECT_FALSE(watch.has_unknown()) << "one that comes back is known";
  watch.Changes({loopback, plugged_in_again});
  EXPECT_TRUE(watch.has_unknown()) << "what was set for the former interface is gone with it";
  watch.Renew();
  EXPECT_FALSE(watch.has_unknown());
  EXPECT_FALSE(AddressWatch({loopback}).began_in_a_network());
}

}  // namespace
}  // namespace thalweg::dds
