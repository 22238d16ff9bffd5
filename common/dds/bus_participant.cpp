#include "common/dds/bus_participant.h"

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "common/dds/qos.h"
#include "common/dds/shared_memory_files.h"
#include "common/dds/shared_memory_ports.h"

namespace thalweg::dds {
namespace {

namespace fastdds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

std::runtime_error Failed(const std::string& what, const std::string& name) {
  return std::runtime_error("DDS: cannot create " + what + " \"" + name + "\"");
}

constexpr auto kKeysHaveNames =
    "; keys are made for a robot's names, by deploy/make-keys with --robot and --topic";

/// Guards the creation of participants: Fast DDS may assign the same ID to two that are created at the same
/// time, and then rejects the second.
std::mutex creation;

/// An ID is chosen for its ports in one domain, but Fast DDS 2.9 rejects one that another participant of this
/// process has in whatever domain. It does not report why, nor which IDs are taken; another choice helps.
constexpr int kChoicesOfId = 8;

/// @return nullptr if Fast DDS rejects the participant.
fastdds::DomainParticipant* Create(const BusOptions& options, const std::shared_ptr<Guard>& guard,
                                   const std::optional<SecurityKeys>& keys, Peers& peers) {
  const std::scoped_lock lock(creation);
  for (int choice = 1;; ++choice) {
    const fastdds::DomainParticipantQos qos = ParticipantQosFrom(options, guard, keys);
    auto* const participant = fastdds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<std::uint32_t>(options.domain), qos, &peers, fastdds::StatusMask::none());
    const bool chose_id = qos.wire_protocol().participant_id >= 0;
    if (participant != nullptr || !chose_id || choice == kChoicesOfId) return participant;
  }
}

}  // namespace

BusParticipant::BusParticipant(const BusOptions& options, std::shared_ptr<Guard> guard, Peers& peers)
    : names_(options.names) {
  if (options.domain < 0 || options.domain > 232) {
    throw std::runtime_error("DDS: domain must be 0 to 232, is " + std::to_string(options.domain));
  }
  names_.Check();
  const std::string its_name = options.name + "\" in domain \"" + std::to_string(options.domain);
  if (!options.security_dir.empty()) {
    keys_ = CheckKeys(options.security_dir, options.name, std::chrono::system_clock::now());
  }
  if (options.shared_memory) RemoveStaleFiles();
  participant_ = Create(options, guard, keys_, peers);
  if (participant_ == nullptr) {
    const std::string with_keys = keys_ ? ", with the keys in " + keys_->folder.string() : "";
    throw std::runtime_error(Failed("participant", its_name).what() + with_keys);
  }
  if (!options.hears_itself) ignored_ = participant_->guid().guidPrefix;
  fastdds::PublisherQos publisher_qos;
  fastdds::SubscriberQos subscriber_qos;
  if (!options.partition.empty()) {
    publisher_qos.partition().push_back(options.partition.c_str());
    subscriber_qos.partition().push_back(options.partition.c_str());
  }
  publisher_ = participant_->create_publisher(publisher_qos);
  subscriber_ = participant_->create_subscriber(subscriber_qos);
  if (publisher_ == nullptr || subscriber_ == nullptr) {
    fastdds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
    throw Failed("publisher and subscriber of participant", its_name);
  }
}

BusParticipant::~BusParticipant() {
  // Only a participant that has ports in shared memory chose its ID.
  if (const int id = participant_->get_qos().wire_protocol().participant_id; id >= 0) {
    ReplaceLockedPorts(static_cast<int>(participant_->get_domain_id()), id);
  }
  participant_->delete_contained_entities();
  fastdds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

bool BusParticipant::MayBeCopy(const eprosima::fastrtps::rtps::GuidPrefix_t& other) const {
  // With security, a prefix begins with a hash of the identity's name, which the handshake compares with the
  // certificate [DDS-SECURITY 1.1, section 9.3.3]. The participant's name proves nothing.
  constexpr std::size_t kIdentityBytes = 6;
  const auto& own = participant_->guid().guidPrefix;
  return !keys_ || std::equal(own.value, own.value + kIdentityBytes, other.value);
}

std::runtime_error BusParticipant::Refused(const char* verb, const std::string& entity,
                                           const std::string& topic) const {
  if (!keys_) return Failed(entity, topic);
  return std::runtime_error(std::string(Failed(entity, topic).what()) + ": the permissions of role \"" +
                            keys_->role + "\" in " + keys_->folder.string() + " do not allow it to " + verb +
                            " the topic" + (names_.renames_topics() ? kKeysHaveNames : ""));
}

BusParticipant::Topic BusParticipant::TopicOf(const std::string& name, fastdds::TopicDataType* generated) {
  auto type = std::make_unique<CheckedType>(std::unique_ptr<fastdds::TopicDataType>(generated));
  const std::string type_name = type->getName();
  const auto check_use = [&](const CheckedType& known) {
    if (known.decodes() == type->decodes()) return;
    throw std::runtime_error("DDS: " + type_name + " of topic \"" + name +
                             "\" cannot be used both decoded and undecoded on one bus");
  };
  if (const auto found = topics_.find(name); found != topics_.end()) {
    check_use(*found->second.type);
    const std::string known_name = found->second.type->getName();
    if (known_name == type_name) return found->second;
    throw std::runtime_error("DDS: topic \"" + name + "\" carries " + known_name + ", it cannot carry " +
                             type_name + " as well");
  }
  auto known = types_.find(type_name);
  if (known == types_.end()) {
    fastdds::TypeSupport support(type.release());
    if (support.register_type(participant_) != ReturnCode_t::RETCODE_OK) {
      throw Failed("type", type_name);
    }
    known = types_.emplace(type_name, std::move(support)).first;
  } else {
    check_use(*static_cast<CheckedType*>(known->second.get()));
  }
  // The names that ROS 2 uses.
  auto* const topic =
      participant_->create_topic(WireTopic(names_.Topic(name)), type_name, fastdds::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) throw Failed("topic", name);
  return topics_.emplace(name, Topic{static_cast<CheckedType*>(known->second.get()), topic}).first->second;
}

fastdds::DataWriter* BusParticipant::NewWriter(const std::string& name, const Topic& topic, Delivery delivery,
                                               fastdds::DataWriterListener& listener) {
  const auto mask = fastdds::StatusMask::publication_matched()
                    << fastdds::StatusMask::offered_incompatible_qos();
  auto qos = WriterQosFrom(delivery);
  AnnounceTypeHash(qos, topic.type->getName());
  auto* const writer = publisher_->create_datawriter(topic.topic, qos, &listener, mask);
  if (writer == nullptr) throw Refused("publish", "writer", name);
  return writer;
}

fastdds::DataReader* BusParticipant::NewReader(const TopicInfo& info, const Topic& topic, bool best_effort,
                                               Keep keep, fastdds::DataReaderListener& listener) {
  const auto mask = fastdds::StatusMask::subscription_matched()
                    << fastdds::StatusMask::requested_incompatible_qos();
  auto qos = ReaderQosFrom(info.delivery, best_effort, keep);
  AnnounceTypeHash(qos, topic.type->getName());
  auto* const reader = subscriber_->create_datareader(topic.topic, qos, &listener, mask);
  if (reader == nullptr) throw Refused("subscribe to", "reader", info.name);
  reader->get_statuscondition().set_enabled_statuses(fastdds::StatusMask::data_available());
  return reader;
}

void BusParticipant::Delete(fastdds::DataReader* reader) {
  subscriber_->delete_datareader(reader);
}

}  // namespace thalweg::dds
