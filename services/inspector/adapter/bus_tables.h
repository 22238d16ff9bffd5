#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/dds/bus_graph.h"
#include "services/inspector/core/table.h"

namespace thalweg::inspector {

// What `thalweg topic` and `thalweg node` show of a bus. Text of participants is cleaned.

/// A topic as the participants use it.
struct TopicUse {
  std::set<std::string> types;  ///< "nav_msgs/msg/Odometry"
  std::vector<const dds::Endpoint*> writers, readers;
};

/// By name; topics that are none of ROS 2's under their name on the wire.
/// @param graph  Must outlive the result.
std::map<std::string, TopicUse> TopicUses(const dds::BusGraph& graph);

/// "reliable, volatile, partition robot1"
std::string QosText(const dds::Endpoint& endpoint);

/// The participants by name, then host and process. @param graph  Must outlive the result.
std::vector<const dds::Participant*> NodesByName(const dds::BusGraph& graph);

/// A heading, and a row for each participant by name: host, process, address, program, and how many topics it
/// publishes and subscribes.
Rows NodeRows(const dds::BusGraph& graph);

/// "mapper: process 1279 on vm (10.0.0.7), thalweg 0.2.0, eProsima Fast DDS"
std::string NodeText(const dds::Participant& node);

/// A row for each topic that a node publishes (`writes`) or subscribes to: name, type, QoS; indented.
Rows EndpointRows(const dds::BusGraph& graph, const dds::Participant& node, bool writes);

/// The mismatches in which a node of this name takes part; all of them if it is empty.
std::vector<dds::Mismatch> MismatchesOf(const dds::BusGraph& graph, const std::string& node);

}  // namespace thalweg::inspector
