#include "services/recorder/adapter/recorder.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "common/dds/convert.h"
#include "common/dds/map_replica.h"
#include "common/dds/schema.h"
#include "common/dds/topic_table.h"
#include "services/recorder/core/topic_pattern.h"

namespace thalweg::recorder {
namespace {

constexpr Duration kRequestPeriod = dds::MapReplica::kRequestPeriod;

std::vector<dds::TopicInfo> TopicsOf(const std::vector<std::string>& patterns) {
  std::vector<dds::TopicInfo> topics;
  for (const dds::TopicInfo& topic : dds::AllTopics()) {
    if (patterns.empty() || MatchesAny(patterns, topic.name)) topics.push_back(topic);
  }
  return topics;
}

std::vector<Channel> ChannelsOf(const std::vector<dds::TopicInfo>& topics) {
  std::vector<Channel> channels;
  for (const dds::TopicInfo& topic : topics) {
    Channel channel;
    channel.topic = '/' + topic.name;
    channel.type = dds::Ros2TypeName(topic.type_name);
    channel.schema = dds::Ros2MsgSchema(channel.type);
    channels.push_back(std::move(channel));
  }
  return channels;
}

}  // namespace

Recorder::Recorder(const RecorderOptions& options, dds::Bus& bus)
    : bus_(bus),
      topics_(TopicsOf(options.topics)),
      sequences_(topics_.size()),
      file_(options.recording, ChannelsOf(topics_)),
      queue_(options.queue_bytes) {
  status_.files = file_.files();
  for (std::size_t k = 0; k < topics_.size(); ++k) {
    HoldStates(k, topics_[k]);
    Subscribe(k);
  }
  const auto health_out = bus.AdvertiseBytes(dds::InfoOf<dds::topics::Health>());
  bus.EveryWall(std::chrono::seconds(1), [health_out, &bus] {
    health_out.Write(dds::Encode<dds::topics::Health>(bus.health().ToMessage(bus.Now())));
  });
  RequestFullCopy<dds::topics::MapUpdates, dds::topics::MapRequests>(options.map_frame, bus);
  RequestFullCopy<dds::topics::SurfaceUpdates, dds::topics::SurfaceRequests>(options.map_frame, bus);
  thread_ = std::thread([this] { WriteUntilClosed(); });
}

void Recorder::Subscribe(std::size_t topic) {
  bus_.SubscribeBytes(
      topics_[topic], [this, topic](const dds::RawSample& sample) { OnSample(topic, sample); },
      dds::Keep::kForRecording);
}

/// Full copies are requested of those who have them, rather than followed at the price of decoding each
/// update.
void Recorder::HoldStates(std::size_t channel, const dds::TopicInfo& topic) {
  if (topic.delivery == dds::Delivery::kState) file_.Hold(channel, topic);
}

void Recorder::Add(const OutsideTopic& topic) {
  Channel channel;
  channel.topic = '/' + std::string(BusName(topic.info.name));
  channel.type = topic.type;
  channel.schema = topic.definition;
  {
    const std::scoped_lock lock(mutex_);
    added_.emplace_back(std::move(channel), topic.info);
  }
  topics_.push_back(topic.info);
  sequences_.push_back(0);
  Subscribe(topics_.size() - 1);
}

Recorder::~Recorder() {
  Finish();
}

void Recorder::Finish() {
  queue_.Close();
  if (thread_.joinable()) thread_.join();
}

template <class Updates, class Requests>
void Recorder::RequestFullCopy(const std::string& map_frame, dds::Bus& bus) {
  if (std::ranges::find(topics_, Updates::kName, &dds::TopicInfo::name) == topics_.end()) return;
  FullCopies& copies = full_copies_[Updates::kName];
  copies.is_full = [](std::span<const std::uint8_t> sample) {
    const auto update = dds::Decode<Updates>(sample);
    return update && update->full();
  };
  const auto requests_out = bus.AdvertiseBytes(dds::InfoOf<Requests>());
  bus.EveryWall(kRequestPeriod, [this, requests_out, map_frame, &copies, &bus] {
    if (copies.files >= file_count() || bus.Writers<Updates>() == 0) return;
    thalweg_msgs::msg::MapRequest request;
    request.header(dds::MakeHeader(bus.Now(), map_frame));
    request.reader(bus.health().service());
    request.reason(copies.files == 0 ? "a recording begins" : "another file of a recording begins");
    requests_out.Write(dds::Encode<Requests>(request));
  });
}

void Recorder::OnSample(std::size_t topic, const dds::RawSample& sample) {
  if (sample.missed > 0) CountLost(topic, sample.missed);
  QueuedMessage message{.topic = topic,
                        .sequence = sequences_[topic]++,
                        .log_time = sample.reception_stamp,
                        .publish_time = sample.source_stamp,
                        .payload = {sample.bytes.begin(), sample.bytes.end()}};
  // The count is taken before the push: a file that begins between the two may miss the copy, and gets
  // another.
  const std::size_t files = file_count();
  if (queue_.TryPush(std::move(message))) {
    const auto copies = full_copies_.find(topics_[topic].name);
    if (copies == full_copies_.end() || copies->second.files >= files) return;
    if (copies->second.is_full(sample.bytes)) copies->second.files = files;
    return;
  }
  const std::scoped_lock lock(mutex_);
  if (status_.failure) return;
  ++status_.dropped[topics_[topic].name];
  bus_.health().Drop(topics_[topic].name.c_str(), "came faster than it could be written");
}

void Recorder::CountLost(std::size_t topic, std::uint64_t count) {
  sequences_[topic] += static_cast<std::uint32_t>(count);
  const std::scoped_lock lock(mutex_);
  if (status_.failure) return;
  status_.lost[topics_[topic].name] += count;
  bus_.health().Drop(topics_[topic].name.c_str(), "did not arrive", count);
}

void Recorder::Write(const QueuedMessage& message) {
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& [channel, topic] : std::exchange(added_, {}))
      HoldStates(file_.AddChannel(channel), topic);
  }
  file_.Write(message.topic, message.sequence, message.log_time, message.publish_time, message.payload);
  const std::scoped_lock lock(mutex_);
  ++status_.messages;
  status_.payload_bytes += message.payload.size();
}

void Recorder::WriteUntilClosed() try {
  constexpr Duration kTurn = std::chrono::milliseconds(100);
  while (!queue_.exhausted()) {
    if (const auto message = queue_.Pop(kTurn)) Write(*message);
    file_.FlushIfDue();
    const std::scoped_lock lock(mutex_);
    status_.file_bytes = file_.bytes_written();
    status_.files = file_.files();
  }
  file_.Close();
  const std::scoped_lock lock(mutex_);
  status_.file_bytes = file_.bytes_written();
} catch (const std::exception& error) {
  {
    const std::scoped_lock lock(mutex_);
    status_.failure = error.what();
    status_.file_bytes = file_.bytes_written();
    status_.files = file_.files();
  }
  queue_.Close();
}

std::size_t Recorder::file_count() const {
  const std::scoped_lock lock(mutex_);
  return status_.files.size();
}

Recorder::Status Recorder::status() const {
  const std::scoped_lock lock(mutex_);
  return status_;
}

}  // namespace thalweg::recorder
