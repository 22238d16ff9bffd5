#include "common/dds/bus.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <fastdds/dds/core/condition/GuardCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <future>
#include <mutex>
#include <optional>
#include <shared_mutex>
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
#include "common/dds/qos.h"
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
/// Addresses that come are used when they stay the same for so long: they often come one after another.
constexpr Duration kAddressPeriod = std::chrono::milliseconds(250);
/// The longest time for which a wait for delivery keeps the participant from being replaced.
constexpr Duration kDeliverySlice = std::chrono::milliseconds(50);

/// The longest time for which the bus waits for events: SoleWriter needs to know that a topic is silent.
constexpr Duration kLongestWait = std::chrono::milliseconds(250);
static_assert(kLongestWait < SoleWriter<WriterId>::kAttentive);

/// The machine's addresses, or this one alone.
std::vector<InterfaceAddress> AddressesIn(const std::string& only) {
  std::vector<InterfaceAddress> addresses = InterfaceAddresses();
  if (!only.empty()) std::erase_if(addresses, [&](const auto& entry) { return entry.address != only; });
  return addresses;
}

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

  Output& OutputOf(int writer);
  /// Gives an output a writer of the present participant.
  void OpenWriter(Output& output);
  /// Notices other addresses of the machine, and has the participant replaced if it cannot use them.
  void FollowAddresses(const std::vector<InterfaceAddress>& now);
  /// Replaces the participant by one that uses the machine's present addresses. Readers and writers are those
  /// of before to this process; to others they are new ones, that offer late joiners the samples of the old.
  void JoinAgain(const BusParticipant::Qos& qos);

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
  std::shared_mutex replacing;  ///< Shared by those who use a writer. Locked before `mutex`.

  std::optional<AddressWatch> addresses;  ///< Nothing if no network is shared.
  // What Fast DDS calls, above, outlives the participant, and this its readers.
  BusParticipant participant;
  std::future<BusParticipant::Qos> successor;  ///< Valid after the addresses have changed.
  bool successor_fails = false;
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
      addresses(options.local_only ? std::nullopt
                                   : std::optional<AddressWatch>(AddressesIn(options.network_interface))),
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

Output& Bus::State::OutputOf(int writer) {
  const std::lock_guard lock(mutex);
  return outputs[static_cast<std::size_t>(writer)];
}

void Bus::State::OpenWriter(Output& output) {
  auto matches = std::make_unique<Matches>(output.topic, wake, participant.ignored());
  output.writer =
      participant.NewWriter(output.topic, participant.KnownTopic(output.topic), output.delivery, *matches);
  output.matches = std::move(matches);
}

void Bus::State::FollowAddresses(const std::vector<InterfaceAddress>& now) {
  const std::string changes = addresses->Changes(now);
  if (!changes.empty()) {
    spdlog::warn("network addresses changed: {}", changes);
    return;
  }
  if (!successor.valid()) {
    if (!addresses->has_unknown()) return;
    // Fast DDS names a machine by the addresses of when a process made its first participant. Without any,
    // the name is that of all such machines, which then take each other's shared memory for their own.
    const bool udp_alone = !addresses->began_in_a_network();
    // Names of peers may take long to be resolved, and the thread must not stand still.
    successor = std::async(std::launch::async, [=, this] { return participant.Successor(udp_alone); });
    return;
  }
  if (successor.wait_for(Duration::zero()) != std::future_status::ready) return;
  std::optional<BusParticipant::Qos> qos;
  try {
    qos = successor.get();
  } catch (const std::runtime_error& error) {  // e.g. a name that cannot be resolved yet
    if (!std::exchange(successor_fails, true)) spdlog::warn("cannot use them yet: {}", error.what());
    return;
  }
  successor_fails = false;
  addresses->Renew();
  JoinAgain(*qos);
}

void Bus::State::JoinAgain(const BusParticipant::Qos& qos) {
  inputs.TakeAll();
  Doing("a change of the network's addresses");
  const std::unique_lock nobody_writes(replacing);
  inputs.Suspend();
  for (Output& output : outputs) output.writer = nullptr;
  participant.Replace(qos);
  {
    const std::lock_guard lock(mutex);
    for (Output& output : outputs) OpenWriter(output);
  }
  inputs.Resume();
  for (const Output& output : outputs) {
    if (output.late_samples) output.late_samples->WriteAgain(*output.writer);
  }
  spdlog::info("joined the network again, since Fast DDS uses only the addresses of when it joins");
}

