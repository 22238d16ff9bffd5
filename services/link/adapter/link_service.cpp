#include "services/link/adapter/link_service.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <stdexcept>
#include <thread>
#include <utility>

#include "common/base/megabytes.h"
#include "common/dds/convert.h"

namespace thalweg::link {
namespace {

namespace topics = dds::topics;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

constexpr auto kIdle = 5ms;           // between looks at what is due, while nothing happens
constexpr auto kTogether = 1ms;       // messages of one moment, such as clock and pose, share a frame
constexpr auto kMapServed = 200ms;    // least between two full copies
constexpr double kSoundOffset = 0.1;  // [s]

Duration Steady() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

Moment Now() {
  return {Steady(), std::chrono::system_clock::now().time_since_epoch()};
}

Endpoint::Options EndpointOptionsFrom(const LinkOptions& options) {
  return {.session = static_cast<std::uint64_t>(Now().system.count()),
          .topics = HashOf(Channels()),
          .keep_bytes = static_cast<std::size_t>(options.keep_mb) * kMegabyte,
          .lost_after = options.lost_after};
}

bool IsCommand(std::size_t channel) {
  return Channels()[channel].topic.delivery == dds::Delivery::kCommand;
}

}  // namespace

dds::BusOptions ServiceBusOptions(dds::BusOptions given) {
  given.local_only = true;
  return given;
}

dds::BusOptions LocalBusOptions(dds::BusOptions given) {
  given.local_only = true;
  given.hears_itself = false;
  given.publish_health = false;
  given.clock = dds::ClockSource::kSystem;  // the run's clock is a topic like the others
  return given;
}

dds::BusOptions NetworkBusOptions(dds::BusOptions given, const LinkOptions& options) {
  given.domain = options.domain;
  given.partition.clear();
  given.local_only = false;
  given.shared_memory = false;
  given.publish_health = false;
  given.clock = dds::ClockSource::kSystem;
  return given;
}

LinkService::LinkService(const LinkOptions& options, Side side, const LinkBuses& buses)
    : options_(options),
      other_(side == Side::kOnboard ? "offboard" : "onboard"),
      buses_(buses),
      endpoint_(EndpointOptionsFrom(options), PoliciesOf(Channels())),
      arrived_(Channels().size()),
      subscribed_(Channels().size()),
      cloud_encoder_(options.clouds),
      poses_({.period = FromSeconds(1.0 / options.pose_rate)}),
      reported_(Channels().size()),
      reported_kept_(Channels().size()) {
  const auto use_frames = [&]<class Out, class In>(Out, In) {
    const auto out = buses.network.Advertise<Out>();
    write_frame_ = [out](const thalweg_msgs::msg::LinkFrame& frame) { return out.Write(frame); };
    frame_readers_ = [out] { return out.readers(); };
    buses.network.Subscribe<In>([this](const auto& frame) { OnFrame(frame); });
  };
  if (side == Side::kOnboard) {
    use_frames(topics::LinkUp(), topics::LinkDown());
  } else {
    use_frames(topics::LinkDown(), topics::LinkUp());
  }
  for (const ChannelTopic& channel : Channels()) {
    outputs_.push_back(buses.local.AdvertiseBytes(channel.topic));
  }
  const Duration clock_period = FromSeconds(1.0 / options.clock_rate);
  limits_.emplace(ChannelOf<topics::Clock>(), RateLimit(clock_period));
  limits_.emplace(ChannelOf<topics::Transforms>(), RateLimit(clock_period));
  endpoint_.scheduler().SetSource(ChannelOf<topics::MapUpdates>(),
                                  [this](Duration now) -> std::optional<Message> {
                                    if (!endpoint_.PeerWants(ChannelOf<topics::MapUpdates>()))
                                      return std::nullopt;
                                    auto bytes = map_sender_.Next(endpoint_.session());
                                    if (!bytes) return std::nullopt;
                                    return Message{*std::move(bytes), now};
                                  });
  const dds::TopicInfo requests = dds::InfoOf<topics::MapRequests>();
  buses.local.SubscribeBytes(requests, [this](const dds::RawSample&) { ServeMap(); });
  buses.local.EveryWall(200ms, [this] { FollowReaders(); });
  buses.local.EveryWall(500ms, [this] {
    if (!subscribed_[ChannelOf<topics::MapUpdates>()]) return;
    const std::scoped_lock lock(mutex_);
    if (const auto request = map_sender_.Request(Time{Now().system})) {
      outputs_[ChannelOf<topics::MapRequests>()].Write(dds::Encode<topics::MapRequests>(*request));
    }
  });
  buses.network.EveryWall(1s, [this] { PassRejects(); });
  buses.service.EveryWall(100ms, [this] { FollowLink(); });
  buses.service.EveryWall(1s, [this] { ReportHealth(); });
}

void LinkService::Run(std::stop_token stop) {
  const auto pass_on = [this](auto&& work) {
    return std::jthread([this, work](const std::stop_token& own) {
      try {
        work(own);
      } catch (const std::exception& error) {
        buses_.service.Post([what = std::string(error.what())] { throw std::runtime_error(what); });
      }
    });
  };
  const std::jthread local = pass_on([this](const std::stop_token& own) { buses_.local.Spin(own); });
  const std::jthread network = pass_on([this](const std::stop_token& own) { buses_.network.Spin(own); });
  const std::jthread sender = pass_on([this](const std::stop_token& own) { SendFrames(own); });
  buses_.service.Spin(stop);
}

void LinkService::Reject(std::size_t channel, std::string reason) {
  buses_.service.Post([this, channel, reason = std::move(reason)] {
    buses_.service.health().Reject(Channels()[channel].topic.name.c_str(), reason);
  });
}

void LinkService::FollowReaders() {
  std::uint64_t wanted = 0;
  for (std::size_t k = 0; k < outputs_.size(); ++k) {
    // Requests for the map are answered here.
    const bool crosses = k != ChannelOf<topics::MapRequests>();
    if (crosses && outputs_[k].readers() > 0) wanted |= std::uint64_t{1} << k;
  }
  std::uint64_t peer_wants = 0;
  {
    const std::scoped_lock lock(mutex_);
    endpoint_.SetWanted(wanted);
    peer_wants = endpoint_.peer_wants();
  }
  for (std::size_t k = 0; k < outputs_.size(); ++k) {
    const bool wants = ((peer_wants >> k) & 1U) != 0 && k != ChannelOf<topics::MapRequests>();
    if (wants == subscribed_[k]) continue;
    subscribed_[k] = wants;
    if (wants) {
      buses_.local.SubscribeBytes(Channels()[k].topic,
                                  [this, k](const dds::RawSample& sample) { OnSample(k, sample.bytes); });
    } else {
      buses_.local.UnsubscribeBytes(Channels()[k].topic.name);
    }
  }
}

void LinkService::OnSample(std::size_t channel, Bytes sample) {
  const Duration now = Steady();
  if (sample.size() > kMostMessageBytes) {
    return Reject(channel, std::to_string(sample.size()) + " bytes are too long for a link");
  }
  if (channel == ChannelOf<topics::DepthPoints>()) return OfferCloud(sample, now);
  if (channel == ChannelOf<topics::MapUpdates>()) return OnMapUpdate(sample);
  if (channel == ChannelOf<topics::Odometry>()) return OfferPose(channel, sample, now);
  if (channel == ChannelOf<topics::Clock>()) {
    const auto clock = dds::Decode<topics::Clock>(sample);
    const auto stamp = clock ? dds::FromIdl(clock->clock()) : Result<Time>(Error{"bytes that are no clock"});
    if (!stamp) return Reject(channel, stamp.error());
    if (!limits_.at(channel).Passes(*stamp)) return;
  }
  if (channel == ChannelOf<topics::Transforms>()) {
    const auto transforms = dds::Decode<topics::Transforms>(sample);
    if (!transforms || transforms->transforms().empty()) return Reject(channel, "no transforms");
    const auto stamp = dds::FromIdl(transforms->transforms().front().header().stamp());
    if (stamp && !limits_.at(channel).Passes(*stamp)) return;
  }
  Offer(channel, {.bytes = {sample.begin(), sample.end()}, .offered = now});
}

void LinkService::OfferPose(std::size_t channel, Bytes sample, Duration now) {
  const auto odometry = dds::Decode<topics::Odometry>(sample);
  if (!odometry) return Reject(channel, "bytes that are no odometry");
  const auto pose = dds::FromIdl(*odometry);
  if (!pose) return Reject(channel, pose.error());
  for (Buffer& message : poses_.Add(pose->stamp, pose->T, {sample.begin(), sample.end()})) {
    Offer(channel, {.bytes = std::move(message), .offered = now});
  }
}

void LinkService::OfferCloud(Bytes sample, Duration now) {
  const std::size_t channel = ChannelOf<topics::DepthPoints>();
  const auto message = dds::Decode<topics::DepthPoints>(sample);
  if (!message) return Reject(channel, "bytes that are no cloud");
  const auto stamped = dds::FromIdl(*message, dds::Infinity::kNoReturn);
  if (!stamped) return Reject(channel, stamped.error());
  if (stamped->cloud.points_C.size() > kMostPoints) return Reject(channel, "too many points for a link");
  CodedCloud coded = cloud_encoder_.Encode(stamped->cloud);
  ByteWriter bytes;
  bytes.U64(static_cast<std::uint64_t>(stamped->stamp.time_since_epoch().count()));
  bytes.Append(coded.bytes);
  Offer(channel, {.bytes = bytes.Take(), .offered = now, .preface = std::move(coded.table)});
}

void LinkService::Offer(std::size_t channel, Message message) {
  {
    const std::scoped_lock lock(mutex_);
    endpoint_.Offer(channel, std::move(message));
  }
  news_.notify_one();
}

void LinkService::OnMapUpdate(Bytes sample) {
  const std::size_t channel = ChannelOf<topics::MapUpdates>();
  const auto update = dds::Decode<topics::MapUpdates>(sample);
  if (!update) return Reject(channel, "bytes that are no update");
  std::optional<std::string> problem;
  {
    const std::scoped_lock lock(mutex_);
    problem = map_sender_.OnUpdate(*update);
  }
  if (problem) return Reject(channel, *problem);
  news_.notify_one();
}

void LinkService::ServeMap() {
  const Duration now = Steady();
  if (now - map_served_ < kMapServed) return;  // a reader repeats its request
  const auto copy = map_receiver_.FullCopy();
  if (!copy) return;
  map_served_ = now;
  outputs_[ChannelOf<topics::MapUpdates>()].Write(dds::Encode<topics::MapUpdates>(*copy));
}

void LinkService::Deliver(const std::vector<Endpoint::Received>& messages) {
  for (const Endpoint::Received& received : messages) {
    if (IsCommand(received.channel) && !(received.age && *received.age <= options_.command_age)) {
      const std::string reason = received.age
                                     ? fmt::format("was under way for {:.1f} s", Seconds(*received.age))
                                     : "was under way for an unknown time";
      buses_.service.Post([this, channel = received.channel, reason] {
        buses_.service.health().Drop(Channels()[channel].topic.name.c_str(), reason, 1);
      });
    } else if (received.channel == ChannelOf<topics::DepthPoints>()) {
      DeliverCloud(received.message);
    } else if (received.channel == ChannelOf<topics::MapUpdates>()) {
      DeliverMap(received.message);
    } else if (received.message.bytes.size() >= 4) {
      outputs_[received.channel].Write(received.message.bytes);
    }
  }
}

void LinkService::DeliverCloud(const DecodedMessage& message) {
  const std::size_t channel = ChannelOf<topics::DepthPoints>();
  if (message.preface) {
    if (const auto error = cloud_decoder_.SetTable(*message.preface)) return Reject(channel, error->text);
  }
  ByteReader in(message.bytes);
  const auto stamp = static_cast<std::int64_t>(in.U64());
  constexpr std::int64_t kMostSeconds = std::numeric_limits<std::int32_t>::max();
  if (!in.good() || stamp < 0 || stamp / 1'000'000'000 > kMostSeconds) {
    return Reject(channel, "a stamp that no clock shows");
  }
  const auto cloud = cloud_decoder_.Decode(in.rest());
  if (!cloud) return Reject(channel, cloud.error());
  outputs_[channel].Write(dds::Encode<topics::DepthPoints>(dds::ToIdl(Time{Duration(stamp)}, *cloud)));
}

void LinkService::DeliverMap(const DecodedMessage& message) {
  const std::size_t channel = ChannelOf<topics::MapUpdates>();
  const auto update = map_receiver_.OnChange(message.bytes);
  if (!update) return Reject(channel, update.error());
  outputs_[channel].Write(dds::Encode<topics::MapUpdates>(*update));
}

void LinkService::OnFrame(const thalweg_msgs::msg::LinkFrame& message) {
  const Frame frame{message.session(), message.number(), message.payload()};
  Endpoint::Taken taken;
  {
    const std::scoped_lock lock(mutex_);
    taken = endpoint_.Take(frame, Now());
    for (const Endpoint::Received& received : taken.messages) {
      ++arrived_[received.channel].messages;
      arrived_[received.channel].age = received.age;
    }
  }
  news_.notify_one();
  if (taken.error) {
    buses_.service.Post([this, error = *taken.error] { buses_.service.health().Reject("frames", error); });
  }
  if (taken.messages.empty()) return;
  buses_.local.Post([this, messages = std::move(taken.messages)] { Deliver(messages); });
}

void LinkService::SendFrames(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::optional<Frame> frame;
    {
      std::unique_lock lock(mutex_);
      const Moment now = Now();
      endpoint_.SetMatched(frame_readers_() > 0, now);
      frame = endpoint_.NextFrame(now);
      if (!frame && news_.wait_for(lock, kIdle) == std::cv_status::no_timeout) {
        lock.unlock();
        std::this_thread::sleep_for(kTogether);
      }
    }
    if (!frame) continue;
    thalweg_msgs::msg::LinkFrame message;
    message.session(frame->session);
    message.number(frame->sequence);
    message.payload(std::move(frame->payload));
    while (!write_frame_(message) && !stop.stop_requested()) {
    }
  }
}

