#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/dds/bus_graph.h"
#include "common/dds/topic_table.h"
#include "services/inspector/adapter/message_definitions.h"
#include "services/inspector/core/schema.h"

namespace thalweg::inspector {

/// A topic whose messages can be decoded.
struct OpenTopic {
  dds::TopicInfo info;
  std::string type;        ///< "nav_msgs/msg/Odometry"
  std::string definition;  ///< The type's, as Schema::Parse takes it and recordings hold it.
  Schema schema;
};

/// "odometry" for "/odometry", as ROS 2 writes it, and for its name on the wire, which begins with rt/.
std::string TopicNameFrom(const std::string& name);

/// Whether the table of topics has it, so that nobody on the bus need be asked for its type.
bool IsInTable(const std::string& topic);

/// Finds the type and delivery of a topic: from the table of topics, else from `type`, else from those who
/// publish or subscribe it. A reader of it takes what its writers offer.
/// @param type  "nav_msgs/msg/Odometry" or "nav_msgs/Odometry"; empty = look it up.
/// @param folders  Where definitions are looked for that are neither in idl/ nor standard, see
/// MessageDefinition. Fails, naming what could help, for a topic of unknown type or of another one than
/// `type`, and for a type that is defined nowhere.
Result<OpenTopic> FindOpenTopic(const std::string& topic, const std::string& type, const dds::BusGraph& graph,
                                const std::vector<std::filesystem::path>& folders = MessageFolders());

/// The other machines on which the topic is published, by whose clocks its messages may be stamped.
std::set<std::string> OtherHostsOf(const std::string& topic, const dds::BusGraph& graph,
                                   const std::string& own_host);

/// Who publishes the topic, for people.
std::set<std::string> WritersOf(const std::string& topic, const dds::BusGraph& graph);

/// What is known about who publishes the topic, for a person who waits for its messages.
std::string WhyNothingArrives(const std::string& topic, const dds::BusGraph& graph);

}  // namespace thalweg::inspector
