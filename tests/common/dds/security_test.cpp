#include "common/dds/security.h"

#include <arpa/inet.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/if_ether.h>
#include <net/if.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <netpacket/packet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fstream>
#include <mutex>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/dds/bus.h"
#include "common/dds/qos.h"
#include "tests/support/security_keys.h"
#include "tests/support/test_bus.h"

namespace thalweg::dds {
namespace {

namespace fastdds = eprosima::fastdds::dds;
namespace fs = std::filesystem;
using test::AwaitMatch;
using test::BusOptionsForTest;
using test::KeyFolder;
using test::kPatience;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

BusOptions Secure(const std::string& role, const KeyFolder& keys, bool shared_memory = false) {
  BusOptions options = BusOptionsForTest(role);
  options.shared_memory = shared_memory;
  options.security_dir = keys.path().string();
  return options;
}

BusOptions WithoutKeys(const std::string& name) {
  BusOptions options = BusOptionsForTest(name);
  options.shared_memory = false;
  return options;
}

class Security : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::HasOpenssl()) GTEST_SKIP() << "openssl is not installed";
    // Buses of one process would otherwise hand over messages directly, as two machines do not.
    eprosima::fastrtps::LibrarySettingsAttributes settings;
    settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
    eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
  }
};

/// The message by which CheckKeys refuses; empty if it does not.
std::string RefusalOf(const fs::path& folder, const std::string& participant) {
  try {
    CheckKeys(folder, participant, std::chrono::system_clock::now());
    return "";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST_F(Security, MissingAndForeignKeysAreNamed) {
  EXPECT_THAT(RefusalOf("/nowhere/keys", "mapper"), HasSubstr("/nowhere/keys: there is no such folder"));

  const KeyFolder keys("keys", "--role mapper --role explorer");
  const fs::path mapper = keys.path() / "mapper";
  EXPECT_EQ(RefusalOf(keys.path(), "mapper"), "");
  EXPECT_THAT(RefusalOf(keys.path(), "stereo"), HasSubstr("/stereo: is missing: there are no keys for"));
  EXPECT_THAT(RefusalOf(keys.path(), "replay"), HasSubstr("deploy/make-keys --role replay makes them"));

  const fs::path spare = keys.path() / "spare";
  fs::rename(mapper / "permissions.p7s", spare);
  EXPECT_THAT(RefusalOf(keys.path(), "mapper"), HasSubstr("mapper/permissions.p7s: is missing"));
  fs::rename(spare, mapper / "permissions.p7s");

  fs::rename(mapper / "key.pem", spare);
  fs::copy(keys.path() / "explorer" / "key.pem", mapper / "key.pem");
  EXPECT_THAT(RefusalOf(keys.path(), "mapper"), HasSubstr("mapper/key.pem: is not the key of"));
  fs::remove(mapper / "key.pem");
  std::ofstream(mapper / "key.pem") << "no key\n";
  EXPECT_THAT(RefusalOf(keys.path(), "mapper"), HasSubstr("mapper/key.pem: is no private key"));
  fs::remove(mapper / "key.pem");
  fs::rename(spare, mapper / "key.pem");
  EXPECT_EQ(RefusalOf(keys.path(), "mapper"), "");

  for (const char* const file : {"certificate.pem", "key.pem"}) {
    fs::copy(keys.path() / "explorer" / file, mapper / file, fs::copy_options::overwrite_existing);
  }
  EXPECT_THAT(RefusalOf(keys.path(), "mapper"), HasSubstr("belongs to role \"explorer\""));

  const KeyFolder other("other", "--role mapper");
  fs::copy(other.path() / "mapper" / "certificate.pem", mapper / "certificate.pem",
           fs::copy_options::overwrite_existing);
  EXPECT_THAT(RefusalOf(keys.path(), "mapper"), HasSubstr("was not signed by the authority"));
}

TEST_F(Security, PermissionsThatWereChangedAreRefused) {
  const KeyFolder keys("keys", "--role listener");
  const fs::path permissions = keys.path() / "listener" / "permissions.p7s";
  const auto outcome =
      test::OutcomeOf("sed -i 's:rt/map/requests:rt/explorer/path:' '" + permissions.string() + "'");
  ASSERT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(RefusalOf(keys.path(), "listener"), HasSubstr("or was changed since"));
}

TEST_F(Security, PermissionsThatAreTooLongToBeExchangedAreRefused) {
  const KeyFolder keys("keys", "--role listener");
  const fs::path table = keys.path() / "long-roles.txt";
  std::ofstream text(table);
  text << "mapper publishes";
  for (int k = 0; k < 100; ++k) text << " a/topic/with/a/rather/long/name/number_" << k;
  text << '\n' << std::flush;
  const KeyFolder long_keys("long", "--roles '" + table.string() + "'");
  EXPECT_THAT(RefusalOf(long_keys.path(), "mapper"), HasSubstr("mapper/permissions.p7s: is too long"));
}

TEST_F(Security, ACertificateOutOfItsDatesIsNamedWithThem) {
  const KeyFolder old("old", "--role mapper --from 2020-01-01 --days 30");
  EXPECT_THAT(RefusalOf(old.path(), "mapper"),
              HasSubstr("mapper/certificate.pem: expired on 2020-01-31 00:00 UTC"));
  EXPECT_THROW(Bus bus(Secure("mapper", old)), std::runtime_error);
  const KeyFolder early("early", "--role mapper --from 2120-01-01");
  EXPECT_THAT(RefusalOf(early.path(), "mapper"), HasSubstr("is not valid before 2120-01-01 00:00 UTC"));
}

TEST_F(Security, KeysThatExpireWithinAMonthAreAnnounced) {
  const auto now = std::chrono::system_clock::now();
  const KeyFolder soon("soon", "--role mapper --days 20");
  const auto warning = FindExpiry(CheckKeys(soon.path(), "mapper", now), now);
  ASSERT_TRUE(warning);
  EXPECT_THAT(*warning, HasSubstr("the keys of \"mapper\" in " + soon.path().string() + " expire on "));
  const KeyFolder later("later", "--role mapper --days 60");
  EXPECT_FALSE(FindExpiry(CheckKeys(later.path(), "mapper", now), now));
}

TEST_F(Security, APersonIsOperatorWhereThereAreKeysForIt) {
  const KeyFolder keys("keys", "--role listener");
  EXPECT_EQ(CheckKeys(keys.path(), "thalweg", std::chrono::system_clock::now()).role, "listener");
  test::OutcomeOf(test::SourceFolder() + "/deploy/make-keys '" + keys.path().string() + "' --role operator");
  EXPECT_EQ(CheckKeys(keys.path(), "thalweg", std::chrono::system_clock::now()).role, "operator");
}

class SecureTransport : public Security, public testing::WithParamInterface<bool> {};

TEST_P(SecureTransport, CarriesLargeMessagesBetweenPeersWithKeys) {
  const KeyFolder keys("keys", "--role simulator --role mapper");
  Bus mapper(Secure("mapper", keys, GetParam()));
  Bus simulator(Secure("simulator", keys, GetParam()));
  const auto cloud_out = simulator.Advertise<topics::DepthPoints>();
  sensor_msgs::msg::PointCloud2 cloud;
  for (int k = 0; k < 300'000; ++k) cloud.data().push_back(static_cast<std::uint8_t>(k * k));
  std::vector<std::uint8_t> received;
  mapper.Subscribe<topics::DepthPoints>([&](const auto& message) { received = message.data(); });
  AwaitMatch(simulator, cloud_out, mapper);
  cloud_out.Write(cloud);
  ASSERT_TRUE(mapper.SpinUntil([&] { return !received.empty(); }, kPatience));
  EXPECT_EQ(received, cloud.data());
}

INSTANTIATE_TEST_SUITE_P(SharedMemory, SecureTransport, testing::Bool());

nav_msgs::msg::Path PathNamed(const std::string& name) {
  nav_msgs::msg::Path path;
  path.header().frame_id(name);
  return path;
}

/// A controller that notes the names of the paths that it hears.
struct Controller {
  explicit Controller(const BusOptions& options) : bus(options) {
    bus.Subscribe<topics::Path>([this](const auto& path) { heard.push_back(path.header().frame_id()); });
  }
  bool Hears(const std::string& name) {
    return bus.SpinUntil([&] { return std::ranges::find(heard, name) != heard.end(); }, kPatience);
  }
  Bus bus;
  std::vector<std::string> heard;
};

TEST_F(Security, AStrangerNeitherReadsNorWrites) {
  const KeyFolder keys("keys", "--role explorer --role controller");
  Controller stranger(WithoutKeys("controller"));
  Bus strange_explorer(WithoutKeys("explorer"));
  const auto forged = strange_explorer.Advertise<topics::Path>();
  Controller controller(Secure("controller", keys));
  Bus explorer(Secure("explorer", keys));
  const auto genuine = explorer.Advertise<topics::Path>();
  AwaitMatch(strange_explorer, forged, stranger.bus);
  AwaitMatch(explorer, genuine, controller.bus);

  forged.Write(PathNamed("forged"));
  EXPECT_TRUE(stranger.Hears("forged"));
  genuine.Write(PathNamed("genuine"));
  EXPECT_TRUE(controller.Hears("genuine"));
  EXPECT_EQ(controller.heard, std::vector<std::string>{"genuine"});
  EXPECT_EQ(stranger.heard, std::vector<std::string>{"forged"});
  EXPECT_EQ(forged.readers(), 1);
  EXPECT_EQ(genuine.readers(), 1);
}

TEST_F(Security, KeysOfAnotherAuthorityAreThoseOfAStranger) {
  const KeyFolder keys("keys", "--role explorer --role controller");
  const KeyFolder others("others", "--role explorer --role controller");
  Controller controller(Secure("controller", keys));
  Controller other_controller(Secure("controller", others));
  Bus other_explorer(Secure("explorer", others));
  const auto forged = other_explorer.Advertise<topics::Path>();
  AwaitMatch(other_explorer, forged, other_controller.bus);
  Bus explorer(Secure("explorer", keys));
  const auto genuine = explorer.Advertise<topics::Path>();
  AwaitMatch(explorer, genuine, controller.bus);
  forged.Write(PathNamed("forged"));
  EXPECT_TRUE(other_controller.Hears("forged"));
  genuine.Write(PathNamed("genuine"));
  EXPECT_TRUE(controller.Hears("genuine"));
  EXPECT_EQ(controller.heard, std::vector<std::string>{"genuine"});
}

TEST_F(Security, NeitherAListenerNorAMapperMaySendAPath) {
  const KeyFolder keys("keys", "--role listener --role mapper");
  for (const std::string role : {"listener", "mapper"}) {
    Bus bus(Secure(role, keys));
    try {
      bus.Advertise<topics::Path>();
      ADD_FAILURE() << role;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr("writer \"explorer/path\": the permissions of role \"" + role));
    }
  }
  Bus mapper(Secure("mapper", keys));
  EXPECT_THROW(mapper.Subscribe<topics::Path>([](const auto&) {}), std::runtime_error);
}

TEST_F(Security, KeysMadeForARobotsNamesOpenItsTopicsAndNoOthers) {
  const KeyFolder keys("keys",
                       "--role explorer --role controller --robot alpha --topic explorer/path=plans/path");
  BusOptions explorer_options = Secure("explorer", keys);
  explorer_options.names = {.robot = "alpha", .topics = {{"explorer/path", "plans/path"}}, .frames = {}};
  BusOptions controller_options = explorer_options;
  controller_options.name = "controller";
  Controller controller(controller_options);
  Bus explorer(explorer_options);
  const auto paths = explorer.Advertise<topics::Path>();
  AwaitMatch(explorer, paths, controller.bus);
  paths.Write(PathNamed("alpha/map"));
  EXPECT_TRUE(controller.Hears("map"));

  for (const char* robot : {"", "beta"}) {
    BusOptions options = explorer_options;
    options.names = {.robot = robot, .topics = {}, .frames = {}};
    Bus other(options);
    EXPECT_THROW(other.Advertise<topics::Path>(), std::runtime_error) << robot;
  }
}

TEST_F(Security, AReplayStandsInForTheRobotAndSendsNoCommand) {
  const KeyFolder keys("keys", "--role replay --role mapper");
  Bus player(Secure("replay", keys));
  const Bus::BytesPublisher clouds = player.AdvertiseBytes(InfoOf<topics::DepthPoints>());
  for (const TopicInfo& topic : AllTopics()) {
    const bool is_clouds = topic.name == topics::DepthPoints::kName;
    if (topic.replay == Replay::kByDefault && !is_clouds) player.AdvertiseBytes(topic);
  }
  try {
    player.AdvertiseBytes(InfoOf<topics::Path>());
    ADD_FAILURE() << "a path was allowed";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("writer \"explorer/path\": the permissions of role \"replay\""));
  }
  Bus mapper(Secure("mapper", keys));
  int heard = 0;
  mapper.Subscribe<topics::DepthPoints>([&](const auto&) { ++heard; });
  ASSERT_TRUE(player.SpinUntil([&] { return clouds.readers() > 0; }, kPatience));
  ASSERT_TRUE(mapper.SpinUntil([&] { return mapper.Writers<topics::DepthPoints>() > 0; }, kPatience));
  EXPECT_TRUE(clouds.Write(Encode<topics::DepthPoints>({})));
  EXPECT_TRUE(mapper.SpinUntil([&] { return heard == 1; }, kPatience));
}

/// A participant with the identity of one folder and permissions that it gave itself, in another.
class SelfMadeExplorer {
 public:
  SelfMadeExplorer(const BusOptions& options, const fs::path& identity, const fs::path& rights) {
    const auto now = std::chrono::system_clock::now();
    auto qos = ParticipantQosFrom(options, std::make_shared<Guard>(), CheckKeys(identity, options.name, now));
    const auto own = PropertiesFrom(CheckKeys(rights, options.name, now));
    for (auto& property : qos.properties().properties()) {
      for (const auto& self_made : own.properties()) {
        const bool is_right = property.name().find("Access-Permissions.") != std::string::npos;
        if (is_right && property.name() == self_made.name()) property = self_made;
      }
    }
    participant_ = fastdds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<std::uint32_t>(options.domain), qos);
    if (participant_ == nullptr) throw std::runtime_error("Fast DDS refuses the participant");
    fastdds::TypeSupport type(new topics::Path::Type());
    type.register_type(participant_);
    fastdds::PublisherQos publisher_qos;
    publisher_qos.partition().push_back(options.partition.c_str());
    auto* const topic = participant_->create_topic(std::string("rt/") + topics::Path::kName,
                                                   type.get_type_name(), fastdds::TOPIC_QOS_DEFAULT);
    writer_ = participant_->create_publisher(publisher_qos)
                  ->create_datawriter(topic, WriterQosFrom(topics::Path::kDelivery));
  }
  ~SelfMadeExplorer() {
    participant_->delete_contained_entities();
    fastdds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  SelfMadeExplorer(const SelfMadeExplorer&) = delete;
  SelfMadeExplorer& operator=(const SelfMadeExplorer&) = delete;

  bool has_writer() const { return writer_ != nullptr; }
  int readers() const {
    fastdds::PublicationMatchedStatus status;
    writer_->get_publication_matched_status(status);
    return status.current_count;
  }
  void Write(nav_msgs::msg::Path path) const { writer_->write(&path); }

 private:
  fastdds::DomainParticipant* participant_;
  fastdds::DataWriter* writer_;
};

TEST_F(Security, AListenerThatGrantsItselfRightsGainsNone) {
  const KeyFolder keys("keys", "--role listener --role explorer --role controller");
  const fs::path table = keys.path() / "own-roles.txt";
  std::ofstream(table) << "listener publishes explorer/path health\n";
  const KeyFolder self_made("self-made", "--roles '" + table.string() + "'");
  Controller controller(Secure("controller", keys));
  SelfMadeExplorer forger(WithoutKeys("listener"), keys.path(), self_made.path());
  ASSERT_TRUE(forger.has_writer());

  Bus explorer(Secure("explorer", keys));
  const auto genuine = explorer.Advertise<topics::Path>();
  AwaitMatch(explorer, genuine, controller.bus);
  forger.Write(PathNamed("forged"));
  genuine.Write(PathNamed("genuine"));
  EXPECT_TRUE(controller.Hears("genuine"));
  EXPECT_EQ(controller.heard, std::vector<std::string>{"genuine"});
  EXPECT_EQ(forger.readers(), 0);
}

/// A participant with the keys of one role and the name of another, which says how it is.
class Impostor {
 public:
  Impostor(const BusOptions& options, const fs::path& keys, const std::string& role) {
    const auto own = CheckKeys(keys, role, std::chrono::system_clock::now());
    const auto qos = ParticipantQosFrom(options, std::make_shared<Guard>(), own);
    participant_ = fastdds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<std::uint32_t>(options.domain), qos);
    if (participant_ == nullptr) throw std::runtime_error("Fast DDS refuses the participant");
    fastdds::TypeSupport type(new topics::Health::Type());
    type.register_type(participant_);
    fastdds::PublisherQos publisher_qos;
    publisher_qos.partition().push_back(options.partition.c_str());
    auto* const topic = participant_->create_topic(std::string("rt/") + topics::Health::kName,
                                                   type.get_type_name(), fastdds::TOPIC_QOS_DEFAULT);
    writer_ = participant_->create_publisher(publisher_qos)
                  ->create_datawriter(topic, WriterQosFrom(topics::Health::kDelivery));
  }
  ~Impostor() {
    participant_->delete_contained_entities();
    fastdds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Impostor(const Impostor&) = delete;
  Impostor& operator=(const Impostor&) = delete;

  void Write(thalweg_msgs::msg::ServiceHealth health) const { writer_->write(&health); }

 private:
  fastdds::DomainParticipant* participant_;
  fastdds::DataWriter* writer_ = nullptr;
};

/// Whether a mapper with keys ends because of the health of an older one, whose keys are those of a role.
bool EndsForAnOlderMapperWithKeysOf(const std::string& role, const KeyFolder& keys) {
  BusOptions options = Secure("mapper", keys);
  options.publish_health = true;
  options.sole = true;
  Bus mapper(options);
  int heard = 0;
  mapper.Subscribe<topics::Health>([&](const auto& health) { heard += health.host() == "impostor" ? 1 : 0; });
  const Impostor older(WithoutKeys("mapper"), keys.path(), role);
  thalweg_msgs::msg::ServiceHealth health;
  health.service("mapper");
  health.host("impostor");
  health.instance(1);
  health.uptime_s(1e6);
  mapper.EveryWall(std::chrono::milliseconds(20), [&] { older.Write(health); });
  try {
    EXPECT_TRUE(mapper.SpinUntil([&] { return heard >= 5; }, kPatience));
    return false;
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("another mapper runs in this domain already"));
    return true;
  }
}

