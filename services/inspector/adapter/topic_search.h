#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/dds/bus_graph.h"
#include "services/inspector/adapter/open_topic.h"

namespace thalweg::inspector {

/// Finds topics as somebody begins to publish them.
class TopicSearch {
 public:
  /// @param wants  Whether a topic of that name, "camera/imu", is looked for.
  /// @param folders  As for FindOpenTopic.
  explicit TopicSearch(std::function<bool(const std::string& topic)> wants,
                       std::vector<std::filesystem::path> folders = MessageFolders())
      : wants_(std::move(wants)), folders_(std::move(folders)) {}

  /// The topics on the bus that no earlier call returned. Of one whose messages cannot be decoded the error,
  /// which names it.
  std::vector<Result<OpenTopic>> FindNew(const dds::BusGraph& graph);

  const std::set<std::string>& found() const { return found_; }  ///< Names of all that were returned.

 private:
  std::function<bool(const std::string& topic)> wants_;
  std::vector<std::filesystem::path> folders_;
  std::set<std::string> found_;
};

}  // namespace thalweg::inspector
