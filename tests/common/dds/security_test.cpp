#include "common/dds/security.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/dds/qos.h"
#include "tests/common/dds/security_fixture.h"

namespace thalweg::dds {
namespace {

namespace fastdds = eprosima::fastdds::dds;
namespace fs = std::filesystem;
using test::AwaitMatch;
using test::KeyFolder;
using test::kPatience;
using testing::HasSubstr;

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
  for (unsigned k = 0; k < 300'000; ++k) cloud.data().push_back(static_cast<std::uint8_t>(k * k));
  std::vector<std::uint8_t> received;
  mapper.Subscribe<topics::DepthPoints>([&](const auto& message) { received = message.data(); });
  AwaitMatch(simulator, cloud_out, mapper);
  cloud_out.Write(cloud);
  ASSERT_TRUE(mapper.SpinUntil([&] { return !received.empty(); }, kPatience));
  EXPECT_EQ(received, cloud.data());
}

INSTANTIATE_TEST_SUITE_P(SharedMemory, SecureTransport, testing::Bool());

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

/// A writer of one topic that Fast DDS alone makes, of a participant as someone else would set it up.
template <typename Topic>
class ForeignWriter {
 public:
  ForeignWriter(const BusOptions& options, const fastdds::DomainParticipantQos& qos)
      : participant_(fastdds::DomainParticipantFactory::get_instance()->create_participant(
            static_cast<std::uint32_t>(options.domain), qos)) {
    if (participant_ == nullptr) throw std::runtime_error("Fast DDS refuses the participant");
    fastdds::TypeSupport type(TypeSupportOf<Topic>().release());
    type.register_type(participant_);
    fastdds::PublisherQos publisher_qos;
    publisher_qos.partition().push_back(options.partition.c_str());
    auto* const topic = participant_->create_topic(std::string("rt/") + Topic::kName, type.get_type_name(),
                                                   fastdds::TOPIC_QOS_DEFAULT);
    writer_ = participant_->create_publisher(publisher_qos)
                  ->create_datawriter(topic, WriterQosFrom(Topic::kDelivery));
  }
  ~ForeignWriter() {
    participant_->delete_contained_entities();
    fastdds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  ForeignWriter(const ForeignWriter&) = delete;
  ForeignWriter& operator=(const ForeignWriter&) = delete;

  bool has_writer() const { return writer_ != nullptr; }
  int readers() const {
    fastdds::PublicationMatchedStatus status;
    writer_->get_publication_matched_status(status);
    return status.current_count;
  }
  void Write(MessageOf<Topic> message) const { writer_->write(&message); }

 private:
  fastdds::DomainParticipant* participant_;
  fastdds::DataWriter* writer_ = nullptr;
};

/// A participant with the identity of one folder and permissions that it gave itself, in another.
ForeignWriter<topics::Path> SelfMadeExplorer(const BusOptions& options, const fs::path& identity,
                                             const fs::path& rights) {
  const auto now = std::chrono::system_clock::now();
  auto qos = ParticipantQosFrom(options, std::make_shared<Guard>(), CheckKeys(identity, options.name, now));
  const auto own = PropertiesFrom(CheckKeys(rights, options.name, now));
  for (auto& property : qos.properties().properties()) {
    for (const auto& self_made : own.properties()) {
      const bool is_right = property.name().find("Access-Permissions.") != std::string::npos;
      if (is_right && property.name() == self_made.name()) property = self_made;
    }
  }
  return {options, qos};
}

TEST_F(Security, AListenerThatGrantsItselfRightsGainsNone) {
  const KeyFolder keys("keys", "--role listener --role explorer --role controller");
  const fs::path table = keys.path() / "own-roles.txt";
  std::ofstream(table) << "listener publishes explorer/path health\n";
  const KeyFolder self_made("self-made", "--roles '" + table.string() + "'");
  Controller controller(Secure("controller", keys));
  const auto forger = SelfMadeExplorer(WithoutKeys("listener"), keys.path(), self_made.path());
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
ForeignWriter<topics::Health> Impostor(const BusOptions& options, const fs::path& keys,
                                       const std::string& role) {
  const auto own = CheckKeys(keys, role, std::chrono::system_clock::now());
  return {options, ParticipantQosFrom(options, std::make_shared<Guard>(), own)};
}

/// Whether a mapper with keys ends because of the health of an older one, whose keys are those of a role.
bool EndsForAnOlderMapperWithKeysOf(const std::string& role, const KeyFolder& keys) {
  BusOptions options = Secure("mapper", keys);
  options.publish_health = true;
  options.sole = true;
  Bus mapper(options);
  int heard = 0;
  mapper.Subscribe<topics::Health>([&](const auto& health) { heard += health.host() == "impostor" ? 1 : 0; });
  const auto older = Impostor(WithoutKeys("mapper"), keys.path(), role);
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

}  // namespace
}  // namespace thalweg::dds