TEST_F(Security, AListenerThatTakesAServicesNameDoesNotEndIt) {
  const KeyFolder keys("keys", "--role listener --role mapper");
  EXPECT_FALSE(EndsForAnOlderMapperWithKeysOf("listener", keys));
  EXPECT_TRUE(EndsForAnOlderMapperWithKeysOf("mapper", keys));
}

/// Records the RTPS datagrams of a domain that cross this machine's loopback interface. Needs CAP_NET_RAW.
class Eavesdropper {
 public:
  struct Datagram {
    sockaddr_in to;
    Bytes bytes;
  };

  explicit Eavesdropper(int domain)
      : first_port_(7400 + 250 * domain), socket_(socket(AF_PACKET, SOCK_DGRAM, htons(ETH_P_IP))) {
    if (socket_ < 0) return;
    sockaddr_ll interface {};
    interface.sll_family = AF_PACKET;
    interface.sll_protocol = htons(ETH_P_IP);
    interface.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
    bind(socket_, reinterpret_cast<const sockaddr*>(&interface), sizeof interface);
    const timeval patience{.tv_sec = 0, .tv_usec = 50'000};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    recording_ = std::thread([this] { Record(); });
  }
  ~Eavesdropper() {
    stopped_ = true;
    if (recording_.joinable()) recording_.join();
    if (socket_ >= 0) close(socket_);
  }
  Eavesdropper(const Eavesdropper&) = delete;
  Eavesdropper& operator=(const Eavesdropper&) = delete;

  bool hears() const { return socket_ >= 0; }
  std::vector<Datagram> Recorded() const {
    const std::lock_guard lock(mutex_);
    return recorded_;
  }

 private:
  void Record() {
    Bytes packet(1 << 16);
    while (!stopped_) {
      const ssize_t size = recv(socket_, packet.data(), packet.size(), 0);
      if (size < 0) continue;
      const std::size_t ip_bytes = std::size_t{4} * (packet[0] & 0x0fU);
      const std::size_t header = ip_bytes + sizeof(udphdr);
      if (packet[9] != IPPROTO_UDP || static_cast<std::size_t>(size) < header + 4) continue;
      const int port = packet[ip_bytes + 2] << 8 | packet[ip_bytes + 3];
      if (port < first_port_ || port >= first_port_ + 250) continue;
      if (std::memcmp(&packet[header], "RTPS", 4) != 0) continue;
      Datagram datagram{};
      datagram.to.sin_family = AF_INET;
      datagram.to.sin_port = htons(static_cast<std::uint16_t>(port));
      std::memcpy(&datagram.to.sin_addr, &packet[16], 4);
      datagram.bytes.assign(packet.begin() + static_cast<std::ptrdiff_t>(header), packet.begin() + size);
      const std::lock_guard lock(mutex_);
      recorded_.push_back(std::move(datagram));
    }
  }

  int first_port_;
  int socket_;
  std::atomic<bool> stopped_ = false;
  mutable std::mutex mutex_;
  std::vector<Datagram> recorded_;
  std::thread recording_;
};

/// Where the submessage of this kind begins; 0 if there is none.
std::size_t FindSubmessage(const Bytes& datagram, std::uint8_t kind) {
  std::size_t at = 20;
  while (at + 4 <= datagram.size()) {
    if (datagram[at] == kind) return at;
    const std::size_t length = datagram[at + 2] | std::size_t{datagram[at + 3]} << 8;  // little-endian
    if (length == 0) return 0;
    at += 4 + length;
  }
  return 0;
}

bool IsEncrypted(const Bytes& datagram) {
  constexpr std::uint8_t kSecurePrefix = 0x31;  // DDS-SECURITY 1.1, section 7.3.6.2
  return FindSubmessage(datagram, kSecurePrefix) > 0;
}

void Send(const Eavesdropper::Datagram& datagram) {
  static const int sender = socket(AF_INET, SOCK_DGRAM, 0);
  sendto(sender, datagram.bytes.data(), datagram.bytes.size(), 0,
         reinterpret_cast<const sockaddr*>(&datagram.to), sizeof datagram.to);
}

TEST_F(Security, WithoutItAnEavesdropperRepeatsAPathAsANewOne) {
  Controller controller(WithoutKeys("controller"));
  Bus explorer(WithoutKeys("explorer"));
  const auto path_out = explorer.Advertise<topics::Path>();
  AwaitMatch(explorer, path_out, controller.bus);
  const Eavesdropper attacker(BusOptionsForTest("").domain);
  if (!attacker.hears()) GTEST_SKIP() << "needs the capability to read raw packets";
  path_out.Write(PathNamed("overheard"));
  ASSERT_TRUE(controller.Hears("overheard"));

  const auto repeat = [&] {
    for (Eavesdropper::Datagram datagram : attacker.Recorded()) {
      const std::string text(datagram.bytes.begin(), datagram.bytes.end());
      constexpr std::uint8_t kData = 0x15;
      const std::size_t data = FindSubmessage(datagram.bytes, kData);
      if (data == 0 || text.find("overheard") == std::string::npos) continue;
      ++datagram.bytes[data + 20];  // the low byte of its sequence number
      Send(datagram);
    }
  };
  controller.bus.EveryWall(std::chrono::milliseconds(20), repeat);
  EXPECT_TRUE(controller.bus.SpinUntil([&] { return controller.heard.size() >= 2; }, kPatience));
}

Bytes Joined(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) {
    for (const std::uint8_t byte : part) all.push_back(byte);
  }
  return all;
}

