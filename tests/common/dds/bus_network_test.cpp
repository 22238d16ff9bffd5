#include <fastdds/rtps/attributes/ServerAttributes.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "common/dds/bus.h"
#include "tests/support/test_bus.h"

namespace thalweg::dds {
namespace {

namespace fastdds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using test::BusOptionsForTest;
using test::kPatience;

/// Equivalent to `fast-discovery-server -i ID -l 127.0.0.1 -p PORT`.
class DiscoveryServer {
 public:
  DiscoveryServer(int domain, std::uint16_t port, int id = 0) {
    rtps::Locator_t locator;
    rtps::IPLocator::createLocator(LOCATOR_KIND_UDPv4, "127.0.0.1", port, locator);
    fastdds::DomainParticipantQos qos;
    auto& protocol = qos.wire_protocol();
    protocol.builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::SERVER;
    protocol.builtin.metatrafficUnicastLocatorList.push_back(locator);
    eprosima::fastdds::rtps::get_server_client_default_guidPrefix(id, protocol.prefix);
    participant_ = fastdds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<std::uint32_t>(domain), qos);
    if (participant_ == nullptr) throw std::runtime_error("no discovery server");
  }
  ~DiscoveryServer() { fastdds::DomainParticipantFactory::get_instance()->delete_participant(participant_); }
  DiscoveryServer(const DiscoveryServer&) = delete;
  DiscoveryServer& operator=(const DiscoveryServer&) = delete;

 private:
  fastdds::DomainParticipant* participant_;
};

void ExpectThatTheyMeet(const BusOptions& options) {
  Bus from(options);
  Bus to(options);
  const auto state = from.Advertise<topics::MotionStatus>();
  std::string heard;
  to.Subscribe<topics::MotionStatus>([&](const auto& m) { heard = m.reason(); });
  thalweg_msgs::msg::MotionStatus status;
  status.reason("here");
  state.Write(status);
  EXPECT_TRUE(to.SpinUntil([&] { return heard == "here"; }, kPatience));
}

/// A UDP port that nobody has at the moment, of those that the kernel gives away, so that no other test takes
/// it.
std::uint16_t FreePort() {
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  const bool bound = ::bind(socket, reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
                     ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  ::close(socket);
  if (!bound) throw std::runtime_error("no free port");
  return ntohs(address.sin_port);
}

TEST(Network, PeersMeetThroughADiscoveryServer) {
  BusOptions options = BusOptionsForTest("client");
  const std::uint16_t port = FreePort();
  const DiscoveryServer server(options.domain, port);
  options.discovery_server = "127.0.0.1:" + std::to_string(port);
  ExpectThatTheyMeet(options);
}

TEST(Network, EitherOfTwoDiscoveryServersMayEndAndComeBack) {
  // Servers and clients of one process would otherwise hand over messages directly, as those of two do not.
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
  BusOptions options = BusOptionsForTest("client");
  const std::uint16_t port = FreePort();
  std::optional<DiscoveryServer> first(std::in_place, options.domain, port);
  const std::uint16_t other_port = FreePort();
  std::optional<DiscoveryServer> second(std::in_place, options.domain, other_port, 1);
  BusOptions only_first = options;
  only_first.discovery_server = "127.0.0.1:" + std::to_string(port);
  options.discovery_server = only_first.discovery_server + ";127.0.0.1:" + std::to_string(other_port);
  Bus listener(options);
  std::string heard;
  listener.Subscribe<topics::MotionStatus>([&](const auto& m) { heard = m.reason(); });
  const auto is_heard = [&](const std::string& text, const BusOptions& with) {
    Bus bus(with);
    const auto state = bus.Advertise<topics::MotionStatus>();
    thalweg_msgs::msg::MotionStatus status;
    status.reason(text);
    state.Write(status);
    return listener.SpinUntil([&] { return heard == text; }, kPatience);
  };
  EXPECT_TRUE(is_heard("with both", options));
  first.reset();
  EXPECT_TRUE(is_heard("without the first", options));
  first.emplace(options.domain, port);
  EXPECT_TRUE(is_heard("by the first", only_first)) << "which has learned again who there is";
  second.reset();
  EXPECT_TRUE(is_heard("without the second", options));
}

TEST(Network, PeersMeetOnOneInterface) {
  BusOptions options = BusOptionsForTest("local");
  options.network_interface = "127.0.0.1";
  options.shared_memory = false;
  ExpectThatTheyMeet(options);
}

TEST(Network, PeersMeetOverUdpAlone) {
  BusOptions options = BusOptionsForTest("udp");
  options.shared_memory = false;
  ExpectThatTheyMeet(options);
}

}  // namespace
}  // namespace thalweg::dds
