#include "common/dds/topic_table.h"

#include <algorithm>

namespace thalweg::dds {
namespace {

template <class... Topics>
std::vector<TopicInfo> InfosOf(const std::tuple<Topics...>*) {
  std::vector<TopicInfo> infos = {InfoOf<Topics>()...};
  // Frames mean something only to the link for which they were written.
  for (TopicInfo& info : infos) {
    if (info.delivery == Delivery::kFrames) info.replay = Replay::kOnlyIfNamed;
  }
  return infos;
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
