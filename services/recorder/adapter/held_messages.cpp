#include "services/recorder/adapter/held_messages.h"

#include <algorithm>
#include <utility>

namespace thalweg::recorder {
namespace {

/// The frames of which a message says where they are; none if it does not decode.
std::set<std::string> FramesIn(Bytes payload) {
  std::set<std::string> frames;
  const auto message = dds::Decode<dds::topics::StaticTransforms>(payload);
  if (!message) return frames;
  for (const auto& transform : message->transforms()) frames.insert(transform.child_frame_id());
  return frames;
}

}  // namespace

bool HeldMessages::IsHeld(const dds::TopicInfo& topic) {
  return topic.delivery == dds::Delivery::kState || MakeUpdateFollower(topic.name) != nullptr;
}

void HeldMessages::Hold(std::size_t channel, const dds::TopicInfo& topic) {
  if (!IsHeld(topic)) return;
  Topic held;
  held.has_transforms = topic.type_name == dds::InfoOf<dds::topics::StaticTransforms>().type_name;
  held.follower = MakeUpdateFollower(topic.name);
  topics_.try_emplace(channel, std::move(held));
}

void HeldMessages::Take(std::size_t channel, std::uint32_t sequence, Time log_time, Time publish_time,
                        Bytes payload) {
  const auto found = topics_.find(channel);
  if (found == topics_.end()) return;
  Topic& topic = found->second;
  if (topic.follower) {
    topic.follower->Follow(payload);
    topic.last_update = {channel, sequence, log_time, publish_time, {}};
    return;
  }
  constexpr std::size_t kMostMessages = 1000;  // a publisher of ever new frames must not take all memory
  std::set<std::string> frames;
  if (topic.has_transforms) {
    frames = FramesIn(payload);
    if (frames.empty()) return;
    for (Stored& stored : topic.newest) {
      for (const std::string& frame : frames) stored.frames.erase(frame);
    }
    std::erase_if(topic.newest, [](const Stored& stored) { return stored.frames.empty(); });
    if (topic.newest.size() >= kMostMessages) topic.newest.pop_front();
  } else {
    topic.newest.clear();
  }
  topic.newest.push_back(
      {{channel, sequence, log_time, publish_time, {payload.begin(), payload.end()}}, std::move(frames)});
}

bool HeldMessages::Has(std::size_t channel, std::uint32_t sequence, Time publish_time, Bytes payload) const {
  const auto found = topics_.find(channel);
  return found != topics_.end() && std::ranges::any_of(found->second.newest, [&](const Stored& stored) {
           return stored.item.sequence == sequence && stored.item.publish_time == publish_time &&
                  std::ranges::equal(stored.item.payload, payload);
         });
}

std::vector<HeldMessages::Item> HeldMessages::Items() const {
  std::vector<Item> items;
  for (const auto& [channel, topic] : topics_) {
    for (const Stored& stored : topic.newest) items.push_back(stored.item);
    if (!topic.follower) continue;
    std::optional<UpdateFollower::Sample> copy = topic.follower->FullCopy();
    if (!copy) continue;
    items.push_back(topic.last_update);
    items.back().payload = *std::move(copy);
  }
  std::ranges::stable_sort(items, {}, &Item::log_time);
  return items;
}

}  // namespace thalweg::recorder
