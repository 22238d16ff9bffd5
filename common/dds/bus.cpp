#include "common/dds/bus.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <fastdds/dds/core/condition/GuardCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/base/check.h"
#include "common/dds/bus_participant.h"
#include "common/dds/bytes_type.h"
#include "common/dds/endpoints.h"
#include "common/dds/inputs.h"
#include "common/dds/network_interfaces.h"
#include "common/dds/peers.h"
#include "common/dds/second_copy.h"
#include "common/dds/security.h"
#include "common/dds/timers.h"
#include "common/dds/watchdog.h"

namespace thalweg::dds {
namespace {

namespace fastdds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;
using SteadyTime = std::chrono::steady_clock::time_point;

std::runtime_error OwnOutput(const std::string& topic) {
  return std::runtime_error("DDS: topic \"" + topic +
                            "\" is published by this process itself, which cannot also take it as input");
}

eprosima::fastrtps::Duration_t ToDds(Duration duration) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(duration);
  return {static_cast<std::int32_t>(seconds.count()),
          static_cast<std::uint32_t>((duration - seconds).count())};
}

/// The most lines that are logged about readers of a topic that request more than is offered.
constexpr std::size_t kMostLogged = 20;

constexpr Duration kLogPeriod = std::chrono::milliseconds(200);
constexpr Duration kHealthPeriod = std::chrono::seconds(1);
constexpr Duration kAddressPeriod = std::chrono::seconds(1);

/// The longest time for which the bus waits for events: SoleWriter needs to know that a topic is silent.
constexpr Duration kLongestWait = std::chrono::milliseconds(250);
static_assert(kLongestWait < SoleWriter<WriterId>::kAttentive);

std::string WhereOf(const BusOptions& options) {
  std::string where = options.about.empty() ? "" : options.about + ", ";
  where += "DDS domain " + std::to_string(options.domain);
  if (!options.partition.empty()) where += ", partition " + options.partition;
  return options.security_dir.empty() ? where : where + ", secured by " + options.security_dir;
}

}  // namespace

struct Bus::State {
  State(const BusOptions& options, Health& its_health);
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  bool IsAdvertised(const std::string& topic) const;
  void CountRefusedDatagrams();
  /// Logs, once each, what readers request that a writer of this bus does not offer.
  void NameRefusedReaders();

  /// Reports to the watchdog what the spinning thread does.
  /// @param what  Outlives this object; null = it waits.
  void Doing(const char* what) const {
    if (watchdog) watchdog->Begin(what);
  }
  void StepUntil(SteadyTime deadline);
  void Wait(SteadyTime deadline);
  void RunTasks();
  std::string Introduction() const;

  const std::vector<std::string> partitions;
  const std::string where;  ///< For log lines.
  const ClockSource clock;
  Health& health;
  const std::shared_ptr<Guard> guard = std::make_shared<Guard>();
  Peers peers;
  fastdds::GuardCondition wake;  ///< Triggered by a task, a match or a stop request.
  fastdds::WaitSet wait_set;

  mutable std::mutex mutex;    ///< Guards what other threads access: outputs and tasks.
  std::deque<Output> outputs;  ///< A deque, since elements must not move.
  std::vector<std::function<void()>> tasks;

  // What Fast DDS calls, above, outlives the participant, and this its readers.
  BusParticipant participant;
  Inputs inputs;
  Timers timers;
  bool stepping = false;
  const Duration watchdog_limit;
  std::unique_ptr<Watchdog> watchdog;       ///< While it spins.
  std::optional<SteadyTime> at_work_since;  ///< When messages were handled first.
};

Bus::State::State(const BusOptions& options, Health& its_health)
    : partitions(options.partition.empty() ? 0U : 1U, options.partition),
      where(WhereOf(options)),
      clock(options.clock),
      health(its_health),
      peers(options.surveys),
      participant(options, guard, peers),
      inputs({participant, wait_set, wake, peers, health, [this](const char* what) { Doing(what); }}),
      timers(health, [this](const char* what) { Doing(what); }),
      watchdog_limit(options.watchdog) {
  wait_set.attach_condition(wake);
}

Bus::State::~State() {
  wait_set.detach_condition(wake);
}

bool Bus::State::IsAdvertised(const std::string& topic) const {
  return std::ranges::any_of(outputs, [&](const Output& output) { return output.topic == topic; });
}

void Bus::State::NameRefusedReaders() {
  const std::lock_guard lock(mutex);
  for (Output& output : outputs) {
    if (!output.matches->TakeRefusedReader()) continue;
    const Endpoint writer = EndpointOf(*output.writer, partitions);
    for (const Mismatch& mismatch : peers.MismatchesOf(writer)) {
      if (output.logged.size() < kMostLogged && output.logged.insert(mismatch.text).second)
        spdlog::warn("{}: {}; {}", participant.names().Topic(output.topic), mismatch.text, mismatch.advice);
    }
  }
}

