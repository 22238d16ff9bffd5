#include "services/gateway/adapter/gateway_service.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "common/base/hash.h"
#include "common/base/stage_names.h"
#include "common/base/text.h"
#include "common/base/version.h"
#include "common/dds/convert.h"
#include "common/dds/schema.h"
#include "common/dds/topic_table.h"
#include "services/gateway/adapter/command_message.h"
#include "services/gateway/adapter/parameters.h"

namespace thalweg::gateway {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
namespace topics = dds::topics;

/// Several services publish health at once; a client that takes no more than the last message would take the
/// others for dead.
constexpr std::size_t kDepthOfShared = 32;
/// Log lines of all services that a client receives that comes late.
constexpr std::size_t kLogLines = 200;
/// Name of the counters of what clients sent in vain, and of what they did not get. The page looks for the
/// latter (panels.js).
constexpr auto kViewers = "viewers";

std::size_t DepthOf(const dds::TopicInfo& topic) {
  if (topic.delivery == dds::Delivery::kDiary) return kLogLines;
  return topic.writers == dds::Writers::kMany ? kDepthOfShared : 1;
}

std::vector<TopicChannel> AllChannels() {
  std::vector<TopicChannel> channels;
  for (const dds::TopicInfo& topic : dds::AllTopics()) {
    const std::string type = dds::Ros2TypeName(topic.type_name);
    // The last pose too: where a replay is paused there is no next one.
    const bool keeps_last = topic.delivery == dds::Delivery::kState ||
                            topic.delivery == dds::Delivery::kDiary || topic.name == topics::Odometry::kName;
    channels.push_back({topic.name, type, std::string(dds::Ros2MsgSchema(type)), keeps_last, DepthOf(topic)});
  }
  return channels;
}

Hub::Options ContentFrom(bool with_time, const Scenario& scenario, const dds::Names& names) {
  Hub::Options content;
  content.name = "thalweg " + std::string(Version());
  content.session_id = std::to_string(std::chrono::system_clock::now().time_since_epoch().count());
  content.with_time = with_time;
  content.topics = AllChannels();
  content.parameters = ParametersOf(scenario);
  content.command_topics = {{topics::OperatorCommands::kName, CommandGroup::kOperator},
                            {topics::ReplayCommands::kName, CommandGroup::kReplay}};
  content.surface_topic = topics::SurfaceUpdates::kName;
  content.map_points_type = dds::Ros2TypeName(dds::InfoOf<topics::DepthPoints>().type_name);
  content.map_frame = names.Frame(dds::kMapFrame);
  content.map_points_schema = std::string(dds::Ros2MsgSchema(content.map_points_type));
  return content;
}

/// The graph of a partition with the names that channels have; topics that are none of ROS 2's are left out.
ConnectionGraph GraphFrom(const dds::BusGraph& bus, const std::string& partition, const dds::Names& names,
                          bool steers) {
  std::map<std::string, std::string> channel_of;  // by topic on the wire
  for (const dds::TopicInfo& topic : dds::AllTopics()) {
    channel_of[dds::WireTopic(names.Topic(topic.name))] = topic.name;
  }
  ConnectionGraph graph;
  for (const dds::Endpoint& endpoint : bus.endpoints) {
    const auto& its = endpoint.partitions;
    if (its.empty() ? !partition.empty() : std::ranges::find(its, partition) == its.end()) continue;
    const auto known = channel_of.find(endpoint.topic);
    const auto topic = known != channel_of.end() ? known->second : dds::TopicName(endpoint.topic);
    if (!topic) continue;
    auto& nodes = (endpoint.writes ? graph.publishers : graph.subscribers)["/" + *topic];
    const dds::Participant* const node = bus.Find(endpoint.participant);
    nodes.insert(node != nullptr && !node->name.empty() ? node->name : endpoint.participant);
  }
  if (steers) {
    for (const CommandService& service : CommandServices()) graph.providers[NameOf(service)] = {"gateway"};
  }
  return graph;
}

/// Which part of the topic's state a message is. Several publish static transforms, each of its own frames;
/// no log line takes the place of another.
std::uint64_t PartOf(std::size_t topic, std::span<const std::uint8_t> bytes, std::uint64_t samples) {
  if (dds::AllTopics()[topic].delivery == dds::Delivery::kDiary) return samples;
  if (dds::AllTopics()[topic].name != topics::StaticTransforms::kName) return 0;
  const auto message = dds::Decode<topics::StaticTransforms>(bytes);
  if (!message) return 0;
  std::uint64_t hash = HashOf("");
  for (const auto& transform : message->transforms()) hash = HashOf(transform.child_frame_id() + '\n', hash);
  return hash;
}

constexpr auto kPatience = 20s;       // for the answer to a command
constexpr auto kSettling = 300ms;     // until all topics of a replay that has jumped have arrived
constexpr double kStatusDelay = 0.5;  // [s] that the status of a replay may take
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

}  // namespace

