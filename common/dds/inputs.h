#pragma once

#include <deque>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <functional>
#include <string>

#include "common/dds/bus_participant.h"
#include "common/dds/endpoints.h"
#include "common/dds/health.h"
#include "common/dds/peers.h"

namespace thalweg::dds {

/// The readers of a bus: which samples are handed to handlers, and from which writers.
///
/// Threading: the spinning thread.
class Inputs {
 public:
  using Handler = std::function<void(void* sample, const Arrival& arrival)>;
  /// What the readers use of their bus; all of it must outlive them.
  struct Surroundings {
    BusParticipant& participant;
    eprosima::fastdds::dds::WaitSet& wait_set;     ///< Wakes the thread when samples arrive,
    eprosima::fastdds::dds::GuardCondition& wake;  ///< and when writers come or go.
    const Peers& peers;
    Health& health;
    std::function<void(const char* what)> doing;  ///< Called with what is handled next, for the watchdog.
  };
  explicit Inputs(Surroundings surroundings) : its_(std::move(surroundings)) {}
  ~Inputs();
  Inputs(const Inputs&) = delete;
  Inputs& operator=(const Inputs&) = delete;

  /// Opens a reader.
  /// @param from_others  Whether the bus must not receive what it writes itself.
  void Add(const TopicInfo& topic, const BusParticipant::Topic& its_topic, bool from_others, Keep keep,
           Handler handler);
  /// Opens the reader of a topic again that was closed. @return Whether there is one.
  bool OpenAgain(const std::string& topic, Keep keep, Handler handler);
  void Close(const std::string& topic);

  /// Handles what the readers hold, of a flood a part.
  void TakeAll();
  /// Closes all readers, before the participant is replaced.
  void Suspend();
  /// Opens those again that were open.
  void Resume();

  /// After waiting: adapts readers to the writers that have come or gone, and notes which may hold samples.
  void Look();
  bool any_ready() const;
  std::size_t size() const { return inputs_.size(); }
  /// Hands a sample of reader `k`, if it has one, to its handler; of streams, the newest one. @return Whether
  /// there was one.
  bool TakeFrom(std::size_t k);

  int WritersOf(const std::string& topic) const;  ///< Matched ones; 0 if there is no such reader.
  bool WantsOthersOnly(const std::string& topic) const;
  std::string Introduction() const;  ///< The topics, for people.
  /// The writer of the sample that is being handled.
  const WriterId& sender() const { return sender_; }

 private:
  void Open(Input& input);
  void Close(Input& input);
  /// Reads a writer that offers no reliable delivery, while no other is there.
  void AdaptReliability(Input& input);
  void Reopen(Input& input, bool best_effort);
  bool Take(Input& input);
  void Handle(Input& input, const eprosima::fastdds::dds::SampleInfo& info);
  /// Whether the sample that was taken is to be handled. Counts it if it is not.
  bool IsUsable(Input& input, const eprosima::fastdds::dds::SampleInfo& info);
  bool IsFromItsWriter(Input& input, const WriterId& writer);
  void NoteClockOffset(Input& input, const eprosima::fastdds::dds::SampleInfo& info);
  std::string NameOf(const WriterId& writer) const;

  Surroundings its_;
  std::deque<Input> inputs_;  ///< A deque, walked by index, since handlers may append to it meanwhile.
  WriterId sender_;
};

}  // namespace thalweg::dds
