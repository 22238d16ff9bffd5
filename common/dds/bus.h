#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>

#include "common/base/time.h"
#include "common/dds/bus_graph.h"
#include "common/dds/health.h"
#include "common/dds/log_lines.h"
#include "common/dds/names.h"
#include "common/dds/topic_table.h"
#include "common/dds/topics.h"
#include "common/dds/type_support.h"

namespace thalweg::dds {

/// The clock that Now() and Every() follow.
enum class ClockSource {
  kSystem,  ///< The machine's clock.
  kTopic,   ///< The simulator's clock, which stands still until the first `clock` message arrives.
  kOwn,     ///< A clock that this process sets by SetNow, as the one that publishes `clock`.
};

struct BusOptions {
  std::string name;   ///< Name of the participant, and of the service in its health messages, e.g. "mapper".
  std::string about;  ///< Description in the first line that Spin logs, e.g. "scenario kitchen".
  int domain = 0;     ///< 0 to 232.
  /// Only participants of the same partition see each other; empty = the default partition.
  std::string partition;
  ClockSource clock = ClockSource::kSystem;
  bool shared_memory = true;  ///< In addition to UDP, for peers on the same machine.
  /// [MB] Size of the shared-memory segment; larger samples are sent over UDP.
  int segment_mb = 64;
  std::string network_interface;  ///< IPv4 address to bind to; empty = all.
  std::string discovery_server;   ///< HOST:PORT[;HOST:PORT]...; empty = multicast discovery.
  /// HOST,HOST,...: machines to which the participant announces itself, in addition to multicast. All
  /// machines must know each other. It then uses UDP alone.
  std::string peers;
  /// Whether its readers receive what its own writers send; if not, its readers do not count as readers of
  /// its writers either. For tools that read and write the same topics.
  bool hears_itself = true;
  bool local_only = false;  ///< Whether to ignore participants on other machines.
  /// Folder of the keys that deploy/make-keys wrote (security.h); empty = no security. With it, participants
  /// without keys are not heard and do not hear, and topics that the role does not allow are refused.
  std::string security_dir;
  Names names;  ///< What topics and frames are called on the wire, but for those of undecoded samples.
  bool publish_health = true;  ///< Whether to publish health once a second, on topics::Health.
  /// Whether only one participant of this name may run in the domain and partition, on any machine: Spin of a
  /// second one throws. Without effect where publish_health is off, since copies know each other by that.
  bool sole = false;
  /// Whether it learns of all writers and readers of the domain, also those that it does not match: see
  /// Graph.
  bool surveys = false;
  /// Where this process keeps its log lines, to be published on topics::Log; null = they are not
  /// published. Without effect where publish_health is off.
  std::shared_ptr<LogLines> log = nullptr;
  /// Spin ends the process (abort) if a handler, timer or task takes this long: it hangs, and a supervisor
  /// can start another. Time in which the whole process stands still does not count. 0 = never.
  Duration watchdog = std::chrono::seconds(20);
};

/// A sample as it arrived, undecoded. Valid during the handler's call.
struct RawSample {
  std::span<const std::uint8_t> bytes;  ///< Encapsulation header of 4 bytes and CDR; see topic_table.h.
  Time source_stamp;                    ///< When it was written, by the writer's system clock.
  Time reception_stamp;                 ///< When it arrived, by this machine's system clock.
  /// Samples of the same writer since the last one that was handled: lost on the way, or replaced by newer
  /// ones before this process read them.
  std::uint64_t missed;
};

struct Arrival;

/// A DDS participant with its topics, readers, writers, QoS and timers, and their shutdown.
///
/// Threading: handlers of Subscribe and Every run only inside Spin, on the spinning thread, one at a time, so
/// that the data they use needs no lock. Publisher's functions, Post and Now may be called from any thread;
/// everything else only on the spinning thread or before it spins.
/// Errors: the constructor, Advertise and Subscribe throw std::runtime_error naming what failed. A topic has
/// one type on a bus; using it with another throws an error that names both types, and using it both decoded
/// and undecoded throws as well. Exceptions thrown by a handler propagate out of Spin.
/// Strangers: datagrams that are no well-formed RTPS messages never reach Fast DDS (rtps_message.h). Where a
/// topic has one writer, a reader follows the first one and refuses the samples of others until that one is
/// gone or has been silent for a second (0.5 s for commands). Both are counted in health().
class Bus {
 public:
  explicit Bus(const BusOptions& options);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  template <class Topic>
  class Publisher {
   public:
    /// Sends the message to all matched readers. Does not block for long; returns false if the message could
    /// not be queued.
    bool Write(const MessageOf<Topic>& message) const {
      if (!bus_->names_.renames_frames()) return bus_->WriteRaw(writer_, &message);
      MessageOf<Topic> renamed = message;
      ToWireFrames(bus_->names_, renamed);
      return bus_->WriteRaw(writer_, &renamed);
    }
    int readers() const { return bus_->MatchedReaders(writer_); }  ///< Number of matched readers.
    /// As BytesPublisher::AwaitDelivery.
    bool AwaitDelivery(Duration patience) const { return bus_->AwaitDelivery(writer_, patience); }

   private:
    friend class Bus;
    Publisher(Bus* bus, int writer) : bus_(bus), writer_(writer) {}
    Bus* bus_;
    int writer_;
  };

  /// Creates the topic's writer; the result is valid as long as the bus. Throws if the topic is already
  /// advertised.
  template <class Topic>
  Publisher<Topic> Advertise();