void Bus::State::CountRefusedDatagrams() {
  for (const RefusedDatagrams::Entry& entry : guard->refused.Take()) {
    health.Reject("datagram", entry.reason, entry.count);
  }
}

void Bus::State::StepUntil(SteadyTime deadline) {
  THALWEG_CHECK(!stepping);  // handlers must not spin
  stepping = true;
  if (!at_work_since) at_work_since = std::chrono::steady_clock::now();
  const std::unique_ptr<bool, void (*)(bool*)> end_of_step(&stepping, [](bool* flag) { *flag = false; });
  Wait(deadline);
  RunTasks();
  timers.RunDue();
  // One message per reader and turn, so that a busy topic delays neither timers nor other topics.
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    if (inputs.TakeFrom(k)) timers.RunDue();
  }
}

void Bus::State::Wait(SteadyTime deadline) {
  Duration longest = std::min(deadline, timers.Next()) - std::chrono::steady_clock::now();
  if (inputs.any_ready()) longest = Duration::zero();
  fastdds::ConditionSeq active;
  Doing(nullptr);
  wait_set.wait(active, ToDds(std::clamp<Duration>(longest, Duration::zero(), kLongestWait)));
  Doing("matching readers and writers");
  wake.set_trigger_value(false);
  inputs.Look();
  NameRefusedReaders();
}

void Bus::State::RunTasks() {
  std::vector<std::function<void()>> due;
  {
    const std::lock_guard lock(mutex);
    due.swap(tasks);
  }
  for (const auto& task : due) {
    Doing("a task");
    task();
  }
}

std::string Bus::State::Introduction() const {
  const std::string topics_in = inputs.Introduction();
  return topics_in.empty() ? where : where + ", waits for " + topics_in;
}

Bus::Bus(const BusOptions& options)
    : names_(options.names),
      health_(std::make_unique<Health>(options.name)),
      state_(std::make_unique<State>(options, *health_)) {
  if (options.clock == ClockSource::kTopic) {
    Subscribe<topics::Clock>([this](const auto& message) { state_->timers.OnClock(message); });
  }
  // A tool on this machine alone would only report that there are others.
  if (options.publish_health || !options.local_only) {
    EveryWall(kHealthPeriod, [this] { state_->CountRefusedDatagrams(); });
  }
  if (options.publish_health) {
    const auto health_out = Advertise<topics::Health>();
    EveryWall(kHealthPeriod, [this, health_out] { health_out.Write(health_->ToMessage(Now())); });
  }
  if (!options.local_only) {
    EveryWall(kAddressPeriod, [watch = std::make_shared<AddressWatch>(InterfaceAddresses())] {
      std::string changes;
      try {
        changes = watch->Changes(InterfaceAddresses());
      } catch (const std::runtime_error&) {
        return;  // e.g. too many open files; the next second may be better
      }
      // Fast DDS 2.9 goes on with the addresses that there were at the start, also after set_qos, by which it
      // is meant to list them again.
      if (!changes.empty()) {
        spdlog::warn(
            "network addresses changed: {}; a process uses those that it found at its start: restart it",
            changes);
      }
    });
  }
  if (options.publish_health && options.log) {
    log_ = options.log;
    log_out_ = Advertise<topics::Log>();
    EveryWall(kLogPeriod, [this] { PublishLog(); });
  }
  if (state_->participant.keys()) {
    const auto warn = [this] {
      const auto expiry = FindExpiry(*state_->participant.keys(), std::chrono::system_clock::now());
      if (expiry) spdlog::warn("{}", *expiry);
    };
    warn();
    EveryWall(std::chrono::days(1), warn);
  }
  if (options.sole && options.publish_health) {
    Subscribe<topics::Health>([this, name = options.name](const auto& message) {
      if (message.service() != name) return;  // before its own message, with all timings, is made
      // Only participants that exist count: a message alone could keep any service from starting.
      const auto sender = eprosima::fastrtps::rtps::iHandle2GUID(state_->inputs.sender());
      if (!state_->peers.IsNamed(sender, name) || !state_->participant.MayBeCopy(sender.guidPrefix)) return;
      const Duration at_work = std::chrono::steady_clock::now() - *state_->at_work_since;
      if (const auto problem = FindSecondCopy(health_->ToMessage(Now()), message, at_work))
        throw std::runtime_error(*problem);
    });
  }
}

Bus::~Bus() = default;

void Bus::PublishLog() {
  if (!log_out_) return;
  for (const LogLine& line : log_->Take()) log_out_->Write(ToIdl(line, health_->service()));
}

int Bus::AdvertiseRaw(const std::string& topic, Delivery delivery, TopicDataType* type) {
  const BusParticipant::Topic its_topic = state_->participant.TopicOf(topic, type);
  if (state_->IsAdvertised(topic)) {
    throw std::runtime_error("DDS: topic \"" + topic + "\" is advertised twice");
  }
  if (state_->inputs.WantsOthersOnly(topic)) throw OwnOutput(topic);
  auto matches = std::make_unique<Matches>(topic, state_->wake, state_->participant.ignored());
  auto* const writer = state_->participant.NewWriter(topic, its_topic, delivery, *matches);
  const std::lock_guard lock(state_->mutex);
  state_->outputs.push_back({topic, writer, std::move(matches)});
  return static_cast<int>(state_->outputs.size()) - 1;
}

