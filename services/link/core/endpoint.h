#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "services/link/core/clock_offset.h"
#include "services/link/core/reassembly.h"
#include "services/link/core/scheduler.h"
#include "services/link/core/send_window.h"

namespace thalweg::link {

/// The time by two clocks of a machine: one that never jumps, and the one that people read.
struct Moment {
  Duration steady{};
  Duration system{};
};

/// One end of a link: what it sends, what it has received, and what it knows about the other end.
///
/// Frames cross in order and without loss as long as both ends see each other (RELIABLE, KEEP_ALL); when they
/// find each other again, or when one cannot follow, a new session begins. Reports say which frames have
/// arrived, so that the sender knows what the link takes (SendWindow), and which channels are read on the
/// other side: others do not cross.
///
/// While the link is down, messages of channels with `kept` are kept, and cross in order once it is up again;
/// the oldest are dropped beyond keep_bytes.
/// Threading: one thread at a time.
class Endpoint {
 public:
  struct Options {
    std::uint64_t session = 1;  ///< The first; differs after each start.
    std::uint64_t topics = 0;   ///< Hash of the channels' table.
    std::size_t keep_bytes = 64'000'000;
    Duration lost_after = std::chrono::seconds(2);  ///< Without a frame or an acknowledgment.
  };
  Endpoint(const Options& options, std::vector<ChannelPolicy> policies);

  Scheduler& scheduler() { return scheduler_; }
  /// Sets which channels are read here, bit by bit.
  void SetWanted(std::uint64_t channels) { wanted_ = channels; }
  /// Which channels are read on the other side.
  std::uint64_t peer_wants() const { return peer_wants_; }
  bool PeerWants(std::size_t channel) const { return ((peer_wants_ >> channel) & 1U) != 0; }
  /// Takes a message that shall cross; ignored if nobody reads its channel on the other side.
  void Offer(std::size_t channel, Message message);

  /// Says whether the other side has a reader for frames.
  void SetMatched(bool matched, Moment now);
  /// The next frame to be sent; nothing if there is none now.
  std::optional<Frame> NextFrame(Moment now);

  struct Received {
    std::size_t channel = 0;
    DecodedMessage message;
    std::optional<Duration> age;  ///< Since it was offered; nothing while the clocks' offset is unknown.
  };
  /// Takes a frame from anywhere. Returns the messages that it completes; `error` says what is wrong with it.
  struct Taken {
    std::vector<Received> messages;
    std::optional<std::string> error;
    bool new_session = false;  ///< The other side has begun a session; nothing of earlier ones follows.
  };
  Taken Take(const Frame& frame, Moment now);

  bool up(Duration now) const;  ///< Whether frames arrive, and those sent are acknowledged.
  /// Sessions begun since the start: a change means that the other side knows nothing any longer.
  std::uint64_t session() const { return session_; }

  struct Status {
    Duration round_trip{};
    std::optional<Duration> clock_offset;  ///< The other machine's system clock minus this one's.
    Duration clock_delay{};                ///< What the exchange that gave it took.
    std::size_t window_bytes = 0;
    std::size_t kept = 0;  ///< Messages.
    std::size_t kept_bytes = 0;
    std::uint64_t frames_sent = 0;
    std::uint64_t frames_received = 0;
    std::uint64_t bytes_sent = 0;  ///< Payloads alone.
    std::uint64_t bytes_received = 0;
  };
  Status status() const;
  /// Kept messages of a channel that were dropped, because there were too many.
  std::uint64_t dropped_kept(std::size_t channel) const { return dropped_kept_[channel]; }

 private:
  struct Kept {
    std::size_t channel;
    Message message;
  };
  struct Unacknowledged {
    std::uint64_t sequence;  ///< The number of the frame with the last piece.
    std::size_t channel;
    Message message;
  };
  void BeginSession(Duration now);
  void Keep(Kept kept);
  void ReleaseKept(Duration now);
  bool ReportIsDue(Duration now) const;
  Report MakeReport(Moment now) const;
  std::optional<std::string> OnReport(const Report& report, Moment now);
  std::optional<std::string> TakePieces(const Frame& frame, Moment now, Taken& taken);
  std::optional<Duration> AgeOf(std::uint32_t offered_ms, Duration now) const;

  Options options_;
  Scheduler scheduler_;
  Reassembly reassembly_;
  SendWindow window_;
  ClockOffset offset_;

  bool matched_ = false;
  std::uint64_t session_;
  std::uint64_t sequence_ = 0;  ///< The number of the last frame sent.
  Duration session_begin_{0};
  std::deque<Unacknowledged> unacknowledged_;
  std::deque<Kept> kept_;
  std::size_t kept_bytes_ = 0;
  Duration released_{0};  ///< When the last kept cloud was.
  std::vector<std::uint64_t> dropped_kept_;

  std::uint64_t peer_session_ = 0;
  std::uint64_t received_ = 0;  ///< The last frame of that session which arrived in order.
  bool broken_ = false;         ///< Whether the session cannot be followed.
  std::optional<Duration> heard_;
  std::uint64_t wanted_ = 0;
  std::uint64_t peer_wants_ = 0;

  bool owes_report_ = true;  ///< Frames have arrived that no report says.
  Duration reported_{0};
  std::optional<Report> peer_report_;  ///< The last.
  Duration peer_report_at_{0};
  Status status_;
};

}  // namespace thalweg::link
