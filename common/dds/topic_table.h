#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/dds/topics.h"
#include "common/dds/type_support.h"

namespace thalweg::dds {

/// A topic at run time, for tools that handle topics without knowing their types.
struct TopicInfo {
  std::string name;       ///< e.g. depth/points; on the wire "rt/" + name.
  std::string type_name;  ///< e.g. sensor_msgs::msg::dds_::PointCloud2_
  Delivery delivery;
  Writers writers;
  Replay replay = Replay::kByDefault;
  std::uint32_t most_bytes = kMostBytes;  ///< Largest sample, as it travels.
};

/// What a reader keeps for a handler that is late.
enum class Keep {
  kAsDelivered,   ///< As many samples as the delivery says, and none that is beyond its lifespan.
  kForRecording,  ///< At least the last 100, however old they are, and of writers of any reliability.
};

template <class Topic>
TopicInfo InfoOf() {
  return {Topic::kName,      NameOf(TypeSupportOf<Topic>()),
          Topic::kDelivery,  WritersOf<Topic>(),
          ReplayOf<Topic>(), MostBytesOf<Topic>()};
}

/// Every topic of topics.h, in the order of that file.
std::span<const TopicInfo> AllTopics();
/// The topic of that name; null if there is none.
const TopicInfo* FindTopic(std::string_view name);

/// Decodes a sample: an encapsulation header of 4 bytes and the message's CDR representation. Returns nothing
/// if the bytes are not a message of the topic's type.
template <class Topic>
std::optional<MessageOf<Topic>> Decode(std::span<const std::uint8_t> sample);
/// Encodes a message; the inverse of Decode.
template <class Topic>
std::vector<std::uint8_t> Encode(const MessageOf<Topic>& message);

template <class Topic>
std::optional<MessageOf<Topic>> Decode(std::span<const std::uint8_t> sample) {
  std::optional<MessageOf<Topic>> message(std::in_place);
  if (!DecodeSample(TypeSupportOf<Topic>(), sample, &*message)) message.reset();
  return message;
}

template <class Topic>
std::vector<std::uint8_t> Encode(const MessageOf<Topic>& message) {
  return EncodeSample(TypeSupportOf<Topic>(), &message);
}

}  // namespace thalweg::dds
