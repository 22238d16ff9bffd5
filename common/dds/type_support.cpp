#include "common/dds/type_support.h"

#include <geometry_msgsPubSubTypes.h>
#include <nav_msgsPubSubTypes.h>
#include <octomap_msgsPubSubTypes.h>
#include <rcl_interfacesPubSubTypes.h>
#include <rosgraph_msgsPubSubTypes.h>
#include <sensor_msgsPubSubTypes.h>
#include <stereo_msgsPubSubTypes.h>
#include <tf2_msgsPubSubTypes.h>
#include <thalweg_msgsPubSubTypes.h>
#include <trajectory_msgsPubSubTypes.h>
#include <visualization_msgsPubSubTypes.h>

#include <algorithm>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <stdexcept>
#include <tuple>
#include <type_traits>

namespace thalweg::dds {
namespace {

using eprosima::fastdds::dds::TopicDataType;
using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;

template <class... Support>
struct SupportsOf {
  template <class Message>
  static constexpr bool kInclude = (std::is_same_v<Message, typename Support::type> || ...);
  template <class... Topic>
  static constexpr bool IncludeAll(const std::tuple<Topic...>*) {
    return (kInclude<MessageOf<Topic>> && ...);
  }
  static TopicDataType* New(const std::type_info& message) {
    TopicDataType* made = nullptr;
    ((message == typeid(typename Support::type) ? (made = new Support(), true) : false) || ...);
    return made;
  }
};

/// What is generated from idl/ for the types of topics.h.
using Supports = SupportsOf<
    geometry_msgs::msg::PoseStampedPubSubType, geometry_msgs::msg::TwistPubSubType,
    geometry_msgs::msg::TwistStampedPubSubType, nav_msgs::msg::OdometryPubSubType,
    nav_msgs::msg::PathPubSubType, octomap_msgs::msg::OctomapPubSubType, rcl_interfaces::msg::LogPubSubType,
    rosgraph_msgs::msg::ClockPubSubType, sensor_msgs::msg::CameraInfoPubSubType,
    sensor_msgs::msg::ImagePubSubType, sensor_msgs::msg::PointCloud2PubSubType,
    stereo_msgs::msg::DisparityImagePubSubType, tf2_msgs::msg::TFMessagePubSubType,
    thalweg_msgs::msg::CommandReplyPubSubType, thalweg_msgs::msg::ExplorationStatusPubSubType,
    thalweg_msgs::msg::FrontierListPubSubType, thalweg_msgs::msg::LinkFramePubSubType,
    thalweg_msgs::msg::MapRequestPubSubType, thalweg_msgs::msg::MapUpdatePubSubType,
    thalweg_msgs::msg::MotionStatusPubSubType, thalweg_msgs::msg::OdometryStatusPubSubType,
    thalweg_msgs::msg::OperatorCommandPubSubType, thalweg_msgs::msg::ReplayCommandPubSubType,
    thalweg_msgs::msg::ReplayStatusPubSubType, thalweg_msgs::msg::ServiceHealthPubSubType,
    thalweg_msgs::msg::SimulationStatusPubSubType, thalweg_msgs::msg::SurfaceRiftsPubSubType,
    thalweg_msgs::msg::SurfaceStatusPubSubType, thalweg_msgs::msg::SurfaceUpdatePubSubType,
    trajectory_msgs::msg::MultiDOFJointTrajectoryPubSubType, visualization_msgs::msg::MarkerArrayPubSubType>;
static_assert(Supports::IncludeAll(static_cast<const topics::All*>(nullptr)),
              "a topic's type is missing from Supports");

}  // namespace

void DeleteTypeSupport::operator()(TopicDataType* support) const {
  delete support;
}

TypeSupport NewTypeSupport(const std::type_info& message) {
  TypeSupport made(Supports::New(message));
  if (!made) throw std::logic_error(std::string("no topic has the type ") + message.name());
  return made;
}

std::string NameOf(const TypeSupport& support) {
  return support->getName();
}

bool DecodeSample(const TypeSupport& support, std::span<const std::uint8_t> sample, void* message) {
  Payload payload(static_cast<std::uint32_t>(sample.size()));
  std::ranges::copy(sample, payload.data);
  payload.length = static_cast<std::uint32_t>(sample.size());
  try {
    return support->deserialize(&payload, message);
  } catch (const std::exception&) {  // the decoder throws at lengths that the bytes do not hold
    return false;
  }
}

std::vector<std::uint8_t> EncodeSample(const TypeSupport& support, const void* message) {
  auto* const data = const_cast<void*>(message);  // which is only read
  Payload payload(support->getSerializedSizeProvider(data)());
  support->serialize(data, &payload);
  return {payload.data, payload.data + payload.length};
}

}  // namespace thalweg::dds
