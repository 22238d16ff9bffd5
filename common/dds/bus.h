#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "common/base/time.h"
#include "common/dds/health.h"
#include "common/dds/topics.h"

namespace thalweg::dds {

/// The clock that Now() and Every() follow.
enum class ClockSource {
  kSystem,  ///< The machine's clock.
  kTopic,   ///< The simulator's clock, which stands still until the first `clock` message arrives.
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
  std::string discovery_server;   ///< HOST:PORT; empty = multicast discovery.
  bool publish_health = true;     ///< Whether to publish health once a second, on topics::Health.
};

/// A DDS participant with its topics, readers, writers, QoS and timers, and their shutdown.
///
/// Threading: handlers of Subscribe and Every run only inside Spin, on the spinning thread, one at a time, so
/// that the data they use needs no lock. Publisher's functions, Post and Now may be called from any thread;
/// everything else only on the spinning thread or before it spins.
/// Errors: the constructor, Advertise and Subscribe throw std::runtime_error naming what failed. A topic has
/// one type on a bus; using it with another throws an error that names both types. Exceptions thrown by a
/// handler propagate out of Spin.
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
    bool Write(const MessageOf<Topic>& message) const { return bus_->WriteRaw(writer_, &message); }
    int readers() const { return bus_->MatchedReaders(writer_); }  ///< Number of matched readers.

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

  /// Number of writers matched with the reader of `Topic`; 0 if there is no such reader.
  template <class Topic>
  int Writers() const;

  /// Calls `handler` once per `period` of this bus's clock; a timer that is late fires once, not once per
  /// missed period. If a clock topic jumps back (the simulator was restarted), timers restart from there.
  void Every(Duration period, std::function<void()> handler);
  /// The same on the machine's steady clock, whichever clock this bus follows.
  void EveryWall(Duration period, std::function<void()> handler);

  /// Runs `task` on the spinning thread as soon as possible.
  void Post(std::function<void()> task);

  /// Time on this bus's clock; the epoch until the first message if that is a topic.
  Time Now() const;

  /// Handles messages, timers and tasks until a stop is requested. First logs the bus's description, its
  /// domain and the topics it listens to, so that even a process that receives nothing shows what it waits
  /// for.
  void Spin(std::stop_token stop);
  /// The same until `done` returns true, which is checked after each event (a match is one); returns false if
  /// `timeout` of wall time passes first.
  bool SpinUntil(const std::function<bool()>& done, Duration timeout);

  Health& health() { return *health_; }

 private:
  using TopicDataType = eprosima::fastdds::dds::TopicDataType;
  struct State;
  int AdvertiseRaw(const char* topic, Delivery delivery, TopicDataType* type);
  template <class Topic>
  void SubscribeAs(const char* name, bool from_others, std::function<void(const MessageOf<Topic>&)> handler);
  void SubscribeRaw(const char* topic, Delivery delivery, TopicDataType* type, bool from_others,
                    std::function<void(const void*)> handler);
  int WritersOfRaw(const char* topic) const;
  bool WriteRaw(int writer, const void* message) const;
  int MatchedReaders(int writer) const;

  std::unique_ptr<Health> health_;
  std::unique_ptr<State> state_;
};

template <class Topic>
Bus::Publisher<Topic> Bus::Advertise() {
  return {this, AdvertiseRaw(Topic::kName, Topic::kDelivery, new typename Topic::Type())};
}

template <class Topic>
void Bus::Subscribe(std::function<void(const MessageOf<Topic>&)> handler) {
  SubscribeAs<Topic>(Topic::kName, false, std::move(handler));
}

template <class Topic>
void Bus::SubscribeTo(const std::string& name, std::function<void(const MessageOf<Topic>&)> handler) {
  SubscribeAs<Topic>(name.c_str(), true, std::move(handler));
}

template <class Topic>
void Bus::SubscribeAs(const char* name, bool from_others,
                      std::function<void(const MessageOf<Topic>&)> handler) {
  SubscribeRaw(name, Topic::kDelivery, new typename Topic::Type(), from_others,
               [handler = std::move(handler)](const void* message) {
                 handler(*static_cast<const MessageOf<Topic>*>(message));
               });
}

template <class Topic>
int Bus::Writers() const {
  return WritersOfRaw(Topic::kName);
}

}  // namespace thalweg::dds
