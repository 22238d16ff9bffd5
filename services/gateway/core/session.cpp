#include "services/gateway/core/session.h"

#include <algorithm>
#include <utility>

namespace thalweg::gateway {

Session::Session(const ServerContent& content) : content_(content) {
  Reply(ServerInfo(content.name, content.session_id, content.with_time));
  Reply(Advertise(content.channels));
}

void Session::OnText(std::string_view text) {
  Handle(ParseText(text));
}

void Session::OnBinary(std::span<const std::uint8_t> bytes) {
  Handle(ParseBinary(bytes));
}

void Session::Handle(const Result<ClientRequest>& request) {
  if (closing_) return;
  if (request) return std::visit([this](const auto& known) { Do(known); }, *request);
  ++invalid_frames_;
  last_invalid_ = request.error();
  Reply(Status(StatusLevel::kError, "invalid frame: " + request.error()));
  if (invalid_frames_ >= kMaxInvalidFrames)
    closing_ = "too many invalid frames; the last: " + request.error();
}

void Session::Do(const SubscribeRequest& request) {
  for (const auto& [id, channel] : request.items) {
    const auto known = std::find_if(content_.channels.begin(), content_.channels.end(),
                                    [&](const Channel& offered) { return offered.id == channel; });
    const std::string what = "subscription " + std::to_string(id) + " to channel " + std::to_string(channel);
    if (known == content_.channels.end()) {
      Reply(Status(StatusLevel::kError, what + ": there is no such channel"));
    } else if (channel_of_.contains(id)) {
      Reply(Status(StatusLevel::kError, what + ": this id is already in use"));
    } else if (by_channel_.contains(channel)) {
      Reply(Status(StatusLevel::kError, what + ": already subscribed to " + known->topic));
    } else if (by_channel_.size() >= kMaxSubscriptions) {
      Reply(Status(StatusLevel::kError, what + ": too many subscriptions"));
    } else {
      Subscription subscription;
      subscription.id = id;
      const auto feed = content_.feeds.find(channel);
      if (feed != content_.feeds.end()) subscription.feed = feed->second;
      by_channel_[channel] = subscription;
      channel_of_[id] = channel;
      new_subscriptions_.push_back(channel);
    }
  }
}

void Session::Do(const UnsubscribeRequest& request) {
  for (const std::uint32_t id : request.subscriptions) {
    const auto found = channel_of_.find(id);
    if (found == channel_of_.end()) {
      Reply(Status(StatusLevel::kWarning, "subscription " + std::to_string(id) + " does not exist"));
      continue;
    }
    by_channel_.erase(found->second);
    channel_of_.erase(found);
  }
}

void Session::Do(const GetParametersRequest& request) {
  if (request.names.empty()) return Reply(ParameterValues(content_.parameters, request.id));
  std::vector<Parameter> chosen;
  for (const Parameter& parameter : content_.parameters) {
    if (std::find(request.names.begin(), request.names.end(), parameter.name) != request.names.end()) {
      chosen.push_back(parameter);
    }
  }
  Reply(ParameterValues(chosen, request.id));
}

void Session::Do(const SetParametersRequest& request) {
  Reply(Status(StatusLevel::kWarning, "parameters cannot be changed while the run goes on"));
  // The answer holds the values as they are, so that the client does not show the one it sent.
  Reply(ParameterValues(content_.parameters, request.id));
}

void Session::Do(const UnofferedRequest& request) {
  Reply(Status(StatusLevel::kWarning, "the gateway does not offer \"" + request.operation + "\""));
}

void Session::Reply(Frame frame) {
  if (replies_.size() >= kMaxReplies) {
    closing_ = "requests arrive faster than their replies are read";
    return;
  }
  replies_.push_back(std::move(frame));
}

bool Session::Offer(std::uint32_t channel, Time stamp, const Bytes& message) {
  const auto found = by_channel_.find(channel);
  if (found == by_channel_.end()) return false;
  Subscription& subscription = found->second;
  if (subscription.waiting) {
    ++dropped_;  // keeps its turn, so that a fast channel cannot push others back
  } else {
    subscription.turn = ++turn_;
  }
  subscription.stamp = stamp;
  subscription.waiting = message;
  return true;
}

void Session::OfferTime(Time now) {
  if (content_.with_time) time_ = now;
}

std::vector<std::uint32_t> Session::TakeNewSubscriptions() {
  return std::exchange(new_subscriptions_, {});
}

std::optional<Frame> Session::Next() {
  if (!replies_.empty()) {
    Frame frame = std::move(replies_.front());
    replies_.pop_front();
    return frame;
  }
  if (time_) return TimeFrame(*std::exchange(time_, std::nullopt));
  if (std::optional<Frame> frame = NextSample(false)) return frame;
  feeds_turn_ = !feeds_turn_;
  if (feeds_turn_) {
    std::optional<Frame> frame = NextOfFeeds();
    return frame ? frame : NextSample(true);
  }
  std::optional<Frame> frame = NextSample(true);
  return frame ? frame : NextOfFeeds();
}

std::optional<Frame> Session::NextSample(bool large) {
  Subscription* oldest = nullptr;
  for (auto& [channel, subscription] : by_channel_) {
    if (!subscription.waiting || (subscription.waiting->size() >= kLargeMessage) != large) continue;
    if (oldest == nullptr || subscription.turn < oldest->turn) oldest = &subscription;
  }
  if (oldest == nullptr) return std::nullopt;
  return MessageData(oldest->id, oldest->stamp, std::exchange(oldest->waiting, nullptr));
}

std::optional<Frame> Session::NextOfFeeds() {
  std::vector<Subscription*> feeds;
  for (auto& [channel, subscription] : by_channel_) {
    if (subscription.feed != nullptr) feeds.push_back(&subscription);
  }
  std::sort(feeds.begin(), feeds.end(), [](const auto* a, const auto* b) { return a->turn < b->turn; });
  for (Subscription* subscription : feeds) {
    std::optional<Feed::Message> message = subscription->feed->Next(subscription->cursor);
    if (!message) continue;
    subscription->turn = ++turn_;
    return MessageData(subscription->id, message->stamp, std::move(message->bytes));
  }
  return std::nullopt;
}

}  // namespace thalweg::gateway
