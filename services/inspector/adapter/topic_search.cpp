#include "services/inspector/adapter/topic_search.h"

namespace thalweg::inspector {

std::vector<Result<OpenTopic>> TopicSearch::FindNew(const dds::BusGraph& graph) {
  std::vector<Result<OpenTopic>> topics;
  for (const dds::Endpoint& endpoint : graph.endpoints) {
    const auto name = dds::TopicName(endpoint.topic);
    if (!endpoint.writes || !name || !wants_(*name) || !found_.insert(*name).second) continue;
    topics.push_back(FindOpenTopic(*name, "", graph, folders_));
  }
  return topics;
}

}  // namespace thalweg::inspector