GatewayService::GatewayService(const ListenOptions& options, bool with_time, const Scenario& scenario,
                               PageFiles page, const dds::BusOptions& bus_options, dds::Bus& bus,
                               dds::Bus& channels)
    : names_(bus_options.names),
      partition_(bus_options.partition),
      bus_(bus),
      channels_(channels),
      requests_out_(bus.Advertise<topics::MapRequests>()),
      surface_requests_out_(bus.Advertise<topics::SurfaceRequests>()),
      replay_(bus, !options.read_only, [this](const auto& status) { OnReplay(status); }),
      row_{Time(), kUnknown, kUnknown, kUnknown, 0.0F, 0.0F, kUnknown},
      server_(options, ContentFrom(with_time, scenario, names_), std::move(page),
              {[this](const Hub::WantedChanges& changes) { OnWanted(changes); },
               [this](Hub::ClientId client, const ClientInfo& info, const ClientCommand& command) {
                 OnCommand(client, info, command);
               }}) {
  if (!options.read_only) operator_.emplace(bus);
  bus.Subscribe<topics::MapUpdates>([this](const auto& message) { OnMapUpdate(message); });
  bus.Subscribe<topics::Odometry>([this](const auto& message) { OnOdometry(message); });
  bus.Subscribe<topics::ExplorationStatus>([this](const auto& message) { OnExploration(message); });
  bus.EveryWall(500ms, [this] {
    if (map_.missing()) requests_out_.Write(map_.MakeRequest(bus_.Now(), "gateway"));
  });
  channels.EveryWall(500ms, [this] {
    if (surface_wanted_ && surface_.missing()) {
      surface_requests_out_.Write(surface_.MakeRequest(bus_.Now(), "gateway"));
    }
  });
  bus.EveryWall(100ms, [this] {
    server_.Post([now = bus_.Now()](Hub& hub) {
      hub.PublishTime(now);
      hub.RefreshMapPoints(std::chrono::steady_clock::now().time_since_epoch());
    });
    AddToHistory();
  });
  bus.EveryWall(1s, [this] {
    server_.Post([this](Hub& hub) {
      bus_.Post([this, counts = hub.counts(), graph_wanted = hub.graph_wanted()] {
        Report(counts);
        if (graph_wanted) PassGraph();
      });
      channels_.Post([this, passed = hub.surface_topic_wanted()] { surface_passed_ = passed; });
    });
  });
}

void GatewayService::OnMapUpdate(const thalweg_msgs::msg::MapUpdate& message) {
  const auto applied = map_.Apply(message);
  if (!applied) return bus_.health().Reject<topics::MapUpdates>(applied.error());
  if (!*applied) return;
  const OccupancyGrid& grid = map_.grid();
  std::vector<BlockStates> blocks;
  if ((*applied)->replaced) {
    grid.ForEachBlock([&](const VoxelIndex& index, const OccupancyGrid::Block& block) {
      blocks.push_back(StatesOf(index, block));
    });
  } else {
    std::set<std::tuple<std::int32_t, std::int32_t, std::int32_t>> changed;
    for (const VoxelChange& change : (*applied)->changes) {
      const VoxelIndex block = OccupancyGrid::BlockOf(change.voxel);
      changed.emplace(block.x, block.y, block.z);
    }
    for (const auto& [x, y, z] : changed) blocks.push_back(StatesOf({x, y, z}, *grid.FindBlock({x, y, z})));
  }
  const Inbox::MapChange change{bus_.Now(), grid.voxel_size(), (*applied)->replaced, std::move(blocks)};
  if (inbox_.Put(change)) PassInbox();
}

