#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/dds/topic_table.h"
#include "services/link/core/scheduler.h"

namespace thalweg::link {

/// A topic that may cross, in the order of topics.h. A channel's number is its place in the list.
struct ChannelTopic {
  dds::TopicInfo topic;
  ChannelPolicy policy;
};

/// Every topic but the link's own, and how it crosses; follows from its delivery, but for a few.
const std::vector<ChannelTopic>& Channels();
std::vector<ChannelPolicy> PoliciesOf(const std::vector<ChannelTopic>& channels);
/// Differs between versions that would not understand each other.
std::uint64_t HashOf(const std::vector<ChannelTopic>& channels);

template <class Topic>
std::size_t ChannelOf();

/// Throws std::logic_error if no channel has this name.
std::size_t ChannelNamed(std::string_view topic);

template <class Topic>
std::size_t ChannelOf() {
  static const std::size_t channel = ChannelNamed(Topic::kName);
  return channel;
}

}  // namespace thalweg::link