void Bus::SubscribeRaw(const TopicInfo& topic, TopicDataType* type, bool from_others, Keep keep,
                       RawHandler handler) {
  const BusParticipant::Topic its_topic = state_->participant.TopicOf(topic.name, type);
  if (from_others && state_->IsAdvertised(topic.name)) throw OwnOutput(topic.name);
  its_topic.type->AllowBytes(topic.most_bytes);
  if (topic.most_bytes > state_->guard->largest_sample) state_->guard->largest_sample = topic.most_bytes;
  state_->inputs.Add(topic, its_topic, from_others, keep, std::move(handler));
}

Bus::BytesPublisher Bus::AdvertiseBytes(const TopicInfo& topic) {
  return {this, AdvertiseRaw(topic.name, topic.delivery, new BytesType(topic.type_name))};
}

bool Bus::BytesPublisher::Write(std::span<const std::uint8_t> bytes) const {
  const BytesType::Sample sample(bytes.begin(), bytes.end());
  return bus_->WriteRaw(writer_, &sample);
}

void Bus::SubscribeBytes(const TopicInfo& topic, std::function<void(const RawSample&)> handler, Keep keep) {
  TopicInfo of_all_writers = topic;
  of_all_writers.writers = dds::Writers::kMany;
  const RawHandler raw = [handler = std::move(handler)](const void* sample, const Arrival& arrival) {
    handler({*static_cast<const BytesType::Sample*>(sample), arrival.source_stamp, arrival.reception_stamp,
             arrival.missed});
  };
  if (state_->inputs.OpenAgain(topic.name, keep, raw)) return;
  SubscribeRaw(of_all_writers, new BytesType(topic.type_name), false, keep, raw);
}

void Bus::UnsubscribeBytes(const std::string& topic) {
  state_->inputs.Close(topic);
}

int Bus::WritersOfRaw(const char* topic) const {
  return state_->inputs.WritersOf(topic);
}

bool Bus::WriteRaw(int writer, const void* message) const {
  std::unique_lock lock(state_->mutex);
  const Output& output = state_->outputs[static_cast<std::size_t>(writer)];
  lock.unlock();
  return output.writer->write(const_cast<void*>(message));
}

int Bus::MatchedReaders(int writer) const {
  const std::lock_guard lock(state_->mutex);
  return state_->outputs[static_cast<std::size_t>(writer)].matches->count();
}

bool Bus::AwaitDelivery(int writer, Duration patience) const {
  std::unique_lock lock(state_->mutex);
  const Output& output = state_->outputs[static_cast<std::size_t>(writer)];
  lock.unlock();
  return output.writer->wait_for_acknowledgments(ToDds(patience)) == ReturnCode_t::RETCODE_OK;
}

BusGraph Bus::Graph() const {
  return state_->peers.Graph();
}

void Bus::Every(Duration period, std::function<void()> handler) {
  if (state_->clock == ClockSource::kSystem) return EveryWall(period, std::move(handler));
  state_->timers.AddTopic(period, std::move(handler));
}

void Bus::EveryWall(Duration period, std::function<void()> handler) {
  state_->timers.AddWall(period, std::move(handler));
}

void Bus::Post(std::function<void()> task) {
  {
    const std::lock_guard lock(state_->mutex);
    state_->tasks.push_back(std::move(task));
  }
  state_->wake.set_trigger_value(true);
}

Time Bus::Now() const {
  if (state_->clock == ClockSource::kTopic) return state_->timers.topic_now();
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

void Bus::Spin(std::stop_token stop) {
  spdlog::info("{}", state_->Introduction());
  const std::stop_callback wake_up(stop, [this] { state_->wake.set_trigger_value(true); });
  if (state_->watchdog_limit > Duration::zero()) {
    state_->watchdog = std::make_unique<Watchdog>(
        state_->watchdog_limit, [limit = state_->watchdog_limit](const std::string& what) {
          spdlog::critical(
              "hangs: no progress for {:.1f} s, in the handling of {}; aborting so that it can be restarted",
              Seconds(limit), what);
          spdlog::default_logger()->flush();
          std::abort();
        });
  }
  const std::unique_ptr<State, void (*)(State*)> end_of_spin(state_.get(),
                                                             [](State* state) { state->watchdog.reset(); });
  while (!stop.stop_requested()) state_->StepUntil(SteadyTime::max());
  PublishLog();
}

bool Bus::SpinUntil(const std::function<bool()>& done, Duration timeout) {
  const SteadyTime deadline = std::chrono::steady_clock::now() + timeout;
  while (!done()) {
    if (std::chrono::steady_clock::now() >= deadline) return false;
    state_->StepUntil(deadline);
  }
  return true;
}

}  // namespace thalweg::dds
