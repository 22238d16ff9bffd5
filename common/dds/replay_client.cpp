#include "common/dds/replay_client.h"

#include <cmath>
#include <utility>

#include "common/base/text.h"
#include "common/dds/command_ledger.h"
#include "common/dds/convert.h"

namespace thalweg::dds {
namespace {

using thalweg_msgs::msg::ReplayCommand;
using thalweg_msgs::msg::ReplayStatus;

constexpr auto kReplayTick = std::chrono::milliseconds(50);
constexpr auto kSilent = std::chrono::milliseconds(3500);
/// A refusal that reads like the one before may be that one for so long.
constexpr auto kStale = std::chrono::milliseconds(300);

Time TimeOf(const builtin_interfaces::msg::Time& time) {
  return FromIdl(time) ? *FromIdl(time) : Time();
}

std::string MinutesText(Duration time) {
  const auto seconds = static_cast<long>(std::floor(Seconds(time)));
  const std::string rest = std::to_string(seconds % 60);
  return std::to_string(seconds / 60) + (rest.size() == 1 ? ":0" : ":") + rest;
}

}  // namespace

std::string Described(const ReplayStatus& status) {
  const Time begin = TimeOf(status.begin());
  return std::string(status.paused() ? "paused at " : "playing at ") +
         MinutesText(TimeOf(status.now()) - begin) + " of " + MinutesText(TimeOf(status.end()) - begin) +
         (status.rate() == 1.0 ? "" : ", rate " + NumberText(status.rate()));
}

ReplayClient::ReplayClient(Bus& bus, bool may_steer, StatusHandler on_status)
    : bus_(bus), on_status_(std::move(on_status)) {
  if (may_steer) commands_out_ = bus.Advertise<topics::ReplayCommands>();
  bus.Subscribe<topics::ReplayStatus>([this](const auto& status) { OnStatus(status); });
  bus.EveryWall(kReplayTick, [this] { Tick(); });
}

const ReplayStatus* ReplayClient::status() const {
  return status_ && Clock::now() - heard_ < kSilent ? &*status_ : nullptr;
}

Time ReplayClient::TimeAt(Duration since_beginning) const {
  return TimeOf(status_->begin()) + since_beginning;
}

void ReplayClient::Send(ReplayCommand command, Duration patience, AnswerHandler handler) {
  if (status() == nullptr || commands_out_->readers() == 0) return handler(Error{kNothing});
  command.sender(SenderName(command.sender()));
  command.header(MakeHeader(bus_.Now(), kMapFrame));
  commands_out_->Write(command);
  const auto now = Clock::now();
  pending_.push_back({std::move(command), now, now + std::chrono::duration_cast<Clock::duration>(patience),
                      status_->last_refusal(), std::move(handler)});
}

ReplayClient::Answer ReplayClient::SendAndWait(const std::function<ReplayCommand()>& make,
                                               Duration patience) {
  // Discovery comes first
  if (!bus_.SpinUntil([&] { return status() != nullptr && commands_out_->readers() > 0; }, patience))
    return Error{kNothing};
  std::optional<Answer> answer;
  Send(make(), patience, [&](const Answer& its) { answer = its; });
  while (!answer) bus_.SpinUntil([&] { return answer.has_value(); }, patience);
  return *answer;
}

void ReplayClient::OnStatus(const ReplayStatus& status) {
  status_ = status;
  heard_ = Clock::now();
  Tick();
  if (on_status_) on_status_(status);
}

bool ReplayClient::IsObeyed(const Pending& pending) const {
  switch (pending.command.kind()) {
    case thalweg_msgs::msg::REPLAY_PAUSE:
      return status_->paused();
    case thalweg_msgs::msg::REPLAY_RESUME:
      return !status_->paused();
    case thalweg_msgs::msg::REPLAY_RATE:
      return status_->rate() == pending.command.rate();
    case thalweg_msgs::msg::REPLAY_SEEK: {
      const double passed = Seconds(TimeOf(status_->now()) - TimeOf(pending.command.time()));
      return passed >= 0.0 && passed <= status_->rate() * (Seconds(Clock::now() - pending.sent) + 0.1);
    }
  }
  return false;
}

std::optional<ReplayClient::Answer> ReplayClient::AnswerTo(const Pending& pending) const {
  if (heard_ <= pending.sent) return std::nullopt;
  const std::string& refusal = status_->last_refusal();
  if (refusal.empty()) {
    if (!IsObeyed(pending)) return std::nullopt;
    return Answer(Described(*status_));
  }
  if (refusal == pending.refusal_before && Clock::now() < pending.sent + kStale) return std::nullopt;
  return Answer(Error{CleanText(refusal)});
}

void ReplayClient::Tick() {
  std::vector<std::pair<AnswerHandler, Answer>> answers;
  const auto now = Clock::now();
  std::erase_if(pending_, [&](Pending& pending) {
    std::optional<Answer> answer = AnswerTo(pending);
    if (!answer && now >= pending.deadline) answer = Answer(Error{"no answer from the replay"});
    if (!answer) return false;
    answers.emplace_back(std::move(pending.handler), *std::move(answer));
    return true;
  });
  // Last, since a handler may send the next command
  for (const auto& [handler, answer] : answers) handler(answer);
}

}  // namespace thalweg::dds