void Bus::State::CountRefusedDatagrams() {
  for (const RefusedDatagrams::Entry& entry : guard->refused.Take()) {
    health.Reject(Health::kDatagrams, entry.reason, entry.count);
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
    EveryWall(kAddressPeriod, [this, only = options.network_interface] {
      std::vector<InterfaceAddress> now;
      try {
        now = AddressesIn(only);
      } catch (const std::runtime_error&) {
        return;  // e.g. too many open files; the next look may be better
      }
      state_->FollowAddresses(now);
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

int Bus::AdvertiseRaw(const std::string& topic, Delivery delivery, TypeSupport type) {
  const BusParticipant::Topic its_topic = state_->participant.TopicOf(topic, std::move(type));
  if (state_->IsAdvertised(topic)) {
    throw std::runtime_error("DDS: topic \"" + topic + "\" is advertised twice");
  }
  if (state_->inputs.WantsOthersOnly(topic)) throw OwnOutput(topic);
  const std::size_t kept = state_->addresses ? KeptForLateJoiners(delivery) : 0;
  Output output{
      .topic = topic, .delivery = delivery, .writer = nullptr, .matches = nullptr, .late_samples = nullptr};
  if (kept > 0) output.late_samples = std::make_unique<LateSamples>(*its_topic.type, kept);
  state_->OpenWriter(output);
  const std::lock_guard lock(state_->mutex);
  state_->outputs.push_back(std::move(output));
  return static_cast<int>(state_->outputs.size()) - 1;
}

void Bus::SubscribeRaw(const TopicInfo& topic, TypeSupport type, bool from_others, Keep keep,
                       RawHandler handler) {
  const BusParticipant::Topic its_topic = state_->participant.TopicOf(topic.name, std::move(type));
  if (from_others && state_->IsAdvertised(topic.name)) throw OwnOutput(topic.name);
  its_topic.type->AllowBytes(topic.most_bytes);
  if (topic.most_bytes > state_->guard->largest_sample) state_->guard->largest_sample = topic.most_bytes;
  state_->inputs.Add(topic, its_topic, from_others, keep, std::move(handler));
}

Bus::BytesPublisher Bus::AdvertiseBytes(const TopicInfo& topic) {
  return {this, AdvertiseRaw(topic.name, topic.delivery, TypeSupport(new BytesType(topic.type_name)))};
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
  SubscribeRaw(of_all_writers, TypeSupport(new BytesType(topic.type_name)), false, keep, raw);
}

void Bus::UnsubscribeBytes(const std::string& topic) {
  state_->inputs.Close(topic);
}

int Bus::WritersOfRaw(const char* topic) const {
  return state_->inputs.WritersOf(topic);
}

bool Bus::WriteRaw(int writer, const void* message) const {
  const std::shared_lock in_use(state_->replacing);
  const Output& output = state_->OutputOf(writer);
  if (output.writer == nullptr) return false;
  if (output.late_samples) return output.late_samples->Write(*output.writer, message);
  return output.writer->write(const_cast<void*>(message));
}

int Bus::MatchedReaders(int writer) const {
  const std::lock_guard lock(state_->mutex);
  return state_->outputs[static_cast<std::size_t>(writer)].matches->count();
}

bool Bus::AwaitDelivery(int writer, Duration patience) const {
  const SteadyTime deadline = std::chrono::steady_clock::now() + patience;
  while (true) {
    const std::shared_lock in_use(state_->replacing);
    const Output& output = state_->OutputOf(writer);
    const Duration left = deadline - std::chrono::steady_clock::now();
    const Duration slice = std::clamp<Duration>(left, Duration::zero(), kDeliverySlice);
    if (output.writer == nullptr) return false;
    if (output.writer->wait_for_acknowledgments(ToDds(slice)) == ReturnCode_t::RETCODE_OK) return true;
    if (left <= kDeliverySlice) return false;
  }
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
  if (state_->clock != ClockSource::kSystem) return state_->timers.topic_now();
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

void Bus::SetNow(Time now) {
  THALWEG_CHECK(state_->clock == ClockSource::kOwn);
  state_->timers.SetTopicNow(now);
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
