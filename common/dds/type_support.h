#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <typeinfo>
#include <vector>

#include "common/dds/topics.h"

namespace eprosima::fastdds::dds {
class TopicDataType;
}

namespace thalweg::dds {

// How messages are encoded for Fast DDS, without its headers, which take long to compile.

struct DeleteTypeSupport {
  void operator()(eprosima::fastdds::dds::TopicDataType* support) const;
};
/// What encodes and decodes the messages of one type, and knows the type's name on the wire.
using TypeSupport = std::unique_ptr<eprosima::fastdds::dds::TopicDataType, DeleteTypeSupport>;

/// The generated support for a message type of topics.h.
/// @throws std::logic_error if no topic there has that type.
TypeSupport NewTypeSupport(const std::type_info& message);
/// For the messages of a topic. One whose type no topic of topics.h has must bring its own support: a static
/// function NewTypeSupport(), e.g. `return TypeSupport(new my_msgs::msg::WindPubSubType());`.
template <class Topic>
TypeSupport TypeSupportOf() {
  if constexpr (requires { Topic::NewTypeSupport(); }) {
    return Topic::NewTypeSupport();
  } else {
    return NewTypeSupport(typeid(MessageOf<Topic>));
  }
}

/// e.g. sensor_msgs::msg::dds_::PointCloud2_
std::string NameOf(const TypeSupport& support);

/// Decodes a sample into a message of the support's type: an encapsulation header of 4 bytes and the
/// message's CDR representation. Returns false if the bytes are no such message.
bool DecodeSample(const TypeSupport& support, std::span<const std::uint8_t> sample, void* message);
/// The inverse of DecodeSample.
std::vector<std::uint8_t> EncodeSample(const TypeSupport& support, const void* message);

}  // namespace thalweg::dds
