#pragma once

#include <set>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/dds/bus_graph.h"
#include "common/dds/names.h"
#include "services/inspector/adapter/topic_search.h"
#include "services/recorder/adapter/recorder.h"

namespace thalweg::cli {

/// The topics to record that the table of topics does not have, as they appear on the bus.
class OutsideTopics {
 public:
  /// @param patterns  Names of topics, or patterns ("stereo/*"); empty = all that begin with the robot's
  /// name.
  /// @param names     What the topics of the table are called on the wire.
  OutsideTopics(std::vector<std::string> patterns, const dds::Names& names);
  OutsideTopics(const OutsideTopics&) = delete;
  OutsideTopics& operator=(const OutsideTopics&) = delete;

  /// Those that no earlier call returned. Of one whose messages cannot be decoded the error, which names it.
  std::vector<Result<recorder::OutsideTopic>> FindNew(const dds::BusGraph& graph);

  /// A line for each pattern that no topic matches yet.
  std::vector<std::string> Unmatched() const;

 private:
  bool Wants(const std::string& topic) const;

  std::vector<std::string> patterns_;
  std::string of_robot_;            ///< What its topics begin with; empty = anything.
  std::set<std::string> in_table_;  ///< Their names on the wire.
  inspector::TopicSearch search_;
};

}  // namespace thalweg::cli
