#include "common/dds/bus_participant.h"

#include <algorithm>
#include <atomic>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "common/dds/qos.h"
#include "common/dds/rtps_ports.h"
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

/// @return nullptr if Fast DDS rejects the participant.
fastdds::DomainParticipant* Create(const BusOptions& options, const fastdds::DomainParticipantQos& qos,
                                   Peers& peers) {
  return fastdds::DomainParticipantFactory::get_instance()->create_participant(
      static_cast<std::uint32_t>(options.domain), qos, &peers, fastdds::StatusMask::none());
}

/// An ID for a participant that takes the place of another. A GUID follows from the ID, and whoever knew a
/// GUID before takes what a new participant announces under it for what was announced long ago: no ID may
/// come twice in a process. Those of first participants are smaller.
int NextId(int domain) {
  static std::atomic<int> next = 1000;
  const int id = next++;
  if (FirstPortOf(domain, id) >= kLastPort) {  // where Fast DDS would end the process without a word
    throw std::runtime_error("DDS: no participant can be made again in domain " + std::to_string(domain) +
                             ", the numbers of its participants are used up");
  }
  return id;
}

}  // namespace

BusParticipant::BusParticipant(const BusOptions& options, std::shared_ptr<Guard> guard, Peers& peers)
    : options_(options), guard_(std::move(guard)), peers_(peers) {
  if (options.domain < 0 || options.domain > 232) {
    throw std::runtime_error("DDS: domain must be 0 to 232, is " + std::to_string(options.domain));
  }
  names_.Check();
  if (!options.security_dir.empty()) {
    keys_ = CheckKeys(options.security_dir, options.name, std::chrono::system_clock::now());
  }
  if (options.shared_memory) RemoveStaleFiles();
  const std::scoped_lock lock(creation);
  const Qos qos = ParticipantQosFrom(options, guard_, keys_);
  shared_ports_ = SharedPortsOf(qos);
  participant_ = Create(options, qos, peers_);
  Equip();
}

BusParticipant::~BusParticipant() {
  Delete();
}

BusParticipant::Qos BusParticipant::Successor(bool udp_alone) const {
  BusOptions options = options_;
  options.shared_memory = options.shared_memory && !udp_alone;
  return ParticipantQosFrom(options, guard_, keys_);
}

void BusParticipant::Replace(const Qos& successor) {
  Delete();
  peers_.Forget();
  Qos qos = successor;
  shared_ports_ = SharedPortsOf(qos);
  qos.wire_protocol().participant_id = NextId(options_.domain);
  {
    const std::scoped_lock lock(creation);
    participant_ = Create(options_, qos, peers_);
  }
  Equip();
  for (auto& [name, type] : types_) {
    if (type.register_type(participant_) != ReturnCode_t::RETCODE_OK) throw Failed("type", name);
  }
  for (auto& [name, topic] : topics_) topic.topic = NewTopic(name, topic.type->getName());
}

void BusParticipant::Equip() {
  const std::string its_name = options_.name + "\" in domain \"" + std::to_string(options_.domain);
  if (participant_ == nullptr) {
    const std::string with_keys = keys_ ? ", with the keys in " + keys_->folder.string() : "";
    throw std::runtime_error(Failed("participant", its_name).what() + with_keys);
  }
  if (!options_.hears_itself) ignored_ = participant_->guid().guidPrefix;
  fastdds::PublisherQos publisher_qos;
  fastdds::SubscriberQos subscriber_qos;
  if (!options_.partition.empty()) {
    publisher_qos.partition().push_back(options_.partition.c_str());
    subscriber_qos.partition().push_back(options_.partition.c_str());
  }
  publisher_ = participant_->create_publisher(publisher_qos);
  subscriber_ = participant_->create_subscriber(subscriber_qos);
  if (publisher_ == nullptr || subscriber_ == nullptr) {
    Delete();
    throw Failed("publisher and subscriber of participant", its_name);
  }
}

void BusParticipant::Delete() {
  if (participant_ == nullptr) return;
  if (shared_ports_) ReplaceLockedPorts(*shared_ports_);
  participant_->delete_contained_entities();
  fastdds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  participant_ = nullptr;
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

BusParticipant::Topic BusParticipant::TopicOf(const std::string& name, TypeSupport generated) {
  auto type = std::make_unique<CheckedType>(std::move(generated));
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
  auto* const topic = NewTopic(name, type_name);
  return topics_.emplace(name, Topic{static_cast<CheckedType*>(known->second.get()), topic}).first->second;
}

fastdds::Topic* BusParticipant::NewTopic(const std::string& name, const std::string& type_name) {
  // The names that ROS 2 uses.
  auto* const topic =
      participant_->create_topic(WireTopic(names_.Topic(name)), type_name, fastdds::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) throw Failed("topic", name);
  return topic;
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
