#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <stop_token>
#include <vector>

#include "common/dds/bus.h"
#include "services/link/adapter/channels.h"
#include "services/link/adapter/map_bridge.h"
#include "services/link/adapter/options.h"
#include "services/link/core/endpoint.h"

namespace thalweg::link {

/// The buses of a link, which must outlive it.
struct LinkBuses {
  dds::Bus& service;  ///< Its health.
  dds::Bus& local;    ///< The services on this machine; deaf to itself, without health.
  dds::Bus& network;  ///< The other side.
};

// Options of these buses, from those of a service: the services' own machine for two of them, and the link's
// domain on any machine for the third.
dds::BusOptions ServiceBusOptions(dds::BusOptions given);
dds::BusOptions LocalBusOptions(dds::BusOptions given);
dds::BusOptions NetworkBusOptions(dds::BusOptions given, const LinkOptions& options);

/// One side of a link: subscribes to what the other side reads, and publishes what arrives from there.
///
/// Threading: the three buses spin on threads of their own; a fourth sends frames, and is the only one that
/// waits for the network.
class LinkService {
 public:
  LinkService(const LinkOptions& options, Side side, const LinkBuses& buses);
  LinkService(const LinkService&) = delete;
  LinkService& operator=(const LinkService&) = delete;

  void Run(std::stop_token stop);  ///< Spins all buses. Throws what a handler throws.

 private:
  struct Arrived {
    std::uint64_t messages = 0;
    std::optional<Duration> age;  ///< How old the last one was.
  };

  // On the thread of the local bus.
  void OnSample(std::size_t channel, Bytes sample);
  void OfferCloud(Bytes sample, Duration now);
  void OfferPose(std::size_t channel, Bytes sample, Duration now);
  void Offer(std::size_t channel, Message message);
  void OnMapUpdate(Bytes sample);
  void ServeMap();
  void FollowReaders();
  void Deliver(const std::vector<Endpoint::Received>& messages);
  void DeliverCloud(const DecodedMessage& message);
  void DeliverMap(const DecodedMessage& message);

  // On the thread of the network's bus.
  void OnFrame(const thalweg_msgs::msg::LinkFrame& frame);
  void PassRejects();  ///< What the network's bus rejected, which publishes no health, to the service's.

  void SendFrames(const std::stop_token& stop);  // of its own

  // On the thread of the service's bus.
  void FollowLink();
  void ReportHealth();
  void ReportChannel(std::size_t channel);
  void Reject(std::size_t channel, std::string reason);  ///< From any thread.

  LinkOptions options_;
  std::string other_;  ///< Name of the other side.
  LinkBuses buses_;
  std::function<bool(const thalweg_msgs::msg::LinkFrame&)> write_frame_;
  std::function<int()> frame_readers_;
  std::vector<dds::Bus::BytesPublisher> outputs_;  ///< By channel.

  std::mutex mutex_;  ///< Guards endpoint_, map_sender_ and arrived_.
  std::condition_variable news_;
  Endpoint endpoint_;
  MapSender map_sender_;
  std::vector<Arrived> arrived_;

  // Used by the local bus's thread alone.
  std::vector<bool> subscribed_;
  CloudEncoder cloud_encoder_;
  CloudDecoder cloud_decoder_;
  PoseThinning poses_;
  std::map<std::size_t, RateLimit> limits_;
  MapReceiver map_receiver_;
  Duration map_served_{0};

  // Used by the service bus's thread alone.
  bool was_up_ = false;
  Duration changed_{0};
  std::vector<Scheduler::Counts> reported_;
  std::vector<std::uint64_t> reported_kept_;
};

}  // namespace thalweg::link
