#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <fastdds/dds/core/condition/GuardCondition.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/dds/checked_type.h"
#include "common/dds/clock_offset.h"
#include "common/dds/sequence_gaps.h"
#include "common/dds/sole_writer.h"
#include "common/dds/topic_table.h"

namespace thalweg::dds {

// The readers and writers of a Bus.

using WriterId = eprosima::fastrtps::rtps::InstanceHandle_t;

/// Whether an endpoint belongs to a participant.
bool IsOf(const WriterId& endpoint, const eprosima::fastrtps::rtps::GuidPrefix_t& participant);

/// How a sample came.
struct Arrival {
  Time source_stamp;     ///< When it was written.
  Time reception_stamp;  ///< When it arrived.
  std::uint64_t missed;  ///< Samples of its writer since the last one that was read.
};

/// Keeps the matched peers of one writer or reader, and wakes the thread that spins when they change.
///
/// Threading: any thread.
class Matches final : public eprosima::fastdds::dds::DataWriterListener,
                      public eprosima::fastdds::dds::DataReaderListener {
 public:
  /// @param ignored  Participant whose endpoints do not count.
  Matches(std::string topic, eprosima::fastdds::dds::GuardCondition& wake,
          std::optional<eprosima::fastrtps::rtps::GuidPrefix_t> ignored)
      : topic_(std::move(topic)), wake_(wake), ignored_(ignored) {}
  int count() const { return count_; }
  bool Holds(const WriterId& peer) const;
  /// Whether `test` holds for one of the peers.
  bool Any(const std::function<bool(const WriterId&)>& test) const;
  /// Whether a writer was refused since the last call only because it offers no reliable delivery.
  bool TakeBestEffortOffered() { return best_effort_offered_.exchange(false); }
  /// Whether a reader was refused since the last call because it requests more than is offered.
  bool TakeRefusedReader() { return refused_reader_.exchange(false); }
  /// Whether the last peer has gone since the last call.
  bool TakeLastGone() { return last_gone_.exchange(false); }

  void on_publication_matched(eprosima::fastdds::dds::DataWriter*,
                              const eprosima::fastdds::dds::PublicationMatchedStatus& status) override;
  void on_subscription_matched(eprosima::fastdds::dds::DataReader*,
                               const eprosima::fastdds::dds::SubscriptionMatchedStatus& status) override;
  void on_offered_incompatible_qos(
      eprosima::fastdds::dds::DataWriter*,
      const eprosima::fastdds::dds::OfferedIncompatibleQosStatus& status) override;
  void on_requested_incompatible_qos(
      eprosima::fastdds::dds::DataReader*,
      const eprosima::fastdds::dds::RequestedIncompatibleQosStatus& status) override;

 private:
  void Set(const WriterId& peer, int change);

  std::string topic_;
  eprosima::fastdds::dds::GuardCondition& wake_;
  std::optional<eprosima::fastrtps::rtps::GuidPrefix_t> ignored_;
  std::atomic<int> count_ = 0;
  std::atomic<bool> best_effort_offered_ = false;
  std::atomic<bool> last_gone_ = false;
  std::atomic<bool> refused_reader_ = false;
  mutable std::mutex mutex_;
  std::vector<WriterId> peers_;
};

/// The samples that a writer keeps for readers that come later, so that the next writer of the same topic can
/// offer them, too: Fast DDS does not give back what a writer holds.
///
/// Threading: any thread.
class LateSamples {
 public:
  LateSamples(CheckedType& type, std::size_t most) : type_(type), most_(most) {}

  /// Keeps the message and lets `writer` send it. @return As DataWriter::write.
  bool Write(eprosima::fastdds::dds::DataWriter& writer, const void* message);
  /// Lets `writer` send what is kept.
  void WriteAgain(eprosima::fastdds::dds::DataWriter& writer);

 private:
  CheckedType& type_;
  std::size_t most_;
  std::mutex mutex_;  ///< Held while a writer sends, so that the order is the same.
  std::deque<std::vector<std::uint8_t>> samples_;  ///< As they travel.
};

struct Output {
  std::string topic;
  Delivery delivery;
  eprosima::fastdds::dds::DataWriter* writer;  ///< Null after a participant could not be replaced.
  std::unique_ptr<Matches> matches;
  std::unique_ptr<LateSamples> late_samples;  ///< Null if none are kept.
  std::set<std::string> logged = {};          ///< About readers that request more than is offered.
};

/// An object into which messages are decoded one after another.
struct Sample {
  explicit Sample(CheckedType& its_type) : type(&its_type) { Renew(); }
  void Renew() {
    data = std::shared_ptr<void>(type->createData(), [its = type](void* object) { its->deleteData(object); });
    most_bytes = 0;
  }
  /// Call after the use of each message: gives back the memory that a much larger one needed.
  void Settle();

  CheckedType* type;
  std::shared_ptr<void> data;
  std::size_t bytes = 0;       ///< Size of the message, as it travels.
  std::size_t most_bytes = 0;  ///< Size of the largest message that this object held.
};

struct Input {
  TopicInfo topic;
  /// May change the sample, which is not used again.
  std::function<void(void* sample, const Arrival& arrival)> handler;
  CheckedType* type;
  Sample sample;                                         ///< The one that was taken last.
  Sample newest;                                         ///< The one to be used.
  eprosima::fastdds::dds::DataReader* reader = nullptr;  ///< Null while unsubscribed.
  std::unique_ptr<Matches> matches;
  bool from_others = false;  ///< Whether the bus must not receive what it writes itself.
  SoleWriter<WriterId> sole_writer;
  SequenceGaps<WriterId> gaps;
  Keep keep = Keep::kAsDelivered;
  ClockOffset clock_offset = {};
  bool best_effort = false;  ///< Whether the reader takes what is not delivered reliably.
  bool ignores_one = false;  ///< Whether a writer is ignored because it offers no reliable delivery.
  bool ready = false;        ///< Whether the reader may hold samples.
  bool suspended = false;    ///< Whether it has no reader only while the participant is replaced.

  /// Whether a handler that is late gets the newest sample alone. Undecoded samples are for recorders, which
  /// want each of them.
  bool newest_only() const;
};

}  // namespace thalweg::dds
