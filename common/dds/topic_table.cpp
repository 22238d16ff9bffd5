#include "common/dds/topic_table.h"

#include <algorithm>

namespace thalweg::dds {
namespace {

template <class... Topics>
std::vector<TopicInfo> InfosOf(const std::tuple<Topics...>*) {
  return {InfoOf<Topics>()...};
}

}  // namespace

std::span<const TopicInfo> AllTopics() {
  static const std::vector<TopicInfo> topics = InfosOf(static_cast<const topics::All*>(nullptr));
  return topics;
}

const TopicInfo* FindTopic(std::string_view name) {
  const auto found = std::ranges::find(AllTopics(), name, &TopicInfo::name);
  return found == AllTopics().end() ? nullptr : &*found;
}

}  // namespace thalweg::dds