void LinkService::FollowLink() {
  const Duration now = Steady();
  bool up = false;
  {
    const std::scoped_lock lock(mutex_);
    up = endpoint_.up(now);
  }
  if (up == std::exchange(was_up_, up)) return;
  const double lasted = changed_ == Duration(0) ? 0.0 : Seconds(now - changed_);
  changed_ = now;
  if (up) {
    spdlog::info("link to {} up{}", other_, lasted > 0.0 ? fmt::format(" after {:.1f} s", lasted) : "");
  } else {
    spdlog::warn("link to {} lost: no sign of it for {:.1f} s", other_, Seconds(options_.lost_after));
  }
}

void LinkService::PassRejects() {
  buses_.service.Post([this, health = buses_.network.health().ToMessage(buses_.network.Now())] {
    for (const auto& counter : health.rejected()) {
      buses_.service.health().SetRejected("network " + counter.name(), counter.count(), counter.last());
    }
  });
}

void LinkService::ReportChannel(std::size_t channel) {
  dds::Health& health = buses_.service.health();
  const Scheduler::Counts& counts = endpoint_.scheduler().counts(channel);
  const std::string& name = Channels()[channel].topic.name;
  Scheduler::Counts& reported = reported_[channel];
  const Arrived& arrived = arrived_[channel];
  const std::uint64_t kept = endpoint_.dropped_kept(channel);
  if (counts.offered + kept > 0) {
    health.SetCrossed(
        name + " sent", counts.sent,
        fmt::format("{} bytes, {} frames, {} dropped, {:.1f} kB/s", counts.bytes, counts.pieces,
                    counts.dropped + kept, 1e-3 * static_cast<double>(counts.bytes - reported.bytes)));
  }
  if (arrived.messages > 0) {
    const std::string age =
        arrived.age ? fmt::format("age {:.0f} ms", 1e3 * Seconds(*arrived.age)) : "age unknown";
    health.SetCrossed(name + " arrived", arrived.messages, age);
  }
  // The newest clock or status is enough; it is counted above.
  const ChannelPolicy& policy = endpoint_.scheduler().policy(channel);
  const bool matters = policy.priority == Priority::kBulk || policy.most_waiting > 1;
  if (matters && counts.dropped > reported.dropped) {
    const std::uint64_t offered = counts.offered - reported.offered;
    health.Drop(name.c_str(),
                fmt::format("{} of {} cross: newer ones came before the link took them",
                            counts.sent - reported.sent, offered),
                counts.dropped - reported.dropped);
  }
  if (kept > reported_kept_[channel]) {
    health.Drop(name.c_str(),
                fmt::format("the link is cut, and more than link.keep_mb ({}) is kept", options_.keep_mb),
                kept - reported_kept_[channel]);
  }
  reported = counts;
  reported_kept_[channel] = kept;
}