void GatewayService::OnOdometry(const nav_msgs::msg::Odometry& message) {
  const auto pose = dds::FromIdl(message);
  if (!pose) return bus_.health().Reject<topics::Odometry>(pose.error());
  row_.stamp = pose->stamp;
  const Eigen::Vector3f position = pose->T.translation().cast<float>();
  std::tie(row_.x, row_.y, row_.z) = std::tuple(position.x(), position.y(), position.z());
  has_pose_ = true;
}

void GatewayService::OnExploration(const thalweg_msgs::msg::ExplorationStatus& message) {
  if (const std::string strategy = CleanText(message.strategy()); strategy != strategy_) {
    strategy_ = strategy;
    server_.Post([strategy](Hub& hub) { hub.SetStrategy(strategy); });
  }
  row_.distance_m = static_cast<float>(message.distance_m());
  for (const auto& timing : message.timings()) {
    if (timing.name() == kPlanStage && timing.count() > 0)
      row_.planning_ms = static_cast<float>(timing.p50_ms());
  }
}

void GatewayService::AddToHistory() {
  if (!has_pose_ || std::chrono::steady_clock::now() < settled_) return;
  server_.Post([row = row_](Hub& hub) mutable {
    row.known_m3 = static_cast<float>(hub.blocks().known_volume());
    hub.history().Add(row);
  });
}

void GatewayService::OnWanted(const Hub::WantedChanges& changes) {
  channels_.Post([this, changes] {
    const std::span<const dds::TopicInfo> all = dds::AllTopics();
    for (const std::size_t topic : changes.ended) {
      channels_.UnsubscribeBytes(all[topic].name);
      if (all[topic].name != topics::SurfaceUpdates::kName) continue;
      surface_wanted_ = false;
      surface_ = SurfaceCopy();
    }
    for (const std::size_t topic : changes.begun) {
      surface_wanted_ = surface_wanted_ || all[topic].name == topics::SurfaceUpdates::kName;
      // Where several publish, what one has sent must not replace what another has before it was read.
      const bool shared = all[topic].writers == dds::Writers::kMany;
      channels_.SubscribeBytes(
          all[topic], [this, topic](const dds::RawSample& sample) { OnSample(topic, sample); },
          shared ? dds::Keep::kForRecording : dds::Keep::kAsDelivered);
    }
  });
}

void GatewayService::OnCommand(Hub::ClientId client, const ClientInfo& info, const ClientCommand& command) {
  bus_.Post(
      [this, client, sender = info.name + " at " + info.address, command] { Obey(client, sender, command); });
}

void GatewayService::Obey(Hub::ClientId client, const std::string& sender, const ClientCommand& command) {
  if (command.group == CommandGroup::kReplay) return ObeyForReplay(client, sender, command);
  auto message = ToMessage(command.content);
  if (!message) return AnswerInvalid(client, command.ticket, message.error());
  message->sender(sender);
  spdlog::info("client {} ({}) sends {}", client, sender, Described(*message));
  operator_->Send(*message, kPatience, [this, client, ticket = command.ticket](const auto& reply) {
    CommandAnswer answer = {false, "gateway", reply ? reply->reason() : reply.error()};
    if (reply) std::tie(answer.accepted, answer.service) = std::tuple(reply->accepted(), reply->service());
    Answer(client, ticket, answer);
  });
}

void GatewayService::ObeyForReplay(Hub::ClientId client, const std::string& sender,
                                   const ClientCommand& command) {
  if (replay_.status() == nullptr) {
    return Answer(client, command.ticket, {false, "gateway", dds::ReplayClient::kNothing});
  }
  auto message = ToReplayMessage(command.content, replay_.TimeAt({}));
  if (!message) return AnswerInvalid(client, command.ticket, message.error());
  message->sender(sender);
  spdlog::info("client {} ({}) sends {}", client, sender, Described(*message));
  replay_.Send(*message, kPatience, [this, client, ticket = command.ticket](const auto& answer) {
    Answer(client, ticket, {bool(answer), "replay", answer ? *answer : answer.error()});
  });
}

