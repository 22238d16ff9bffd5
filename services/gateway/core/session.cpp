#include "services/gateway/core/session.h"

#include <algorithm>
#include <utility>

#include "common/base/text.h"

namespace thalweg::gateway {
namespace {

constexpr std::size_t kLongestQuoted = 40;

}  // namespace

Session::Session(const ServerContent& content, ClientInfo client)
    : content_(content), client_(std::move(client)) {
  const bool steer = !client_.no_steering;
  Reply(ServerInfo(content.name, content.session_id, {.time = content.with_time, .steer = steer}));
  Reply(Advertise(content.channels));
  if (steer) Reply(AdvertiseServices());
}

void Session::OnText(std::string_view text, Duration now) {
  Handle(ParseText(text), now);
}

void Session::OnBinary(std::span<const std::uint8_t> bytes, Duration now) {
  Handle(ParseBinary(bytes), now);
}

void Session::Handle(const Result<ClientRequest>& request, Duration now) {
  if (closing_) return;
  now_ = now;
  if (request) return std::visit([this](const auto& known) { Do(known); }, *request);
  Reply(Status(StatusLevel::kError, "invalid frame: " + request.error()));
  CountInvalid(request.error());
}

void Session::CountInvalid(const std::string& reason) {
  ++invalid_frames_;
  last_invalid_ = reason;
  if (invalid_frames_ >= kMaxInvalidFrames) closing_ = "too many invalid frames; the last: " + reason;
}

void Session::Do(const SubscribeRequest& request) {
  for (const auto& [id, channel] : request.items) {
    const auto known =
        std::find_if(content_.channels.begin(), content_.channels.end(),
                     [wanted = channel](const Channel& offered) { return offered.id == wanted; });
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
      subscription.depth = known->depth;
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

std::vector<Parameter> Session::ParametersNamed(const std::vector<std::string>& names) const {
  if (names.empty()) return content_.parameters;
  std::vector<Parameter> chosen;
  for (const Parameter& parameter : content_.parameters) {
    if (std::find(names.begin(), names.end(), parameter.name) != names.end()) chosen.push_back(parameter);
  }
  return chosen;
}

void Session::Do(const GetParametersRequest& request) {
  Reply(ParameterValues(ParametersNamed(request.names), request.id));
}

void Session::Do(const SetParametersRequest& request) {
  const bool is_strategy = request.items.size() == 1 && request.items[0].name == kStrategyParameter;
  if (!is_strategy) {
    Reply(Status(StatusLevel::kWarning, "while the run goes on, parameters cannot be changed, except for " +
                                            std::string(kStrategyParameter) + " on its own"));
    // The answer holds the values as they are, so that the client does not show the one it sent.
    return Reply(ParameterValues(content_.parameters, request.id));
  }
  const CommandTicket ticket{std::nullopt, 0, ParameterSetting{request.id, request.items[0]}};
  if (client_.no_steering) return Refuse(ticket, *client_.no_steering);
  Take(ticket, CommandGroup::kOperator, ParseStrategy(request.items[0].value));
}

void Session::Do(const ParameterUpdatesRequest& request) {
  std::vector<std::string> names = request.names;
  if (names.empty()) {
    for (const Parameter& parameter : content_.parameters) names.push_back(parameter.name);
    names.emplace_back(kStrategyParameter);  // which exists once the explorer has said what it is
  }
  for (const std::string& name : names) {
    const bool known = name == kStrategyParameter || !ParametersNamed({name}).empty();
    if (!known) continue;
    if (request.subscribe) {
      watched_.insert(name);
    } else {
      watched_.erase(name);
      changed_.erase(name);
    }
  }
}

void Session::OnParameterChange(const std::string& name) {
  if (watched_.contains(name)) changed_.insert(name);
}

void Session::Do(const ConnectionGraphRequest& request) {
  graph_.reset();
  graph_version_ = 0;
  if (request.subscribe) graph_.emplace();
}

void Session::Do(const ClientAdvertiseRequest& request) {
  for (const auto& [channel, topic, encoding] : request.items) {
    const std::string what = "publishing on \"" + topic.substr(0, kLongestQuoted) + "\"";
    const auto its_group = content_.command_topics.find(topic.starts_with('/') ? topic.substr(1) : topic);
    if (client_.no_steering) {
      Reply(Status(StatusLevel::kError, what + ": " + *client_.no_steering));
    } else if (published_.contains(channel)) {
      Reply(Status(StatusLevel::kError, what + ": the channel's id is already in use"));
    } else if (published_.size() >= kMaxSubscriptions) {
      Reply(Status(StatusLevel::kError, what + ": too many channels"));
    } else if (its_group == content_.command_topics.end()) {
      // Studio announces topics of the robots that it knows before anybody clicks; only a message is refused.
      published_[channel] = {std::nullopt, encoding};
    } else if (encoding != "json" && encoding != "cdr") {
      Reply(Status(StatusLevel::kError, what + ": the encoding must be json or cdr"));
    } else {
      published_[channel] = {its_group->second, encoding};
    }
  }
}

void Session::Do(const ClientUnadvertiseRequest& request) {
  for (const std::uint32_t channel : request.channels) {
    if (published_.erase(channel) > 0) continue;
    Reply(Status(StatusLevel::kWarning, "you do not publish on a channel " + std::to_string(channel)));
  }
}

void Session::Do(const ClientMessage& request) {
  const CommandTicket ticket{std::nullopt, ++messages_};
  const auto channel = published_.find(request.channel);
  if (client_.no_steering) return Refuse(ticket, *client_.no_steering);
  if (channel == published_.end()) {
    return RefuseInvalid(ticket, "you have not advertised a channel " + std::to_string(request.channel));
  }
  const auto& [group, encoding] = channel->second;
  if (!group) {
    std::vector<std::string> names;
    for (const auto& [each, its_group] : content_.command_topics) names.push_back("/" + each);
    return Refuse(ticket, "clients publish on " + Joined(names, " and ") + " only");
  }
  if (encoding == "json") {
    return Take(ticket, *group,
                ParseCommand(*group, std::string(request.message.begin(), request.message.end())));
  }
  if (const auto reason = WhyNotNow()) return Refuse(ticket, *reason);
  new_commands_.push_back({ticket, request.message, *group});
}

void Session::Do(const ServiceCall& request) {
  const CommandTicket ticket{request.service, request.call};
  const std::span<const CommandService> services = CommandServices();
  if (client_.no_steering) return Refuse(ticket, *client_.no_steering);
  if (request.service == 0 || request.service > services.size()) {
    return RefuseInvalid(ticket, "there is no service " + std::to_string(request.service));
  }
  if (request.encoding != "json") return RefuseInvalid(ticket, "the request's encoding must be json");
  const CommandService& service = services[request.service - 1];
  Take(ticket, service.group(), ParseRequest(service, request.request));
}

void Session::Take(const CommandTicket& ticket, CommandGroup group, const Result<Command>& command) {
  if (!command) return RefuseInvalid(ticket, command.error());
  if (const auto reason = WhyNotNow()) return Refuse(ticket, *reason);
  new_commands_.push_back({ticket, *command, group});
}

/// Why a command cannot be taken at this moment; counts it where it can.
std::optional<std::string> Session::WhyNotNow() {
  allowance_ += kCommandsPerSecond * Seconds(std::max(now_ - allowance_at_, Duration::zero()));
  allowance_ = std::min(allowance_, kCommandBurst);
  allowance_at_ = now_;
  if (allowance_ < 1.0) return "more than 5 commands a second";
  if (pending_ >= kMaxPending) return "8 commands wait for their answers already";
  allowance_ -= 1.0;
  ++pending_;
  ++commands_;
  return std::nullopt;
}

void Session::Refuse(const CommandTicket& ticket, const std::string& reason) {
  ++refused_commands_;
  last_refused_ = reason;
  if (ticket.service) return Reply(ServiceCallFailure(*ticket.service, ticket.call, reason));
  Reply(Status(StatusLevel::kError, "command refused: " + reason));
  if (const auto& setting = ticket.setting)
    Reply(ParameterValues(ParametersNamed({setting->wanted.name}), setting->id));
}

std::vector<ClientCommand> Session::TakeCommands() {
  return std::exchange(new_commands_, {});
}

void Session::Answer(const CommandTicket& ticket, const CommandAnswer& answer) {
  if (pending_ > 0) --pending_;
  if (ticket.service) return Reply(ServiceResponse(*ticket.service, ticket.call, ToJson(answer)));
  if (const auto& setting = ticket.setting) {
    if (!answer.accepted)
      Reply(Status(StatusLevel::kWarning, answer.service + ": refused: " + answer.reason));
    const std::vector<Parameter> now =
        answer.accepted ? std::vector{setting->wanted} : ParametersNamed({setting->wanted.name});
    return Reply(ParameterValues(now, setting->id));
  }
  Reply(Status(answer.accepted ? StatusLevel::kInfo : StatusLevel::kWarning,
               answer.service + ": " + (answer.accepted ? "" : "refused: ") + answer.reason,
               "command " + std::to_string(ticket.call)));
}

void Session::AnswerInvalid(const CommandTicket& ticket, const std::string& reason) {
  if (pending_ > 0) --pending_;
  RefuseInvalid(ticket, reason);
}

void Session::RefuseInvalid(const CommandTicket& ticket, const std::string& reason) {
  Refuse(ticket, reason);
  CountInvalid(reason);
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
  if (subscription.waiting.empty()) subscription.turn = ++turn_;
  if (subscription.waiting.size() >= subscription.depth) {
    ++dropped_;  // the newer one keeps the turn, so that a fast channel cannot push others back
    subscription.waiting.pop_front();
  }
  subscription.waiting.emplace_back(stamp, message);
  return true;
}

void Session::OfferTime(Time now) {
  if (content_.with_time) time_ = now;
}

std::size_t Session::waiting_bytes() const {
  std::size_t bytes = 0;
  for (const Frame& frame : replies_) bytes += frame.size();
  for (const auto& [channel, subscription] : by_channel_) {
    for (const auto& [stamp, message] : subscription.waiting) bytes += message->size();
  }
  return bytes;
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
  if (!changed_.empty()) {
    const std::set<std::string> changed = std::exchange(changed_, {});
    return ParameterValues(ParametersNamed({changed.begin(), changed.end()}), "");
  }
  if (time_) return TimeFrame(*std::exchange(time_, std::nullopt));
  if (graph_ && graph_version_ != content_.graph_version) {
    graph_version_ = content_.graph_version;
    return ConnectionGraphUpdate(std::exchange(*graph_, content_.graph), content_.graph);
  }
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
    if (subscription.waiting.empty()) continue;
    if ((subscription.waiting.front().second->size() >= kLargeMessage) != large) continue;
    if (oldest == nullptr || subscription.turn < oldest->turn) oldest = &subscription;
  }
  if (oldest == nullptr) return std::nullopt;
  auto [stamp, message] = std::move(oldest->waiting.front());
  oldest->waiting.pop_front();
  oldest->turn = ++turn_;
  return MessageData(oldest->id, stamp, std::move(message));
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