void LinkService::ReportHealth() {
  const std::scoped_lock lock(mutex_);
  for (std::size_t k = 0; k < Channels().size(); ++k) ReportChannel(k);
  const Endpoint::Status status = endpoint_.status();
  const double offset = status.clock_offset ? Seconds(*status.clock_offset) : 0.0;
  dds::Health& health = buses_.service.health();
  health.SetCrossed(
      "frames sent", status.frames_sent,
      fmt::format("{} bytes, round trip {:.0f} ms, window {} bytes, {} messages kept", status.bytes_sent,
                  1e3 * Seconds(status.round_trip), status.window_bytes, status.kept));
  health.SetCrossed("frames arrived", status.frames_received,
                    fmt::format("{} bytes, clock of {} {:+.4f} s +- {:.4f}", status.bytes_received, other_,
                                offset, Seconds(status.clock_delay) / 2.0));
  if (options_.wall_clock && std::abs(offset) > kSoundOffset + Seconds(status.clock_delay) / 2.0) {
    health.Reject("clock offset",
                  fmt::format("the clock of {} is {:.2f} s {} ours: stamps of one side mean another time on "
                              "the other; synchronize the clocks (chrony, ntpd)",
                              other_, std::abs(offset), offset > 0.0 ? "ahead of" : "behind"));
  }
}

}  // namespace thalweg::link
