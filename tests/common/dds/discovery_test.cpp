#include "common/dds/discovery.h"

#include <fastrtps/utils/IPLocator.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace thalweg::dds {
namespace {

using eprosima::fastrtps::rtps::IPLocator;
using testing::ElementsAre;
using testing::HasSubstr;

std::string DiscoveryErrorOf(const BusOptions& options, bool secured) {
  eprosima::fastdds::dds::WireProtocolConfigQos protocol;
  try {
    SetDiscovery(options, secured, protocol);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

std::vector<std::string> AnnouncedTo(const BusOptions& options) {
  eprosima::fastdds::dds::WireProtocolConfigQos protocol;
  SetDiscovery(options, true, protocol);
  std::vector<std::string> addresses;
  for (const auto& locator : protocol.builtin.initialPeersList) {
    addresses.push_back(IPLocator::toIPv4string(locator) + ':' +
                        std::to_string(IPLocator::getPhysicalPort(locator)));
  }
  return addresses;
}

TEST(Discovery, ListsAreSeparatedByCommas) {
  EXPECT_THAT(PeersIn(""), ElementsAre());
  EXPECT_THAT(PeersIn("10.0.0.2"), ElementsAre("10.0.0.2"));
  EXPECT_THAT(PeersIn("10.0.0.2,base.local"), ElementsAre("10.0.0.2", "base.local"));
  for (const char* const list : {",", "a,", ",a", "a,,b", "a b", "a:7400"}) {
    EXPECT_THROW(PeersIn(list), std::runtime_error) << list;
  }
}

TEST(Discovery, PeersAreAnnouncedToInAdditionToMulticastAndThisMachine) {
  BusOptions options;
  EXPECT_THAT(AnnouncedTo(options), ElementsAre());  // Fast DDS then takes the multicast group
  options.peers = "10.0.0.2,10.0.0.3";
  EXPECT_THAT(AnnouncedTo(options), ElementsAre("239.255.0.1:0", "127.0.0.1:0", "10.0.0.2:0", "10.0.0.3:0"));
}

TEST(Discovery, ServersHaveTheIdsOfTheirPlacesInTheList) {
  const auto text_of = [](const std::string& list) {
    std::string text;
    for (const auto& [id, host_and_port] : ServersIn(list))
      text += std::to_string(id) + "=" + host_and_port + " ";
    return text;
  };
  EXPECT_EQ(text_of("a:1"), "0=a:1 ");
  EXPECT_EQ(text_of("a:1;b:2"), "0=a:1 1=b:2 ");
  EXPECT_EQ(text_of(";a:1;;b:2"), "1=a:1 3=b:2 ");
  for (const std::string& list : {std::string(), std::string(";;"), std::string(256, ';') + "a:1"}) {
    EXPECT_THROW(ServersIn(list), std::runtime_error) << list;
  }
}

TEST(Discovery, ErrorsNameWhatIsWrong) {
  BusOptions options;
  options.peers = "nowhere.invalid";
  EXPECT_THAT(DiscoveryErrorOf(options, false), HasSubstr("peer \"nowhere.invalid\": no such host"));
  options.discovery_server = "10.0.0.1:11811";
  EXPECT_THAT(DiscoveryErrorOf(options, false), HasSubstr("not together with peers"));
  options.peers.clear();
  EXPECT_EQ(DiscoveryErrorOf(options, false), "");
  EXPECT_THAT(DiscoveryErrorOf(options, true), HasSubstr("not together with keys"));
}

}  // namespace
}  // namespace thalweg::dds
