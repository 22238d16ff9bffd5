#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "common/dds/bus.h"
#include "common/dds/checked_type.h"
#include "common/dds/guarded_transport.h"
#include "common/dds/peers.h"
#include "common/dds/security.h"
#include "common/dds/type_support.h"

namespace thalweg::dds {

/// The participant of a bus with its types, topics, writers and readers.
///
/// Threading: the thread that made it, but for what Fast DDS calls.
/// Errors: the constructor and functions that create something throw std::runtime_error naming what failed.
class BusParticipant {
 public:
  struct Topic {
    CheckedType* type;
    eprosima::fastdds::dds::Topic* topic;
  };

  using Qos = eprosima::fastdds::dds::DomainParticipantQos;

  /// @param guard  Shared with its transport.
  /// @param peers  Learns of others; must outlive this object.
  BusParticipant(const BusOptions& options, std::shared_ptr<Guard> guard, Peers& peers);
  /// Deletes everything that was created; what listens to writers and readers must still exist.
  ~BusParticipant();
  BusParticipant(const BusParticipant&) = delete;
  BusParticipant& operator=(const BusParticipant&) = delete;

  /// Describes a participant that may take the place of this one. Throws std::runtime_error if there can be
  /// none at present, e.g. since the name of a peer cannot be resolved.
  /// @param udp_alone  Whether it must not use shared memory.
  Qos Successor(bool udp_alone) const;
  /// Deletes everything that was created, as the destructor, and makes the successor with the same types and
  /// topics, but without writers and readers. To others it is a participant that they do not know yet.
  void Replace(const Qos& successor);

  /// The topic of this name, made on first use.
  /// @param generated  Its type; owned by the callee. Throws if the topic already exists with another type,
  ///                   since its samples would be cast to the wrong one.
  Topic TopicOf(const std::string& name, TypeSupport generated);
  /// The topic of this name, which exists.
  const Topic& KnownTopic(const std::string& name) const { return topics_.at(name); }

  eprosima::fastdds::dds::DataWriter* NewWriter(const std::string& name, const Topic& topic,
                                                Delivery delivery,
                                                eprosima::fastdds::dds::DataWriterListener& listener);
  eprosima::fastdds::dds::DataReader* NewReader(const TopicInfo& info, const Topic& topic, bool best_effort,
                                                Keep keep,
                                                eprosima::fastdds::dds::DataReaderListener& listener);
  void Delete(eprosima::fastdds::dds::DataReader* reader);

  const Names& names() const { return names_; }
  const std::optional<SecurityKeys>& keys() const { return keys_; }
  /// Whether another participant may be a copy of this one: with keys, it proved the same identity.
  bool MayBeCopy(const eprosima::fastrtps::rtps::GuidPrefix_t& other) const;
  /// This participant, if it is deaf to itself.
  const std::optional<eprosima::fastrtps::rtps::GuidPrefix_t>& ignored() const { return ignored_; }

 private:
  /// Makes publisher and subscriber for a participant that was made.
  void Equip();
  void Delete();
  eprosima::fastdds::dds::Topic* NewTopic(const std::string& name, const std::string& type_name);
  /// An entity that Fast DDS did not create, because the role does not allow it or for another reason.
  std::runtime_error Refused(const char* verb, const std::string& entity, const std::string& topic) const;

  const BusOptions options_;
  const Names& names_ = options_.names;
  const std::shared_ptr<Guard> guard_;
  Peers& peers_;
  std::optional<SecurityKeys> keys_;
  std::optional<eprosima::fastrtps::rtps::GuidPrefix_t> ignored_;
  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
  std::optional<std::uint32_t> shared_ports_;  ///< The first of its ports in shared memory, if it has any.
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
  std::map<std::string, eprosima::fastdds::dds::TypeSupport> types_;  ///< By name of the type.
  std::map<std::string, Topic> topics_;
};

}  // namespace thalweg::dds
