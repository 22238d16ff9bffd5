#include "services/link/core/scheduler.h"

#include <algorithm>
#include <utility>

#include "common/base/check.h"
#include "services/link/core/message_coding.h"

namespace thalweg::link {

Scheduler::Scheduler(std::vector<ChannelPolicy> policies) {
  THALWEG_CHECK(policies.size() <= kMostChannels);
  for (ChannelPolicy& policy : policies) channels_.emplace_back().policy = std::move(policy);
}

void Scheduler::Offer(std::size_t index, Message message, bool at_front) {
  Channel& channel = channels_[index];
  if (channel.policy.repeats_last && !at_front) channel.last = message;
  if (at_front) {
    channel.waiting.push_front(std::move(message));
  } else {
    ++channel.counts.offered;
    channel.waiting.push_back(std::move(message));
  }
  while (channel.waiting.size() > channel.policy.most_waiting) {
    channel.waiting.pop_front();
    ++channel.counts.dropped;
  }
}

void Scheduler::SetSource(std::size_t channel, std::function<std::optional<Message>(Duration)> source) {
  channels_[channel].source = std::move(source);
}

bool Scheduler::idle(std::size_t index) const {
  const Channel& channel = channels_[index];
  return channel.waiting.empty() && !channel.crossing;
}

std::deque<Message> Scheduler::TakeWaiting(std::size_t channel) {
  return std::exchange(channels_[channel].waiting, {});
}

bool Scheduler::StartNext(Channel& channel, Duration now) {
  if (channel.crossing) return true;
  if (channel.waiting.empty() && channel.source) {
    if (auto message = channel.source(now)) {
      ++channel.counts.offered;
      channel.waiting.push_back(*std::move(message));
    }
  }
  if (channel.waiting.empty()) return false;
  Message message = std::move(channel.waiting.front());
  channel.waiting.pop_front();
  const bool with_preface = message.preface && message.preface != channel.preface;
  channel.wire = EncodeMessage(message.bytes, message.offered, with_preface ? message.preface.get() : nullptr,
                               channel.policy.packed ? &channel.before : nullptr);
  channel.put = 0;
  channel.preface = message.preface;
  if (channel.policy.packed) channel.before = message.bytes;
  channel.crossing = std::move(message);
  return true;
}

bool Scheduler::PutPiece(std::size_t index, ByteWriter& frame, std::vector<Finished>& finished) {
  constexpr std::size_t kLeastBytes = 16;  // less is not worth a header, unless it is all
  Channel& channel = channels_[index];
  const std::size_t left = channel.wire.size() - channel.put;
  if (frame.size() + kPieceHeaderBytes + std::min(left, kLeastBytes) > kFrameBytes) return false;
  const std::size_t count = std::min(left, kFrameBytes - kPieceHeaderBytes - frame.size());
  Put(frame, {.channel = index,
              .first = channel.put == 0,
              .last = count == left,
              .total = channel.wire.size(),
              .bytes = Bytes(channel.wire).subspan(channel.put, count)});
  channel.put += count;
  ++channel.counts.pieces;
  if (count < left) return true;
  ++channel.counts.sent;
  channel.counts.bytes += channel.wire.size();
  finished.push_back({index, *std::exchange(channel.crossing, std::nullopt)});
  return true;
}

std::vector<Scheduler::Finished> Scheduler::Fill(ByteWriter& frame, Priority least, Duration now) {
  std::vector<Finished> finished;
  const std::size_t count = channels_.size();
  std::optional<std::size_t> served;
  for (auto priority = Priority::kCommand; priority <= least;
       priority = static_cast<Priority>(static_cast<std::uint8_t>(priority) + 1)) {
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t index = (turn_ + k) % count;
      Channel& channel = channels_[index];
      if (channel.policy.priority != priority) continue;
      while (StartNext(channel, now)) {
        if (!PutPiece(index, frame, finished)) {
          if (served) turn_ = (*served + 1) % count;
          return finished;
        }
        served = index;
        if (channel.crossing) break;  // the frame is full
      }
    }
  }
  if (served) turn_ = (*served + 1) % count;
  return finished;
}

void Scheduler::Restart(Duration now) {
  for (Channel& channel : channels_) {
    if (channel.crossing) channel.waiting.push_front(*std::exchange(channel.crossing, std::nullopt));
    channel.before.clear();
    channel.preface.reset();
    if (channel.last && channel.waiting.empty()) {
      channel.waiting.push_back(*channel.last);
      channel.waiting.back().offered = now;
    }
    while (channel.waiting.size() > channel.policy.most_waiting) {
      channel.waiting.pop_front();
      ++channel.counts.dropped;
    }
  }
}

}  // namespace thalweg::link