void GatewayService::Answer(Hub::ClientId client, const CommandTicket& ticket, const CommandAnswer& answer) {
  spdlog::info("the {} answers client {}: {}{}", answer.service, client,
               answer.accepted ? "" : "refused: ", answer.reason);
  server_.Post([client, ticket, answer](Hub& hub) { hub.Answer(client, ticket, answer); });
}

void GatewayService::AnswerInvalid(Hub::ClientId client, const CommandTicket& ticket,
                                   const std::string& reason) {
  server_.Post([client, ticket, reason](Hub& hub) { hub.AnswerInvalid(client, ticket, reason); });
}

/// Notices where a replay goes on from another time.
void GatewayService::OnReplay(const thalweg_msgs::msg::ReplayStatus& status) {
  const auto time = dds::FromIdl(status.now());
  if (!time) return bus_.health().Reject<topics::ReplayStatus>(time.error());
  const auto now = std::chrono::steady_clock::now();
  if (replayed_) {
    const double passed = Seconds(*time - *replayed_);
    const double most = status.rate() * (Seconds(now - replayed_at_) + kStatusDelay) + kStatusDelay;
    if (passed < 0.0 || passed > most) {
      settled_ = now + kSettling;
      server_.Post([](Hub& hub) { hub.history().Interrupt(); });
    }
  }
  replayed_ = *time;
  replayed_at_ = now;
}

void GatewayService::PassGraph() {
  server_.Post([graph = GraphFrom(bus_.Graph(), partition_, names_, operator_.has_value())](
                   Hub& hub) mutable { hub.SetGraph(std::move(graph)); });
}

void GatewayService::OnSurface(std::span<const std::uint8_t> bytes) {
  const auto message = dds::Decode<topics::SurfaceUpdates>(bytes);
  if (!message) return;  // those who read the topic as it is may make something of it
  const auto change = surface_.Apply(*message);
  if (!change) {
    return bus_.Post(
        [this, reason = change.error()] { bus_.health().Reject<topics::SurfaceUpdates>(reason); });
  }
  if (*change && inbox_.Put(**change)) PassInbox();
}

void GatewayService::OnSample(std::size_t topic, const dds::RawSample& sample) {
  if (dds::AllTopics()[topic].name == topics::SurfaceUpdates::kName) {
    OnSurface(sample.bytes);
    if (!surface_passed_) return;
  }
  auto bytes = std::make_shared<const std::vector<std::uint8_t>>(sample.bytes.begin(), sample.bytes.end());
  const std::uint64_t part = PartOf(topic, sample.bytes, ++samples_);
  if (inbox_.Put({topic, bus_.Now(), std::move(bytes), part})) PassInbox();
}

void GatewayService::PassInbox() {
  server_.Post([this](Hub& hub) {
    const Inbox::Content content = inbox_.TakeAll();
    if (const auto& map = content.map)
      hub.blocks().Update(map->stamp, map->voxel_size, map->replaced, map->blocks);
    if (content.surface) hub.surface().Update(*content.surface);
    for (const Inbox::Item& item : content.items) {
      hub.Publish(item.topic, item.stamp, item.message, item.part);
    }
  });
}

void GatewayService::Report(const Hub::Counts& counts) {
  if (counts.invalid_frames > reported_.invalid_frames) {
    bus_.health().Reject(kViewers, counts.last_invalid, counts.invalid_frames - reported_.invalid_frames);
  }
  if (counts.refused_commands > reported_.refused_commands) {
    bus_.health().Reject("viewers' commands", counts.last_refused,
                         counts.refused_commands - reported_.refused_commands);
  }
  if (counts.refused_requests > reported_.refused_requests) {
    bus_.health().Reject("requests", counts.last_refused_request,
                         counts.refused_requests - reported_.refused_requests);
  }
  if (counts.replaced > reported_.replaced) {
    bus_.health().Drop(kViewers, "a slow client gets only the newest message of a channel",
                       counts.replaced - reported_.replaced);
  }
  if (const std::uint64_t replaced = inbox_.TakeReplaced(); replaced > 0) {
    bus_.health().Drop(kViewers, "the server is busy: newer messages of the topic came before it was free",
                       replaced);
  }
  reported_ = counts;
}

}  // namespace thalweg::gateway
