#include "services/link/adapter/channels.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "common/base/hash.h"

namespace thalweg::link {
namespace {

namespace topics = dds::topics;

// Poses of several seconds, and the answers and words of operators, wait for a link that pauses.
constexpr std::size_t kMostPoses = 500;
constexpr std::size_t kMostInLog = 200;
constexpr std::size_t kMostHealth = 64;  // several services share the topic

ChannelPolicy PolicyOf(const dds::TopicInfo& topic) {
  ChannelPolicy policy{.name = topic.name};
  switch (topic.delivery) {
    case dds::Delivery::kCommand:
      policy.priority = Priority::kCommand;
      break;
    case dds::Delivery::kSamples:
      policy.priority = Priority::kPose;
      policy.most_waiting = kMostPoses;
      break;
    case dds::Delivery::kState:
      policy.priority = Priority::kState;
      policy.repeats_last = true;
      break;
    case dds::Delivery::kDiary:
      policy.priority = Priority::kBulk;
      policy.most_waiting = kMostInLog;
      policy.repeats_unacknowledged = true;
      break;
    case dds::Delivery::kLog:
      policy.priority = Priority::kCommand;
      policy.most_waiting = kMostInLog;
      policy.repeats_unacknowledged = true;
      break;
    case dds::Delivery::kStream:
    case dds::Delivery::kFrames:
      break;
  }
  return policy;
}

/// What a topic's delivery does not say.
void Refine(ChannelPolicy& policy) {
  const auto is = [&](const char* name) { return policy.name == name; };
  if (is(topics::Odometry::kName)) policy.kept = policy.repeats_unacknowledged = true;
  if (is(topics::Clock::kName)) policy.most_waiting = 1;
  if (is(topics::Transforms::kName)) policy.most_waiting = 1;
  if (is(topics::Health::kName)) {
    policy.priority = Priority::kState;
    policy.most_waiting = kMostHealth;
  }
  if (is(topics::DepthPoints::kName)) {
    policy.kept = policy.repeats_unacknowledged = true;
    policy.packed = false;  // by the codec of clouds
  }
  if (is(topics::MapUpdates::kName)) {
    policy.priority = Priority::kMap;
    policy.most_waiting = 1;
    policy.repeats_unacknowledged = false;  // the feed starts over
    policy.packed = false;                  // by the codec of maps
  }
  // Pictures of what the map, the last plan and the motion to come look like: large, for people.
  if (is(topics::Octomap::kName) || is(topics::Frontiers::kName) || is(topics::Streamline::kName) ||
      is(topics::Trajectory::kName)) {
    policy.priority = Priority::kBulk;
  }
}

std::vector<ChannelTopic> MakeChannels() {
  std::vector<ChannelTopic> channels;
  for (const dds::TopicInfo& topic : dds::AllTopics()) {
    if (topic.delivery == dds::Delivery::kFrames) continue;
    channels.push_back({topic, PolicyOf(topic)});
    Refine(channels.back().policy);
  }
  return channels;
}

}  // namespace

const std::vector<ChannelTopic>& Channels() {
  static const std::vector<ChannelTopic> channels = MakeChannels();
  return channels;
}

std::vector<ChannelPolicy> PoliciesOf(const std::vector<ChannelTopic>& channels) {
  std::vector<ChannelPolicy> policies;
  for (const ChannelTopic& channel : channels) policies.push_back(channel.policy);
  return policies;
}

std::uint64_t HashOf(const std::vector<ChannelTopic>& channels) {
  std::uint64_t hash = thalweg::HashOf("");
  for (const ChannelTopic& channel : channels) {
    hash = thalweg::HashOf(
        channel.topic.name + ' ' + channel.topic.type_name + ' ' + (channel.policy.packed ? 'p' : 'c') + '\n',
        hash);
  }
  return hash;
}

std::size_t ChannelNamed(std::string_view topic) {
  const auto& channels = Channels();
  const auto found =
      std::ranges::find_if(channels, [&](const auto& channel) { return channel.topic.name == topic; });
  if (found == channels.end()) throw std::logic_error("no channel " + std::string(topic));
  return static_cast<std::size_t>(found - channels.begin());
}

}  // namespace thalweg::link
