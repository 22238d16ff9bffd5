#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time.h"

namespace thalweg::dds {

// Who is on the bus, and what each offers and asks for, as discovery reports it; and what does not fit
// together.

enum class Durability {  ///< Each includes those before it.
  kVolatile,
  kTransientLocal,
  kTransient,
  kPersistent
};
enum class Liveliness { kAutomatic, kManualByParticipant, kManualByTopic };  ///< As in DDS.

/// The policies that decide whether a writer and a reader match [OMG DDS 1.4, section 2.2.3].
struct EndpointQos {
  bool reliable = false;
  Durability durability = Durability::kVolatile;
  std::optional<Duration> deadline = {};  ///< Nothing = infinite.
  Liveliness liveliness = Liveliness::kAutomatic;
  std::optional<Duration> lease = {};     ///< Nothing = infinite.
  bool exclusive = false;                 ///< Ownership.
  bool by_source_stamp = false;           ///< Destination order.
  std::optional<Duration> lifespan = {};  ///< For a writer; nothing = infinite.
};

/// "reliable, transient local, deadline 0.25 s": what differs from the defaults only where it does.
std::string TextOf(const EndpointQos& qos);

struct Endpoint {
  std::string participant;  ///< Participant::id
  bool writes = false;      ///< A writer, else a reader.
  std::string topic;        ///< As on the wire: "rt/odometry".
  std::string type;         ///< As on the wire.
  EndpointQos qos = {};
  std::vector<std::string> partitions = {};  ///< Patterns; empty = the default partition.
};

struct Participant {
  std::string id;       ///< Unique; the GUID's prefix.
  std::string name;     ///< As it says; may be empty.
  std::string address;  ///< IPv4, or empty.
  std::string host;     ///< Name of its machine; empty where it does not say.
  std::string process;  ///< Its number on that machine; empty where it does not say.
  std::string vendor;   ///< "eProsima Fast DDS", or its number.
  std::string version;  ///< The process's version of thalweg; empty for other programs.
  bool is_discovery_server = false;
};

struct BusGraph {
  std::vector<Participant> participants;
  std::vector<Endpoint> endpoints;

  const Participant* Find(const std::string& id) const;
  /// "mapper" (12345), for people.
  std::string NameOf(const std::string& id) const;
};

/// "odometry" for "rt/odometry"; nothing for a topic that is none of ROS 2's.
std::optional<std::string> TopicName(std::string_view wire_topic);
std::string WireTopic(std::string_view topic_name);  ///< The inverse.
/// The name of any topic, for people: without ROS 2's prefix, as CleanText.
std::string ShownTopic(std::string_view wire_topic);

/// A writer and a reader of one topic that exchange nothing.
struct Mismatch {
  std::string topic;
  std::string text;    ///< A sentence: who offers what, and who asks for what.
  std::string advice;  ///< What to do.
};

/// All of them, in the order of topics.
std::vector<Mismatch> FindMismatches(const BusGraph& graph);

}  // namespace thalweg::dds