/// A submessage in little-endian order.
Bytes PlainSubmessage(std::uint8_t kind, std::uint8_t flags, const std::vector<Bytes>& parts) {
  const Bytes body = Joined(parts);
  const auto low = static_cast<std::uint8_t>(body.size());
  const auto high = static_cast<std::uint8_t>(body.size() >> 8U);
  return Joined({{kind, flags, low, high}, body});
}

/// A path in plain text with the sender's prefix of another, as the 5000th sample of a writer.
Bytes ForgedPath(const Bytes& prefix, std::uint8_t writer_number, std::uint8_t writer_kind) {
  const Bytes entities = {0, 0, 0, 0, 0, 0, writer_number, writer_kind};  // to any reader
  const Bytes number = {0, 0, 0, 0, 0x88, 0x13, 0, 0};
  const Bytes before = {0, 0, 0, 0, 0x88, 0x0f, 0, 0};  // by 1024
  return Joined({{'R', 'T', 'P', 'S', 2, 3, 1, 15},
                 prefix,
                 // A heartbeat as well: the reader then waits for nothing before that sample.
                 PlainSubmessage(0x07, 1, {entities, number, number, {0xff, 0xff, 0, 0}}),
                 PlainSubmessage(0x08, 1, {entities, before, number, Bytes(4)}),
                 PlainSubmessage(
                     0x15, 5, {{0, 0, 16, 0}, entities, number, Encode<topics::Path>(PathNamed("forged"))})});
}