  /// Calls `handler` with each message that arrives. Bytes that cannot be decoded as a message of this type
  /// are counted in health() as rejected and do not reach the handler.
  template <class Topic>
  void Subscribe(std::function<void(const MessageOf<Topic>&)> handler);

  /// The same for a topic whose name is a setting, with the type and delivery of `Topic`. Such a topic is
  /// meant to come from another process: throws if this bus itself advertises it, since a service would then
  /// read its own output.
  template <class Topic>
  void SubscribeTo(const std::string& name, std::function<void(const MessageOf<Topic>&)> handler);

  /// A writer of samples that are encoded already.
  class BytesPublisher {
   public:
    /// As Publisher::Write, for a sample as RawSample::bytes holds it.
    bool Write(std::span<const std::uint8_t> bytes) const;
    int readers() const { return bus_->MatchedReaders(writer_); }
    /// Waits until all matched readers that are reliable have what was written; returns false if they do not
    /// in time.
    bool AwaitDelivery(Duration patience) const { return bus_->AwaitDelivery(writer_, patience); }

   private:
    friend class Bus;
    BytesPublisher(Bus* bus, int writer) : bus_(bus), writer_(writer) {}
    Bus* bus_;
    int writer_;
  };
  /// The same for tools that handle topics without knowing their types: samples pass undecoded.
  BytesPublisher AdvertiseBytes(const TopicInfo& topic);
  /// Calls `handler` with the samples of all writers, also where the topic should have one.
  void SubscribeBytes(const TopicInfo& topic, std::function<void(const RawSample&)> handler,
                      Keep keep = Keep::kAsDelivered);
  /// Ends a subscription of SubscribeBytes. Not from within its handler.
  void UnsubscribeBytes(const std::string& topic);

  /// Number of writers matched with the reader of `Topic`; 0 if there is no such reader.
  template <class Topic>
  int Writers() const;

  /// The other participants of the domain; with BusOptions::surveys also their writers and readers, in all
  /// partitions. Discovery takes up to three seconds. Any thread.
  BusGraph Graph() const;

  /// Calls `handler` once per `period` of this bus's clock; a timer that is late fires once, not once per
  /// missed period. If a clock topic jumps back (the simulator was restarted), timers restart from there.
  void Every(Duration period, std::function<void()> handler);
  /// The same on the machine's steady clock, whichever clock this bus follows.
  void EveryWall(Duration period, std::function<void()> handler);

  /// Runs `task` on the spinning thread as soon as possible.
  void Post(std::function<void()> task);

  /// Time on this bus's clock; the epoch until the first message if that is a topic.
  Time Now() const;
  /// Sets this bus's clock, which must be ClockSource::kOwn. Threading: the spinning thread.
  void SetNow(Time now);

  /// Handles messages, timers and tasks until a stop is requested. First logs the bus's description, its
  /// domain and the topics it listens to, so that even a process that receives nothing shows what it waits
  /// for. Guarded by BusOptions::watchdog.
  void Spin(std::stop_token stop);
  /// The same until `done` returns true, which is checked after each event (a match is one); returns false if
  /// `timeout` of wall time passes first.
  bool SpinUntil(const std::function<bool()>& done, Duration timeout);

  Health& health() { return *health_; }

 private:
  struct State;
  using RawHandler = std::function<void(void* sample, const Arrival& arrival)>;
  int AdvertiseRaw(const std::string& topic, Delivery delivery, TypeSupport type);
  template <class Topic>
  void SubscribeAs(const std::string& name, bool from_others,
                   std::function<void(const MessageOf<Topic>&)> handler);
  void SubscribeRaw(const TopicInfo& topic, TypeSupport type, bool from_others, Keep keep,
                    RawHandler handler);
  int WritersOfRaw(const char* topic) const;
  bool WriteRaw(int writer, const void* message) const;
  int MatchedReaders(int writer) const;
  bool AwaitDelivery(int writer, Duration patience) const;

  void PublishLog();

  Names names_;
  std::unique_ptr<Health> health_;
  std::unique_ptr<State> state_;
  std::shared_ptr<LogLines> log_;
  std::optional<Publisher<topics::Log>> log_out_;
};

template <class Topic>
Bus::Publisher<Topic> Bus::Advertise() {
  return {this, AdvertiseRaw(Topic::kName, Topic::kDelivery, TypeSupportOf<Topic>())};
}

template <class Topic>
void Bus::Subscribe(std::function<void(const MessageOf<Topic>&)> handler) {
  SubscribeAs<Topic>(Topic::kName, false, std::move(handler));
}

template <class Topic>
void Bus::SubscribeTo(const std::string& name, std::function<void(const MessageOf<Topic>&)> handler) {
  SubscribeAs<Topic>(name, true, std::move(handler));
}

template <class Topic>
void Bus::SubscribeAs(const std::string& name, bool from_others,
                      std::function<void(const MessageOf<Topic>&)> handler) {
  TopicInfo topic = InfoOf<Topic>();
  topic.name = name;
  // Other systems have frames of their own.
  const bool renames = names_.renames_frames() && !from_others;
  SubscribeRaw(topic, TypeSupportOf<Topic>(), from_others, Keep::kAsDelivered,
               [this, renames, handler = std::move(handler)](void* sample, const Arrival&) {
                 auto& message = *static_cast<MessageOf<Topic>*>(sample);
                 const auto problem = renames ? ToOwnFrames(names_, message) : std::optional<std::string>();
                 if (problem) return health().Reject<Topic>(*problem);
                 handler(message);
               });
}

template <class Topic>
int Bus::Writers() const {
  return WritersOfRaw(Topic::kName);
}

}  // namespace thalweg::dds
