#include "services/cli/adapter/outside_topics.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/base/nearest_name.h"
#include "common/dds/topic_table.h"
#include "services/recorder/core/topic_pattern.h"

namespace thalweg::cli {

OutsideTopics::OutsideTopics(std::vector<std::string> patterns, const dds::Names& names)
    : patterns_(std::move(patterns)),
      of_robot_(names.robot.empty() ? "" : names.robot + '/'),
      search_([this](const std::string& topic) { return Wants(topic); }) {
  for (const dds::TopicInfo& topic : dds::AllTopics()) in_table_.insert(names.Topic(topic.name));
}

std::vector<Result<recorder::OutsideTopic>> OutsideTopics::FindNew(const dds::BusGraph& graph) {
  std::vector<Result<recorder::OutsideTopic>> topics;
  for (const Result<inspector::OpenTopic>& found : search_.FindNew(graph)) {
    if (!found) {
      topics.emplace_back(Error{found.error()});
      continue;
    }
    recorder::OutsideTopic topic{found->info, found->type, found->definition};
    topic.info.name = '/' + topic.info.name;  // it has this name for every robot
    topics.emplace_back(std::move(topic));
  }
  return topics;
}

std::vector<std::string> OutsideTopics::Unmatched() const {
  std::vector<std::string> names(search_.found().begin(), search_.found().end());
  for (const dds::TopicInfo& topic : dds::AllTopics()) names.push_back(topic.name);
  std::vector<std::string> lines;
  for (const std::string& pattern : patterns_) {
    const auto matches = [&](const std::string& name) { return recorder::Matches(pattern, name); };
    if (std::ranges::any_of(names, matches)) continue;
    lines.push_back(fmt::format("nobody publishes {} yet; it is recorded once somebody does{}", pattern,
                                DidYouMean(names, std::string(recorder::BusName(pattern)))));
  }
  return lines;
}

bool OutsideTopics::Wants(const std::string& topic) const {
  if (in_table_.contains(topic)) return false;
  return patterns_.empty() ? topic.starts_with(of_robot_) : recorder::MatchesAny(patterns_, topic);
}

}  // namespace thalweg::cli