TEST_F(Security, PlainTextUnderTheNameOfAPeerIsRefused) {
  const KeyFolder keys("keys", "--role explorer --role controller");
  const Eavesdropper attacker(BusOptionsForTest("").domain);
  if (!attacker.hears()) GTEST_SKIP() << "needs the capability to read raw packets";
  BusOptions options = Secure("controller", keys);
  options.publish_health = true;  // and count what is refused
  Controller controller(options);
  Bus explorer(Secure("explorer", keys));
  const auto path_out = explorer.Advertise<topics::Path>();
  AwaitMatch(explorer, path_out, controller.bus);

  Bytes prefix;  // of the explorer, from its announcement, which is in clear text
  std::set<std::uint16_t> ports;
  for (const auto& datagram : attacker.Recorded()) {
    ports.insert(datagram.to.sin_port);
    const std::string text(datagram.bytes.begin(), datagram.bytes.end());
    if (text.find(std::string("explorer") + '\0') == std::string::npos) continue;
    prefix.assign(datagram.bytes.begin() + 8, datagram.bytes.begin() + 20);
  }
  ASSERT_EQ(prefix.size(), 12U);
  for (std::uint8_t number = 1; number < 20; ++number) {
    for (const std::uint8_t kind : {0x02, 0x03}) {  // with a key and without
      Eavesdropper::Datagram forged{.to = {}, .bytes = ForgedPath(prefix, number, kind)};
      forged.to.sin_family = AF_INET;
      forged.to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      for (const std::uint16_t port : ports) {
        forged.to.sin_port = port;
        Send(forged);
      }
    }
  }
  const auto refused = [&] {
    const thalweg_msgs::msg::ServiceHealth health = controller.bus.health().ToMessage(Time{});
    for (const auto& counter : health.rejected()) {
      if (counter.last().find("not encrypted") != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(controller.bus.SpinUntil([&] { return refused() || !controller.heard.empty(); }, kPatience));
  path_out.Write(PathNamed("genuine"));
  EXPECT_TRUE(controller.Hears("genuine"));
  EXPECT_EQ(controller.heard, std::vector<std::string>{"genuine"});
}

TEST_F(Security, WithKeysNothingArrivesPastTheGuard) {
  const KeyFolder keys("keys", "--role mapper");
  const auto now = std::chrono::system_clock::now();
  const auto transports = [&](const std::optional<SecurityKeys>& its) {
    const BusOptions options = BusOptionsForTest("mapper");
    return ParticipantQosFrom(options, std::make_shared<Guard>(), its).transport().user_transports.size();
  };
  EXPECT_EQ(transports(std::nullopt), 2U) << "shared memory and UDP";
  EXPECT_EQ(transports(CheckKeys(keys.path(), "mapper", now)), 1U);
}

TEST_F(Security, ReplayedAndChangedDatagramsDoNothing) {
  const KeyFolder keys("keys", "--role explorer --role controller");
  const Eavesdropper attacker(BusOptionsForTest("").domain);
  if (!attacker.hears()) GTEST_SKIP() << "needs the capability to read raw packets";
  Controller controller(Secure("controller", keys));
  Bus explorer(Secure("explorer", keys));
  const auto path_out = explorer.Advertise<topics::Path>();
  AwaitMatch(explorer, path_out, controller.bus);
  for (const std::string name : {"first", "second", "third"}) {
    path_out.Write(PathNamed(name));
    ASSERT_TRUE(controller.Hears(name));
  }
  const auto overheard = attacker.Recorded();
  const auto encrypted = [](const auto& datagram) { return IsEncrypted(datagram.bytes); };
  ASSERT_GT(std::ranges::count_if(overheard, encrypted), 3);
  for (const auto& datagram : overheard) {
    const std::string text(datagram.bytes.begin(), datagram.bytes.end());
    EXPECT_EQ(text.find("second"), std::string::npos);
  }

  // All of it again, the handshake as well, and then with errors in what is encrypted.
  for (const auto& datagram : overheard) Send(datagram);
  std::mt19937 random(1);
  for (int round = 0; round < 5; ++round) {
    for (Eavesdropper::Datagram datagram : overheard) {
      if (!encrypted(datagram)) continue;
      const std::size_t at = 20 + random() % (datagram.bytes.size() - 20);
      datagram.bytes[at] = static_cast<std::uint8_t>(random());
      Send(datagram);
    }
  }
  path_out.Write(PathNamed("last"));
  EXPECT_TRUE(controller.Hears("last"));
  EXPECT_EQ(controller.heard, (std::vector<std::string>{"first", "second", "third", "last"}));
}

}  // namespace
}  // namespace thalweg::dds
