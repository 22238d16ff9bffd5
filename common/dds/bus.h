#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "common/base/time.h"
#include "common/dds/health.h"
#include "common/dds/topics.h"

namespace thalweg::dds {

/// Which clock Now() and Every() follow.
enum class ClockSource {
  kSystem,  ///< The machine's.
  kTopic,   ///< The simulator's: stands still until the first `clock` message comes.
};

struct BusOptions {
  std::string name;   ///< Of the participant and in its health; e.g. "mapper".
  std::string about;  ///< What it is there for, in the line that Spin logs first; e.g. "scenario kitchen".
  int domain = 0;     ///< 0 to 232.
  std::string partition;  ///< Participants meet only within one partition; empty = the default one.
  ClockSource clock = ClockSource::kSystem;
  bool shared_memory = true;      ///< Beside UDP, for peers on the same machine.
  int segment_mb = 64;            ///< [MB] Of shared memory; samples larger than it go over UDP.
  std::string network_interface;  ///< IPv4 address to bind to; empty = all.
  std::string discovery_server;   ///< HOST:PORT; empty = multicast discovery.
  bool publish_health = true;     ///< Once a second, on topics::Health.
};

/// One DDS participant: owns its topics, readers, writers, QoS, timers and shutdown.
///
/// Threading: Subscribe and Every handlers run only inside Spin, on the thread that spins, one at a time; so
/// what they touch needs no lock. Publisher's functions, Post and Now may be called from any thread, all else
/// on the thread that spins or before it does.
/// Errors: the constructor, Advertise and Subscribe throw std::runtime_error naming what failed; a topic has
/// one type on a bus, and another one is refused by both names. What a handler throws leaves Spin.
class Bus {
 public:
  explicit Bus(const BusOptions& options);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  template <class Topic>
  class Publisher {
   public:
    /// Takes the message to all matched readers. Never blocks for long; false when it could not be queued.
    bool Write(const MessageOf<Topic>& message) const { return bus_->WriteRaw(writer_, &message); }
    int readers() const { return bus_->MatchedReaders(writer_); }  ///< Matched now.

   private:
    friend class Bus;
    Publisher(Bus* bus, int writer) : bus_(bus), writer_(writer) {}
    Bus* bus_;
    int writer_;
  };

  /// Valid as long as the bus lives. Once a topic: throws when it is advertised already.
  template <class Topic>
  Publisher<Topic> Advertise();

  /// Calls `handler` with each message that comes. Messages whose bytes are no such message are counted in
  /// health() as rejected and never arrive.
  template <class Topic>
  void Subscribe(std::function<void(const MessageOf<Topic>&)> handler);

  /// The same for a topic whose name is a setting, with the type and delivery of `Topic`. Such a topic comes
  /// from other processes: throws when this bus itself advertises it, since a service would read its own
  /// output.
  template <class Topic>
  void SubscribeTo(const std::string& name, std::function<void(const MessageOf<Topic>&)> handler);

  /// Writers matched now by the reader of `Topic`; 0 when there is no such reader.
  template <class Topic>
  int Writers() const;

  /// Calls `handler` each `period` of this bus's clock; a late timer fires once, not once a missed period.
  /// When a clock topic jumps backwards (its simulator was restarted) timers begin anew from there.
  void Every(Duration period, std::function<void()> handler);
  /// The same by the machine's steady clock, whatever this bus's clock is.
  void EveryWall(Duration period, std::function<void()> handler);

  /// Runs `task` on the spinning thread, soon.
  void Post(std::function<void()> task);

  /// Of this bus's clock; the epoch before the first message when that is a topic.
  Time Now() const;

  /// Handles messages, timers and tasks until asked to stop. Logs what this is about, where, and what it
  /// listens to: a process that hears nothing says at least what it waits for.
  void Spin(std::stop_token stop);
  /// The same until `done`, asked after each event (a match is one); false when `timeout` of wall time
  /// passes first.
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
