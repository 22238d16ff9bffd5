#include "services/gateway/core/hub.h"

#include <algorithm>
#include <utility>

#include "services/gateway/core/json_text.h"

namespace thalweg::gateway {
namespace {

std::uint32_t ChannelOf(std::size_t topic) {
  return static_cast<std::uint32_t>(topic) + 1;
}

Channel MakeChannel(std::uint32_t id, std::string_view topic, std::string_view schema_name,
                    std::string_view schema) {
  std::string name = "/";  // as ROS 2 tools show it
  name += topic;
  return {id, std::move(name), "cdr", std::string(schema_name), std::string(schema), "ros2msg", 1};
}

void Add(Hub::Counts& counts, const Session& session) {
  counts.replaced += session.dropped();
  counts.invalid_frames += static_cast<std::uint64_t>(session.invalid_frames());
  if (!session.last_invalid().empty()) counts.last_invalid = session.last_invalid();
  counts.commands += session.commands();
  counts.refused_commands += session.refused_commands();
  if (!session.last_refused().empty()) counts.last_refused = session.last_refused();
}

}  // namespace

Hub::Hub(Options options) : map_points_(std::move(options.map_frame)) {
  content_.name = std::move(options.name);
  content_.session_id = std::move(options.session_id);
  content_.with_time = options.with_time;
  content_.command_topics = std::move(options.command_topics);
  content_.parameters = std::move(options.parameters);
  for (const TopicChannel& topic : options.topics) {
    content_.channels.push_back(
        MakeChannel(ChannelOf(keeps_last_.size()), topic.topic, topic.schema_name, topic.schema));
    content_.channels.back().depth = topic.depth;
    if (topic.topic == options.surface_topic) surface_topic_ = keeps_last_.size();
    keeps_last_.push_back(topic.keeps_last);
  }
  const auto add_feed = [&](const Feed& feed, std::string_view topic, std::string_view name,
                            std::string_view schema) {
    const auto id = static_cast<std::uint32_t>(content_.channels.size()) + 1;
    content_.channels.push_back(MakeChannel(id, topic, name, schema));
    content_.feeds[id] = &feed;
    return id;
  };
  add_feed(blocks_, BlockFeed::kTopic, BlockFeed::kSchemaName, BlockFeed::kSchema);
  add_feed(history_, HistoryFeed::kTopic, HistoryFeed::kSchemaName, HistoryFeed::kSchema);
  map_points_channel_ =
      add_feed(map_points_, MapPointsFeed::kTopic, options.map_points_type, options.map_points_schema);
  surface_channel_ = add_feed(surface_, SurfaceFeed::kTopic, SurfaceFeed::kSchemaName, SurfaceFeed::kSchema);
}

void Hub::CountRefusedRequest(std::string reason) {
  ++departed_.refused_requests;
  departed_.last_refused_request = std::move(reason);
}

Hub::ClientId Hub::Connect(ClientInfo client) {
  sessions_.try_emplace(++last_client_, content_, std::move(client));
  return last_client_;
}

void Hub::Disconnect(ClientId client) {
  const auto found = sessions_.find(client);
  if (found == sessions_.end()) return;
  Add(departed_, found->second);
  sessions_.erase(found);
}

std::vector<Hub::ClientId> Hub::clients() const {
  std::vector<ClientId> ids;
  for (const auto& [id, session] : sessions_) ids.push_back(id);
  return ids;
}

void Hub::OnText(ClientId client, std::string_view text, Duration now) {
  Session& session = sessions_.at(client);
  session.OnText(text, now);
  for (const std::uint32_t channel : session.TakeNewSubscriptions()) {
    const auto kept = kept_.find(channel);
    if (kept == kept_.end()) continue;
    for (const Kept& last : kept->second) session.Offer(channel, last.stamp, last.message);
  }
}

Hub::WantedChanges Hub::TakeWantedChanges(Duration now) {
  WantedChanges changes;
  for (std::size_t topic = 0; topic < keeps_last_.size(); ++topic) {
    const std::uint32_t channel = ChannelOf(topic);
    const bool for_feed = topic == surface_topic_;
    const bool wanted = std::any_of(sessions_.begin(), sessions_.end(), [&](const auto& item) {
      return item.second.Wants(channel) || (for_feed && item.second.Wants(surface_channel_));
    });
    const auto open = wanted_.find(topic);
    if (wanted) {
      if (open == wanted_.end()) changes.begun.push_back(topic);
      wanted_[topic] = std::nullopt;
    } else if (open != wanted_.end()) {
      if (!open->second) open->second = now;
      if (now - *open->second < kLinger) continue;
      changes.ended.push_back(topic);
      wanted_.erase(open);
      kept_.erase(channel);
    }
  }
  return changes;
}

void Hub::OnBinary(ClientId client, std::span<const std::uint8_t> bytes, Duration now) {
  sessions_.at(client).OnBinary(bytes, now);
}

void Hub::Answer(ClientId client, const CommandTicket& ticket, const CommandAnswer& answer) {
  const auto found = sessions_.find(client);
  if (found != sessions_.end()) found->second.Answer(ticket, answer);
}

void Hub::AnswerInvalid(ClientId client, const CommandTicket& ticket, const std::string& reason) {
  const auto found = sessions_.find(client);
  if (found != sessions_.end()) found->second.AnswerInvalid(ticket, reason);
}

void Hub::RefreshMapPoints(Duration now) {
  const bool wanted = std::any_of(sessions_.begin(), sessions_.end(),
                                  [&](const auto& item) { return item.second.Wants(map_points_channel_); });
  if (wanted) map_points_.Refresh(blocks_, now);
}

bool Hub::surface_topic_wanted() const {
  return surface_topic_ && std::any_of(sessions_.begin(), sessions_.end(), [this](const auto& item) {
           return item.second.Wants(ChannelOf(*surface_topic_));
         });
}

void Hub::SetGraph(ConnectionGraph graph) {
  if (content_.graph_version > 0 && graph == content_.graph) return;
  content_.graph = std::move(graph);
  ++content_.graph_version;
}

bool Hub::graph_wanted() const {
  return std::any_of(sessions_.begin(), sessions_.end(),
                     [](const auto& item) { return item.second.wants_graph(); });
}

void Hub::Publish(std::size_t topic, Time stamp, const Bytes& message, std::uint64_t part) {
  const std::uint32_t channel = ChannelOf(topic);
  // A message may still arrive when nobody wants its topic any longer
  if (keeps_last_.at(topic) && wanted_.contains(topic)) {
    std::vector<Kept>& kept = kept_[channel];
    std::erase_if(kept, [&](const Kept& last) { return last.part == part; });
    if (kept.size() >= content_.channels[topic].depth) kept.erase(kept.begin());
    kept.push_back({part, stamp, message});
  }
  for (auto& [id, session] : sessions_) session.Offer(channel, stamp, message);
}

void Hub::PublishTime(Time now) {
  for (auto& [id, session] : sessions_) session.OfferTime(now);
}

void Hub::SetStrategy(const std::string& name) {
  auto& parameters = content_.parameters;
  auto found = std::ranges::find(parameters, kStrategyParameter, &Parameter::name);
  if (found == parameters.end())
    found = parameters.insert(found, Parameter{std::string(kStrategyParameter), ""});
  const std::string value = Dump(name);
  if (std::exchange(found->value, value) == value) return;
  for (auto& [id, session] : sessions_) session.OnParameterChange(found->name);
}

Hub::Counts Hub::counts() const {
  Counts counts = departed_;
  counts.clients = sessions_.size();
  for (const auto& [id, session] : sessions_) {
    Add(counts, session);
    counts.waiting_bytes += session.waiting_bytes();
  }
  return counts;
}

}  // namespace thalweg::gateway
