#include "services/link/core/endpoint.h"

#include <algorithm>
#include <utility>

#include "common/base/check.h"

namespace thalweg::link {
namespace {

using std::chrono_literals::operator""ms;

constexpr Duration kReportPeriod = 250ms;      // when nothing else crosses
constexpr Duration kLeastReportPeriod = 20ms;  // when frames arrive
constexpr Duration kLeastBetweenKept = 10ms;   // of late clouds
constexpr Duration kLeastSession = 500ms;      // between two that the other side asks for
constexpr std::size_t kFrameOverhead = 130;    // [byte] of RTPS, UDP, IP and Ethernet

std::vector<bool> PackedOf(const std::vector<ChannelPolicy>& policies) {
  std::vector<bool> packed;
  for (const ChannelPolicy& policy : policies) packed.push_back(policy.packed);
  return packed;
}

std::size_t SizeOf(const Message& message) {
  constexpr std::size_t kOverhead = 100;
  return message.bytes.size() + kOverhead;
}

}  // namespace

Endpoint::Endpoint(const Options& options, std::vector<ChannelPolicy> policies)
    : options_(options),
      scheduler_(policies),
      reassembly_(PackedOf(policies)),
      session_(options.session),
      dropped_kept_(policies.size()) {}

void Endpoint::Offer(std::size_t channel, Message message) {
  if (!PeerWants(channel)) return;
  const bool kept = scheduler_.policy(channel).kept;
  if (kept && (!kept_.empty() || !up(message.offered))) return Keep({channel, std::move(message)});
  scheduler_.Offer(channel, std::move(message));
}

void Endpoint::Keep(Kept kept) {
  kept_bytes_ += SizeOf(kept.message);
  kept_.push_back(std::move(kept));
  while (kept_bytes_ > options_.keep_bytes) {
    kept_bytes_ -= SizeOf(kept_.front().message);
    ++dropped_kept_[kept_.front().channel];
    kept_.pop_front();
  }
}

void Endpoint::ReleaseKept(Duration now) {
  while (!kept_.empty()) {
    Kept& front = kept_.front();
    const ChannelPolicy& policy = scheduler_.policy(front.channel);
    // A channel on which the newest wins must be done with one message before it gets the next, and what
    // comes after that in time stays behind it.
    const bool has_room = policy.most_waiting == 1 ? scheduler_.idle(front.channel)
                                                   : scheduler_.waiting(front.channel) < policy.most_waiting;
    // A reader of clouds that is late gets the newest, so that a burst would lose most of them.
    const bool is_bulk = policy.priority == Priority::kBulk;
    if (!has_room || (is_bulk && now - released_ < kLeastBetweenKept)) return;
    if (is_bulk) released_ = now;
    kept_bytes_ -= SizeOf(front.message);
    scheduler_.Offer(front.channel, std::move(front.message));
    kept_.pop_front();
  }
}

void Endpoint::SetMatched(bool matched, Moment now) {
  if (matched && !matched_) BeginSession(now.steady);
  matched_ = matched;
}

void Endpoint::BeginSession(Duration now) {
  ++session_;
  sequence_ = 0;
  session_begin_ = now;
  window_.Clear();
  scheduler_.Restart(now);
  // What is kept goes in order: first what was sent and perhaps lost, then what waited, bulk behind poses.
  const auto keep_first = [&](std::size_t channel, Message message) {
    kept_bytes_ += SizeOf(message);
    kept_.push_front({channel, std::move(message)});
  };
  for (const Priority priority : {Priority::kBulk, Priority::kPose}) {
    for (std::size_t channel = 0; channel < scheduler_.channels(); ++channel) {
      const ChannelPolicy& policy = scheduler_.policy(channel);
      if (!policy.kept || policy.priority != priority) continue;
      std::deque<Message> waiting = scheduler_.TakeWaiting(channel);
      for (; !waiting.empty(); waiting.pop_back()) keep_first(channel, std::move(waiting.back()));
    }
  }
  for (; !unacknowledged_.empty(); unacknowledged_.pop_back()) {
    Unacknowledged& last = unacknowledged_.back();
    if (scheduler_.policy(last.channel).kept) {
      keep_first(last.channel, std::move(last.message));
    } else {
      scheduler_.Offer(last.channel, std::move(last.message), true);
    }
  }
}

bool Endpoint::up(Duration now) const {
  return matched_ && heard_ && now - *heard_ < options_.lost_after &&
         window_.OldestAge(now) < options_.lost_after;
}

bool Endpoint::ReportIsDue(Duration now) const {
  return now - reported_ >= (owes_report_ ? kLeastReportPeriod : kReportPeriod);
}

Report Endpoint::MakeReport(Moment now) const {
  Report report;
  report.topics = options_.topics;
  report.wanted = wanted_;
  report.session = peer_session_;
  report.received = received_;
  report.restart = broken_;
  report.sent = now.steady.count();
  report.system_minus_steady = (now.system - now.steady).count();
  if (peer_report_) {
    report.echo_sent = peer_report_->sent;
    report.echo_received = peer_report_at_.count();
  }
  return report;
}

std::optional<Frame> Endpoint::NextFrame(Moment now) {
  if (!matched_) return std::nullopt;
  if (up(now.steady)) ReleaseKept(now.steady);
  const bool report = ReportIsDue(now.steady);
  ByteWriter payload;
  if (report) Put(payload, MakeReport(now));
  std::vector<Scheduler::Finished> finished;
  // Only reports cross until the other side has said what it reads.
  if (peer_report_ && !window_.exhausted()) {
    finished = scheduler_.Fill(payload, window_.full() ? Priority::kPose : Priority::kBulk, now.steady);
  }
  if (payload.empty()) return std::nullopt;
  ++sequence_;
  if (report) {
    reported_ = now.steady;
    owes_report_ = false;
  }
  for (Scheduler::Finished& done : finished) {
    if (!scheduler_.policy(done.channel).repeats_unacknowledged) continue;
    unacknowledged_.push_back({sequence_, done.channel, std::move(done.message)});
  }
  window_.OnSent(sequence_, payload.size() + kFrameOverhead, now.steady);
  ++status_.frames_sent;
  status_.bytes_sent += payload.size();
  return Frame{session_, sequence_, payload.Take()};
}

std::optional<std::string> Endpoint::OnReport(const Report& report, Moment now) {
  if (report.topics != options_.topics) {
    peer_wants_ = 0;
    return "the other side has other topics: both must be of the same version";
  }
  peer_wants_ = report.wanted;
  if (report.session == session_ && report.received <= sequence_) {
    window_.OnAcknowledged(report.received, now.steady);
    while (!unacknowledged_.empty() && unacknowledged_.front().sequence <= report.received) {
      unacknowledged_.pop_front();
    }
    if (report.restart && now.steady - session_begin_ > kLeastSession) BeginSession(now.steady);
  }
  if (report.echo_sent != 0) {
    offset_.Add(Duration(report.echo_sent), Duration(report.echo_received), Duration(report.sent),
                now.steady);
  }
  if (const auto steady = offset_.estimate()) {
    status_.clock_offset = steady->offset + Duration(report.system_minus_steady) - (now.system - now.steady);
    status_.clock_delay = steady->delay;
  }
  peer_report_ = report;
  peer_report_at_ = now.steady;
  return std::nullopt;
}

std::optional<Duration> Endpoint::AgeOf(std::uint32_t offered_ms, Duration now) const {
  const auto offset = offset_.estimate();
  if (!offset) return std::nullopt;
  const std::uint32_t age = MillisecondsOf(now + offset->offset) - offered_ms;
  // Rounding may make it negative by little
  return std::chrono::milliseconds(std::max<std::int32_t>(0, static_cast<std::int32_t>(age)));
}

std::optional<std::string> Endpoint::TakePieces(const Frame& frame, Moment now, Taken& taken) {
  ByteReader in(frame.payload);
  while (!in.rest().empty()) {
    if (in.rest().front() == kReportChannel) {
      in.U8();
      const Result<Report> report = TakeReport(in);
      if (!report) return report.error();
      if (auto error = OnReport(*report, now)) return error;
      continue;
    }
    owes_report_ = true;
    const Result<Piece> piece = TakePiece(in);
    if (!piece) return piece.error();
    Result<std::optional<DecodedMessage>> message = reassembly_.Add(*piece);
    if (!message) return message.error();
    if (!*message) continue;
    const auto age = AgeOf((*message)->offered_ms, now.steady);
    taken.messages.push_back({piece->channel, **std::move(message), age});
  }
  return std::nullopt;
}

Endpoint::Taken Endpoint::Take(const Frame& frame, Moment now) {
  Taken taken;
  heard_ = now.steady;
  ++status_.frames_received;
  status_.bytes_received += frame.payload.size();
  if (frame.session != peer_session_) {
    if (frame.session < peer_session_ && frame.sequence != 1)
      return taken;  // a late one of an earlier session
    peer_session_ = frame.session;
    received_ = 0;
    broken_ = false;
    peer_report_.reset();
    offset_.Clear();
    reassembly_.Clear();
    taken.new_session = true;
  }
  if (broken_) return taken;
  if (frame.payload.size() > kFrameBytes) {
    taken.error = "a frame of " + std::to_string(frame.payload.size()) + " bytes";
  } else if (frame.sequence != received_ + 1) {
    taken.error = "frame " + std::to_string(frame.sequence) + " follows " + std::to_string(received_);
  } else {
    received_ = frame.sequence;
    taken.error = TakePieces(frame, now, taken);
  }
  broken_ = taken.error.has_value();
  owes_report_ = owes_report_ || broken_;
  return taken;
}

Endpoint::Status Endpoint::status() const {
  Status status = status_;
  status.round_trip = window_.round_trip();
  status.window_bytes = window_.window();
  status.kept = kept_.size();
  status.kept_bytes = kept_bytes_;
  return status;
}

}  // namespace thalweg::link
