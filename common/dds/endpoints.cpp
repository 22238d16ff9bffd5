#include "common/dds/endpoints.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <fastdds/dds/core/policy/QosPolicies.hpp>

namespace thalweg::dds {
namespace {

namespace fastdds = eprosima::fastdds::dds;

std::string NameOf(fastdds::QosPolicyId_t policy) {
  switch (policy) {
    case fastdds::DURABILITY_QOS_POLICY_ID:
      return "durability";
    case fastdds::DEADLINE_QOS_POLICY_ID:
      return "deadline";
    case fastdds::OWNERSHIP_QOS_POLICY_ID:
      return "ownership";
    case fastdds::LIVELINESS_QOS_POLICY_ID:
      return "liveliness";
    case fastdds::RELIABILITY_QOS_POLICY_ID:
      return "reliability";
    case fastdds::DESTINATIONORDER_QOS_POLICY_ID:
      return "destination order";
    default:
      return "policy " + std::to_string(policy);
  }
}

}  // namespace

bool IsOf(const WriterId& endpoint, const eprosima::fastrtps::rtps::GuidPrefix_t& participant) {
  return eprosima::fastrtps::rtps::iHandle2GUID(endpoint).guidPrefix == participant;
}

bool Matches::Holds(const WriterId& peer) const {
  const std::lock_guard lock(mutex_);
  return std::ranges::find(peers_, peer) != peers_.end();
}

bool Matches::Any(const std::function<bool(const WriterId&)>& test) const {
  const std::lock_guard lock(mutex_);
  return std::ranges::any_of(peers_, test);
}

void Matches::on_publication_matched(fastdds::DataWriter*, const fastdds::PublicationMatchedStatus& status) {
  Set(status.last_subscription_handle, status.current_count_change);
}

void Matches::on_subscription_matched(fastdds::DataReader*,
                                      const fastdds::SubscriptionMatchedStatus& status) {
  Set(status.last_publication_handle, status.current_count_change);
}

void Matches::on_offered_incompatible_qos(fastdds::DataWriter*,
                                          const fastdds::OfferedIncompatibleQosStatus&) {
  refused_reader_ = true;
  wake_.set_trigger_value(true);
}

void Matches::on_requested_incompatible_qos(fastdds::DataReader*,
                                            const fastdds::RequestedIncompatibleQosStatus& status) {
  if (status.last_policy_id == fastdds::RELIABILITY_QOS_POLICY_ID) {
    best_effort_offered_ = true;
    wake_.set_trigger_value(true);
  } else {
    spdlog::warn("{}: a writer offers less than is requested and is ignored: {}", topic_,
                 NameOf(status.last_policy_id));
  }
}

void Matches::Set(const WriterId& peer, int change) {
  if (ignored_ && IsOf(peer, *ignored_)) return;
  {
    const std::lock_guard lock(mutex_);
    if (change > 0) peers_.push_back(peer);
    if (change < 0) std::erase(peers_, peer);
    count_ = static_cast<int>(peers_.size());
  }
  if (change < 0 && count_ == 0) last_gone_ = true;
  wake_.set_trigger_value(true);
}

bool LateSamples::Write(fastdds::DataWriter& writer, const void* message) {
  void* const data = const_cast<void*>(message);  // which is only read
  CheckedType::Payload payload(type_.getSerializedSizeProvider(data)());
  const bool is_encoded = type_.serialize(data, &payload);
  const std::lock_guard lock(mutex_);
  if (is_encoded) {
    if (samples_.size() == most_) samples_.pop_front();
    samples_.emplace_back(payload.data, payload.data + payload.length);
  }
  return writer.write(data);
}

void LateSamples::WriteAgain(fastdds::DataWriter& writer) {
  const std::lock_guard lock(mutex_);
  for (const std::vector<std::uint8_t>& bytes : samples_) {
    CheckedType::Payload payload(static_cast<std::uint32_t>(bytes.size()));
    std::ranges::copy(bytes, payload.data);
    payload.length = payload.max_size;
    Sample sample(type_);
    if (type_.DecodeOwn(payload, sample.data.get())) writer.write(sample.data.get());
  }
}

void Sample::Settle() {
  constexpr std::size_t kNotable = 1U << 20;
  most_bytes = std::max(most_bytes, bytes);
  if (most_bytes > kNotable && bytes < most_bytes / 8) Renew();
}

namespace {

/// Whether a sample makes those before it useless.
bool Supersedes(Delivery delivery) {
  switch (delivery) {
    case Delivery::kStream:
    case Delivery::kState:
    case Delivery::kCommand:
      return true;
    case Delivery::kSamples:
    case Delivery::kLog:
    case Delivery::kDiary:
    case Delivery::kFrames:
      break;
  }
  return false;
}

}  // namespace

bool Input::newest_only() const {
  return Supersedes(topic.delivery) && type->decodes();
}

}  // namespace thalweg::dds
