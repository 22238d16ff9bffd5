#include "common/dds/inputs.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <utility>

#include "common/dds/qos.h"

namespace thalweg::dds {
namespace {

namespace fastdds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

Time FromDds(const eprosima::fastrtps::rtps::Time_t& time) {
  return Time{Duration(time.to_ns())};
}

/// The most samples that are taken from a reader at a time, so that a flood on one topic does not keep the
/// bus from others.
constexpr int kMostAtOnce = 64;

/// How long a topic's writer may be silent before another may take its place.
Duration SilenceOf(Delivery delivery) {
  return delivery == Delivery::kCommand ? std::chrono::milliseconds(500) : std::chrono::seconds(1);
}

}  // namespace

Inputs::~Inputs() {
  for (Input& input : inputs_) {
    if (input.reader != nullptr) Close(input);
  }
}

void Inputs::Add(const TopicInfo& topic, const BusParticipant::Topic& its_topic, bool from_others, Keep keep,
                 Handler handler) {
  const bool is_command = topic.delivery == Delivery::kCommand;
  Input& input =
      inputs_.emplace_back(Input{.topic = topic,
                                 .handler = std::move(handler),
                                 .type = its_topic.type,
                                 .sample = Sample(*its_topic.type),
                                 .newest = Sample(*its_topic.type),
                                 .matches = nullptr,
                                 .from_others = from_others,
                                 .sole_writer = SoleWriter<WriterId>(SilenceOf(topic.delivery), is_command),
                                 .gaps = {},
                                 .keep = keep});
  Open(input);
}

bool Inputs::OpenAgain(const std::string& topic, Keep keep, Handler handler) {
  for (Input& input : inputs_) {
    if (input.topic.name != topic || input.reader != nullptr) continue;
    input.handler = std::move(handler);
    input.keep = keep;
    input.gaps = {};
    Open(input);
    return true;
  }
  return false;
}

void Inputs::Close(const std::string& topic) {
  for (Input& input : inputs_) {
    if (input.topic.name == topic && input.reader != nullptr) Close(input);
  }
}

void Inputs::TakeAll() {
  for (std::size_t k = 0; k < inputs_.size(); ++k) {
    for (int taken = 0; taken < kMostAtOnce && inputs_[k].reader != nullptr && Take(inputs_[k]); ++taken) {
    }
  }
}

void Inputs::Suspend() {
  for (Input& input : inputs_) {
    if (input.reader == nullptr) continue;
    Close(input);
    input.suspended = true;
  }
}

void Inputs::Resume() {
  for (Input& input : inputs_) {
    if (!input.suspended) continue;
    input.ignores_one = false;
    Open(input);
    input.suspended = false;
  }
}

void Inputs::Look() {
  for (std::size_t k = 0; k < inputs_.size(); ++k) {
    Input& input = inputs_[k];
    if (input.reader == nullptr) continue;
    AdaptReliability(input);
    input.ready = input.ready || input.reader->get_statuscondition().get_trigger_value();
    if (!input.ready) input.sole_writer.SawNothing(std::chrono::steady_clock::now());
  }
}

bool Inputs::any_ready() const {
  return std::ranges::any_of(inputs_, &Input::ready);
}

bool Inputs::TakeFrom(std::size_t k) {
  return inputs_[k].ready && Take(inputs_[k]);
}

int Inputs::WritersOf(const std::string& topic) const {
  const auto found =
      std::ranges::find_if(inputs_, [&](const Input& input) { return input.topic.name == topic; });
  return found == inputs_.end() ? 0 : found->matches->count();
}

bool Inputs::WantsOthersOnly(const std::string& topic) const {
  return std::ranges::any_of(
      inputs_, [&](const Input& input) { return input.from_others && input.topic.name == topic; });
}

std::string Inputs::Introduction() const {
  std::string topics;
  for (const Input& input : inputs_) {
    topics += (topics.empty() ? "" : ", ") + its_.participant.names().Topic(input.topic.name);
  }
  return topics;
}

void Inputs::Open(Input& input) {
  input.matches = std::make_unique<Matches>(input.topic.name, its_.wake, its_.participant.ignored());
  input.reader = its_.participant.NewReader(input.topic, its_.participant.KnownTopic(input.topic.name),
                                            input.best_effort, input.keep, *input.matches);
  its_.wait_set.attach_condition(input.reader->get_statuscondition());
  input.ready = false;
}

void Inputs::Close(Input& input) {
  its_.wait_set.detach_condition(input.reader->get_statuscondition());
  its_.participant.Delete(input.reader);
  input.reader = nullptr;
  input.ready = false;
}

void Inputs::AdaptReliability(Input& input) {
  const bool records = input.keep == Keep::kForRecording;  // writers of any reliability, beside each other
  if (input.best_effort) {
    const auto is_reliable = [&](const WriterId& writer) {
      return its_.peers.IsReliable(eprosima::fastrtps::rtps::iHandle2GUID(writer));
    };
    if (records || (!input.matches->TakeLastGone() && !input.matches->Any(is_reliable))) return;
    spdlog::info("{}: read reliably again", input.topic.name);
    return Reopen(input, false);
  }
  const bool is_offered = input.matches->TakeBestEffortOffered();
  if (!is_offered && !(input.matches->TakeLastGone() && input.ignores_one)) return;
  const bool is_stream = input.topic.delivery == Delivery::kStream;
  if (!records && (!is_stream || input.matches->count() > 0)) {
    input.ignores_one = true;
    spdlog::warn("{}: a writer offers no reliable delivery and is ignored", input.topic.name);
    return;
  }
  spdlog::info("{}: read as best effort, which is all that a writer offers", input.topic.name);
  while (records && Take(input)) {  // what the reader still holds
  }
  Reopen(input, true);
}

void Inputs::Reopen(Input& input, bool best_effort) {
  Close(input);
  input.best_effort = best_effort;
  input.ignores_one = false;
  Open(input);
}

bool Inputs::IsUsable(Input& input, const fastdds::SampleInfo& info) {
  const auto& ignored = its_.participant.ignored();
  if (!info.valid_data || (ignored && IsOf(info.publication_handle, *ignored))) return false;
  const char* const topic = input.topic.name.c_str();
  if (const auto& problem = input.type->last_problem()) {
    its_.health.Reject(topic, *problem);
    return false;
  }
  if (!IsFromItsWriter(input, info.publication_handle)) return false;
  if (input.type->decodes()) NoteClockOffset(input, info);
  const Time now = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
  const Duration waited = now - FromDds(info.reception_timestamp);
  if (input.type->decodes() && waited > LongestWaitOf(input.topic.delivery)) {
    its_.health.Drop(topic, fmt::format("waited for {:.1f} s until this process was free", Seconds(waited)));
    return false;
  }
  return true;
}

bool Inputs::IsFromItsWriter(Input& input, const WriterId& writer) {
  if (input.topic.writers == dds::Writers::kMany) return true;
  using Verdict = SoleWriter<WriterId>::Verdict;
  const Verdict verdict =
      input.sole_writer.Judge(writer, [&](const WriterId& other) { return input.matches->Holds(other); });
  if (verdict == Verdict::kFollow) return true;
  const char* const topic = input.topic.name.c_str();
  const std::string rival = NameOf(input.sole_writer.rival());
  if (verdict == Verdict::kRefuse) {
    its_.health.Reject(topic,
                       fmt::format("from {}, while {} publishes it: only one may", NameOf(writer), rival));
  } else {
    its_.health.Reject(topic,
                       fmt::format("both {} and {} publish it, and neither was there before the other: "
                                   "none is followed until one of them ends",
                                   NameOf(writer), rival));
  }
  return false;
}

void Inputs::NoteClockOffset(Input& input, const fastdds::SampleInfo& info) {
  if (input.topic.writers == dds::Writers::kMany) return;
  const Duration age = FromDds(info.reception_timestamp) - FromDds(info.source_timestamp);
  const auto offset = input.clock_offset.Add(age, std::chrono::steady_clock::now());
  if (!offset) return;
  const double milliseconds = std::abs(1e3 * Seconds(*offset));
  const char* const side = *offset > Duration::zero() ? "ahead of" : "behind";
  its_.health.Timed(fmt::format("clock {} that of {}", side, input.topic.name), milliseconds);
  spdlog::warn("{}: this machine's clock is {:.0f} ms {} that of {}", input.topic.name, milliseconds, side,
               NameOf(info.publication_handle));
}

bool Inputs::Take(Input& input) {
  bool has_newest = false;
  fastdds::SampleInfo newest;
  int taken = 0;
  while (taken < kMostAtOnce) {
    fastdds::SampleInfo info;
    if (input.reader->take_next_sample(input.sample.data.get(), &info) != ReturnCode_t::RETCODE_OK) {
      input.ready = false;
      input.sole_writer.SawNothing(std::chrono::steady_clock::now());
      break;
    }
    ++taken;
    input.sample.bytes = input.type->last_bytes();
    const bool is_usable = IsUsable(input, info);
    if (input.type->last_problem()) input.sample.Renew();  // it may hold much of what could be decoded
    if (is_usable) {
      has_newest = true;
      newest = info;
      std::swap(input.sample, input.newest);
    }
    if (!input.newest_only()) break;
  }
  if (has_newest) Handle(input, newest);
  return taken > 0;
}

void Inputs::Handle(Input& input, const fastdds::SampleInfo& info) {
  its_.doing(input.topic.name.c_str());
  sender_ = info.publication_handle;
  const Arrival arrival{
      FromDds(info.source_timestamp), FromDds(info.reception_timestamp),
      input.gaps.Missed(info.publication_handle, info.sample_identity.sequence_number().to64long())};
  input.handler(input.newest.data.get(), arrival);
  input.newest.Settle();
}

std::string Inputs::NameOf(const WriterId& writer) const {
  return its_.peers.Name(eprosima::fastrtps::rtps::iHandle2GUID(writer));
}

}  // namespace thalweg::dds
