#include "common/dds/bus.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <fastdds/dds/core/condition/GuardCondition.hpp>
#include <fastdds/dds/core/condition/StatusCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/base/check.h"
#include "common/dds/bytes_type.h"
#include "common/dds/convert.h"
#include "common/dds/endpoints.h"
#include "common/dds/peers.h"
#include "common/dds/qos.h"
#include "common/dds/second_copy.h"
#include "common/dds/security.h"
#include "common/dds/shared_memory_files.h"
#include "common/dds/watchdog.h"

// Options for the sanitizers, set here so that every program that links the bus has them. They concern Fast
// DDS 2.9 itself, which deletes readers through a base class of another size, and takes its own locks in
// varying order and by calls that ThreadSanitizer does not know.
#ifdef __SANITIZE_ADDRESS__
extern "C" const char* __asan_default_options() {
  return "new_delete_type_mismatch=0";
}
#endif
#ifdef __SANITIZE_THREAD__
extern "C" const char* __tsan_default_suppressions() {
  return "mutex:libfastrtps\ndeadlock:libfastrtps\nrace:libfastrtps\n"
         // Its static variable is created in a library that is not instrumented
         "race:spdlog::details::registry\n"
         "deadlock:libgdal\n";  // used by OpenCV to read image files
}
#endif

namespace thalweg::dds {
namespace {

namespace fastdds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;
using SteadyTime = std::chrono::steady_clock::time_point;

std::runtime_error OwnOutput(const std::string& topic) {
  return std::runtime_error("DDS: topic \"" + topic +
                            "\" is published by this process itself, which cannot also take it as input");
}

std::runtime_error Failed(const std::string& what, const std::string& name) {
  return std::runtime_error("DDS: cannot create " + what + " \"" + name + "\"");
}

eprosima::fastrtps::Duration_t ToDds(Duration duration) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(duration);
  return {static_cast<std::int32_t>(seconds.count()),
          static_cast<std::uint32_t>((duration - seconds).count())};
}

/// Fires once per period of a clock; missed periods are skipped.
template <class Moment>
struct Timer {
  Duration period;
  std::function<void()> handler;
  Moment due;

  /// Whether the timer is due; if so, schedules it for its next beat after `now`.
  bool Take(Moment now) {
    if (now < due) return false;
    due += ((now - due) / period + 1) * period;
    return true;
  }
};

Time FromDds(const eprosima::fastrtps::rtps::Time_t& time) {
  return Time{Duration(time.to_ns())};
}

/// The most samples that are taken from a reader at a time, so that a flood on one topic does not keep the
/// bus from others.
constexpr int kMostAtOnce = 64;

/// The longest time for which the bus waits for events: SoleWriter needs to know that a topic is silent.
constexpr Duration kLongestWait = std::chrono::milliseconds(250);
static_assert(kLongestWait < SoleWriter<WriterId>::kAttentive);

/// How long a topic's writer may be silent before another may take its place.
Duration SilenceOf(Delivery delivery) {
  return delivery == Delivery::kCommand ? std::chrono::milliseconds(500) : std::chrono::seconds(1);
}

std::string WhereOf(const BusOptions& options) {
  std::string where = options.about.empty() ? "" : options.about + ", ";
  where += "DDS domain " + std::to_string(options.domain);
  if (!options.partition.empty()) where += ", partition " + options.partition;
  return options.security_dir.empty() ? where : where + ", secured by " + options.security_dir;
}

/// Guards the creation of participants: Fast DDS may assign the same ID to two that are created at the same
/// time, and then rejects the second.
std::mutex creation;

}  // namespace

struct Bus::State {
  State(const BusOptions& options, Health& its_health);
  /// An entity that Fast DDS did not create, because the role does not allow it or for another reason.
  std::runtime_error Refused(const char* verb, const std::string& entity, const std::string& topic) const;
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  struct Topic {
    CheckedType* type;
    fastdds::Topic* topic;
  };
  /// Throws if the topic already exists with another type, since its samples would be cast to the wrong one.
  Topic TopicOf(const std::string& name, TopicDataType* type);
  bool IsAdvertised(const std::string& topic) const;

  void OpenReader(Input& input);
  void CloseReader(Input& input);
  /// Reads a writer that offers no reliable delivery, while no other is there.
  void AdaptReliability(Input& input);
  void Reopen(Input& input, bool best_effort);
  /// Whether the sample that was taken is to be handled. Counts it if it is not.
  bool IsUsable(Input& input, const fastdds::SampleInfo& info);
  bool IsFromItsWriter(Input& input, const WriterId& writer);
  void NoteClockOffset(Input& input, const fastdds::SampleInfo& info);
  std::string NameOf(const WriterId& writer) const {
    return peers.Name(eprosima::fastrtps::rtps::iHandle2GUID(writer));
  }
  void CountRefusedDatagrams();

  /// Tells the watchdog what the spinning thread does. @param what  Outlives this object; null = it waits.
  void Doing(const char* what) const {
    if (watchdog) watchdog->Begin(what);
  }
  void OnClock(const rosgraph_msgs::msg::Clock& message);
  void StepUntil(SteadyTime deadline);
  void Wait(SteadyTime deadline);
  bool Take(Input& input);
  void Handle(Input& input, const fastdds::SampleInfo& info);
  void RunTasks();
  void RunTimers();
  SteadyTime NextTimer() const;
  std::string Introduction() const;

  const std::string where;  ///< For log lines.
  const ClockSource clock;
  Health& health;
  const std::shared_ptr<Guard> guard = std::make_shared<Guard>();
  std::optional<SecurityKeys> keys;
  Peers peers;
  /// This participant, if it is deaf to itself.
  std::optional<eprosima::fastrtps::rtps::GuidPrefix_t> ignored;
  fastdds::DomainParticipant* participant = nullptr;
  fastdds::Publisher* publisher = nullptr;
  fastdds::Subscriber* subscriber = nullptr;
  std::map<std::string, fastdds::TypeSupport> types;  ///< By name of the type.
  std::map<std::string, Topic> topics;

  fastdds::GuardCondition wake;  ///< Triggered by a task, a match or a stop request.
  fastdds::WaitSet wait_set;

  mutable std::mutex mutex;    ///< Guards what other threads access: outputs and tasks.
  std::deque<Output> outputs;  ///< A deque, since elements must not move.
  std::vector<std::function<void()>> tasks;

  std::deque<Input> inputs;  ///< Deques: handlers may append to all three while they are iterated.
  std::deque<Timer<SteadyTime>> wall_timers;
  std::deque<Timer<Time>> topic_timers;
  std::atomic<Duration::rep> topic_now = 0;
  bool topic_clock_runs = false;
  SteadyTime last_restart;  ///< When the topic's clock last jumped back.
  bool stepping = false;
  const Duration watchdog_limit;
  std::unique_ptr<Watchdog> watchdog;       ///< While it spins.
  std::optional<SteadyTime> at_work_since;  ///< When messages were handled first.
  WriterId sender;                          ///< Of the message that is being handled.
};

Bus::State::State(const BusOptions& options, Health& its_health)
    : where(WhereOf(options)),
      clock(options.clock),
      health(its_health),
      peers(options.surveys),
      watchdog_limit(options.watchdog) {
  if (options.domain < 0 || options.domain > 232) {
    throw std::runtime_error("DDS: domain must be 0 to 232, is " + std::to_string(options.domain));
  }
  const std::string its_name = options.name + "\" in domain \"" + std::to_string(options.domain);
  if (!options.security_dir.empty()) {
    keys = CheckKeys(options.security_dir, options.name, std::chrono::system_clock::now());
  }
  if (options.shared_memory) RemoveStaleFiles();
  auto* const factory = fastdds::DomainParticipantFactory::get_instance();
  {
    const std::scoped_lock lock(creation);
    participant = factory->create_participant(static_cast<std::uint32_t>(options.domain),
                                              ParticipantQosFrom(options, guard, keys), &peers,
                                              fastdds::StatusMask::none());
  }
  if (participant == nullptr) {
    const std::string with_keys = keys ? ", with the keys in " + keys->folder.string() : "";
    throw std::runtime_error(Failed("participant", its_name).what() + with_keys);
  }
  if (!options.hears_itself) ignored = participant->guid().guidPrefix;
  fastdds::PublisherQos publisher_qos;
  fastdds::SubscriberQos subscriber_qos;
  if (!options.partition.empty()) {
    publisher_qos.partition().push_back(options.partition.c_str());
    subscriber_qos.partition().push_back(options.partition.c_str());
  }
  publisher = participant->create_publisher(publisher_qos);
  subscriber = participant->create_subscriber(subscriber_qos);
  if (publisher == nullptr || subscriber == nullptr) {
    factory->delete_participant(participant);
    throw Failed("publisher and subscriber of participant", its_name);
  }
  wait_set.attach_condition(wake);
}

Bus::State::~State() {
  for (const Input& input : inputs) {
    if (input.reader != nullptr) wait_set.detach_condition(input.reader->get_statuscondition());
  }
  wait_set.detach_condition(wake);
  participant->delete_contained_entities();
  fastdds::DomainParticipantFactory::get_instance()->delete_participant(participant);
}

std::runtime_error Bus::State::Refused(const char* verb, const std::string& entity,
                                       const std::string& topic) const {
  if (!keys) return Failed(entity, topic);
  return std::runtime_error(std::string(Failed(entity, topic).what()) + ": the permissions of role \"" +
                            keys->role + "\" in " + keys->folder.string() + " do not allow it to " + verb +
                            " the topic");
}

Bus::State::Topic Bus::State::TopicOf(const std::string& name, TopicDataType* generated) {
  auto type = std::make_unique<CheckedType>(std::unique_ptr<TopicDataType>(generated));
  const std::string type_name = type->getName();
  const auto check_use = [&](const CheckedType& known) {
    if (known.decodes() == type->decodes()) return;
    throw std::runtime_error("DDS: " + type_name + " of topic \"" + name +
                             "\" cannot be used both decoded and undecoded on one bus");
  };
  if (const auto found = topics.find(name); found != topics.end()) {
    check_use(*found->second.type);
    const std::string known_name = found->second.type->getName();
    if (known_name == type_name) return found->second;
    throw std::runtime_error("DDS: topic \"" + name + "\" carries " + known_name + ", it cannot carry " +
                             type_name + " as well");
  }
  auto known = types.find(type_name);
  if (known == types.end()) {
    fastdds::TypeSupport support(type.release());
    if (support.register_type(participant) != ReturnCode_t::RETCODE_OK) {
      throw Failed("type", type_name);
    }
    known = types.emplace(type_name, std::move(support)).first;
  } else {
    check_use(*static_cast<CheckedType*>(known->second.get()));
  }
  // The names that ROS 2 uses.
  auto* const topic = participant->create_topic("rt/" + name, type_name, fastdds::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) throw Failed("topic", name);
  return topics.emplace(name, Topic{static_cast<CheckedType*>(known->second.get()), topic}).first->second;
}

void Bus::State::OpenReader(Input& input) {
  const auto mask = fastdds::StatusMask::subscription_matched()
                    << fastdds::StatusMask::requested_incompatible_qos();
  input.matches = std::make_unique<Matches>(input.topic.name, wake, ignored);
  input.reader = subscriber->create_datareader(
      input.dds_topic, ReaderQosFrom(input.topic.delivery, input.best_effort, input.keep),
      input.matches.get(), mask);
  if (input.reader == nullptr) throw Refused("subscribe to", "reader", input.topic.name);
  input.reader->get_statuscondition().set_enabled_statuses(fastdds::StatusMask::data_available());
  wait_set.attach_condition(input.reader->get_statuscondition());
  input.ready = false;
}

void Bus::State::CloseReader(Input& input) {
  wait_set.detach_condition(input.reader->get_statuscondition());
  subscriber->delete_datareader(input.reader);
  input.reader = nullptr;
  input.ready = false;
}

void Bus::State::AdaptReliability(Input& input) {
  const bool records = input.keep == Keep::kForRecording;  // writers of any reliability, beside each other
  if (input.best_effort) {
    const auto is_reliable = [&](const WriterId& writer) {
      return peers.IsReliable(eprosima::fastrtps::rtps::iHandle2GUID(writer));
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

void Bus::State::Reopen(Input& input, bool best_effort) {
  CloseReader(input);
  input.best_effort = best_effort;
  input.ignores_one = false;
  OpenReader(input);
}

bool Bus::State::IsUsable(Input& input, const fastdds::SampleInfo& info) {
  if (!info.valid_data || (ignored && IsOf(info.publication_handle, *ignored))) return false;
  const char* const topic = input.topic.name.c_str();
  if (const auto& problem = input.type->last_problem()) {
    health.Reject(topic, *problem);
    return false;
  }
  if (!IsFromItsWriter(input, info.publication_handle)) return false;
  if (input.type->decodes()) NoteClockOffset(input, info);
  const Time now = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
  const Duration waited = now - FromDds(info.reception_timestamp);
  if (input.type->decodes() && waited > LongestWaitOf(input.topic.delivery)) {
    health.Drop(topic, fmt::format("waited for {:.1f} s until this process was free", Seconds(waited)));
    return false;
  }
  return true;
}

bool Bus::State::IsFromItsWriter(Input& input, const WriterId& writer) {
  if (input.topic.writers == dds::Writers::kMany) return true;
  using Verdict = SoleWriter<WriterId>::Verdict;
  const Verdict verdict =
      input.sole_writer.Judge(writer, [&](const WriterId& other) { return input.matches->Holds(other); });
  if (verdict == Verdict::kFollow) return true;
  const char* const topic = input.topic.name.c_str();
  const std::string rival = NameOf(input.sole_writer.rival());
  if (verdict == Verdict::kRefuse) {
    health.Reject(topic, fmt::format("from {}, while {} publishes it: only one may", NameOf(writer), rival));
  } else {
    health.Reject(topic, fmt::format("both {} and {} publish it, and neither was there before the other: "
                                     "none is followed until one of them ends",
                                     NameOf(writer), rival));
  }
  return false;
}

void Bus::State::NoteClockOffset(Input& input, const fastdds::SampleInfo& info) {
  if (input.topic.writers == dds::Writers::kMany) return;
  const Duration age = FromDds(info.reception_timestamp) - FromDds(info.source_timestamp);
  const auto offset = input.clock_offset.Add(age, std::chrono::steady_clock::now());
  if (!offset) return;
  const double milliseconds = 1e3 * Seconds(*offset);
  health.Timed("clock ahead of that of " + input.topic.name, milliseconds);
  spdlog::warn("{}: this machine's clock is {:.0f} ms {} that of {}", input.topic.name,
               std::abs(milliseconds), milliseconds > 0 ? "ahead of" : "behind",
               NameOf(info.publication_handle));
}

void Bus::State::CountRefusedDatagrams() {
  for (const RefusedDatagrams::Entry& entry : guard->refused.Take()) {
    health.Reject("datagram", entry.reason, entry.count);
  }
}

void Bus::State::OnClock(const rosgraph_msgs::msg::Clock& message) {
  const Result<Time> now = FromIdl(message.clock());
  if (!now) return health.Reject<topics::Clock>(now.error());
  const Time before{Duration(topic_now)};
  const bool restarted = topic_clock_runs && *now < before;
  if (restarted) {
    const SteadyTime wall = std::chrono::steady_clock::now();
    if (wall - last_restart < std::chrono::seconds(1)) {
      health.Reject<topics::Clock>("jumps back and forth: there are two simulators in this domain");
    } else {
      spdlog::warn("clock jumped back by {:.3f} s: the simulator was restarted", Seconds(before - *now));
    }
    last_restart = wall;
  }
  if (restarted || !topic_clock_runs) {
    for (Timer<Time>& timer : topic_timers) timer.due = *now + timer.period;
  }
  topic_clock_runs = true;
  topic_now = now->time_since_epoch().count();
}

void Bus::State::StepUntil(SteadyTime deadline) {
  THALWEG_CHECK(!stepping);  // handlers must not spin
  stepping = true;
  if (!at_work_since) at_work_since = std::chrono::steady_clock::now();
  const std::unique_ptr<bool, void (*)(bool*)> end_of_step(&stepping, [](bool* flag) { *flag = false; });
  Wait(deadline);
  RunTasks();
  RunTimers();
  // One message per reader and turn, so that a busy topic delays neither timers nor other topics.
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    if (inputs[k].ready && Take(inputs[k])) RunTimers();
  }
}

void Bus::State::Wait(SteadyTime deadline) {
  const auto has_more = [](const Input& input) { return input.ready; };
  Duration longest = std::min(deadline, NextTimer()) - std::chrono::steady_clock::now();
  if (std::any_of(inputs.begin(), inputs.end(), has_more)) longest = Duration::zero();
  fastdds::ConditionSeq active;
  Doing(nullptr);
  wait_set.wait(active, ToDds(std::clamp<Duration>(longest, Duration::zero(), kLongestWait)));
  Doing("matching readers and writers");
  wake.set_trigger_value(false);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    Input& input = inputs[k];
    if (input.reader == nullptr) continue;
    AdaptReliability(input);
    input.ready = input.ready || input.reader->get_statuscondition().get_trigger_value();
    if (!input.ready) input.sole_writer.SawNothing(std::chrono::steady_clock::now());
  }
}

bool Bus::State::Take(Input& input) {
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

void Bus::State::Handle(Input& input, const fastdds::SampleInfo& info) {
  Doing(input.topic.name.c_str());
  sender = info.publication_handle;
  const Arrival arrival{
      FromDds(info.source_timestamp), FromDds(info.reception_timestamp),
      input.gaps.Missed(info.publication_handle, info.sample_identity.sequence_number().to64long())};
  input.handler(input.newest.data.get(), arrival);
  input.newest.Settle();
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

void Bus::State::RunTimers() {
  const SteadyTime now = std::chrono::steady_clock::now();
  for (std::size_t k = 0; k < wall_timers.size(); ++k) {
    if (!wall_timers[k].Take(now)) continue;
    Doing("a timer");
    wall_timers[k].handler();
  }
  if (!topic_clock_runs) return;
  const Time simulated{Duration(topic_now)};
  for (std::size_t k = 0; k < topic_timers.size(); ++k) {
    if (!topic_timers[k].Take(simulated)) continue;
    Doing("a timer");
    topic_timers[k].handler();
  }
}

SteadyTime Bus::State::NextTimer() const {
  SteadyTime next = SteadyTime::max();
  for (const Timer<SteadyTime>& timer : wall_timers) next = std::min(next, timer.due);
  return next;
}

std::string Bus::State::Introduction() const {
  std::string topics_in;
  for (const Input& input : inputs) {
    topics_in += (topics_in.empty() ? ", waits for " : ", ") + input.topic.name;
  }
  return where + topics_in;
}

Bus::Bus(const BusOptions& options)
    : health_(std::make_unique<Health>(options.name)), state_(std::make_unique<State>(options, *health_)) {
  if (options.clock == ClockSource::kTopic) {
    Subscribe<topics::Clock>([this](const auto& message) { state_->OnClock(message); });
  }
  if (options.publish_health) {
    const auto health_out = Advertise<topics::Health>();
    EveryWall(std::chrono::seconds(1), [this, health_out] {
      state_->CountRefusedDatagrams();
      health_out.Write(health_->ToMessage(Now()));
    });
  }
  if (state_->keys) {
    const auto warn = [this] {
      const auto expiry = FindExpiry(*state_->keys, std::chrono::system_clock::now());
      if (expiry) spdlog::warn("{}", *expiry);
    };
    warn();
    EveryWall(std::chrono::days(1), warn);
  }
  if (options.sole && options.publish_health) {
    Subscribe<topics::Health>([this, name = options.name](const auto& message) {
      if (message.service() != name) return;  // before its own message, with all timings, is made
      // Of participants that exist: the text of a message alone could keep any service from starting.
      if (!state_->peers.IsNamed(eprosima::fastrtps::rtps::iHandle2GUID(state_->sender), name)) return;
      const Duration at_work = std::chrono::steady_clock::now() - *state_->at_work_since;
      if (const auto problem = FindSecondCopy(health_->ToMessage(Now()), message, at_work))
        throw std::runtime_error(*problem);
    });
  }
}

Bus::~Bus() = default;

bool Bus::State::IsAdvertised(const std::string& topic) const {
  return std::ranges::any_of(outputs, [&](const Output& output) { return output.topic == topic; });
}

int Bus::AdvertiseRaw(const std::string& topic, Delivery delivery, TopicDataType* type) {
  const State::Topic its_topic = state_->TopicOf(topic, type);
  if (state_->IsAdvertised(topic)) {
    throw std::runtime_error("DDS: topic \"" + topic + "\" is advertised twice");
  }
  const auto wants_others_only = [&](const Input& input) {
    return input.from_others && input.topic.name == topic;
  };
  if (std::ranges::any_of(state_->inputs, wants_others_only)) throw OwnOutput(topic);
  auto matches = std::make_unique<Matches>(topic, state_->wake, state_->ignored);
  const auto mask = fastdds::StatusMask::publication_matched()
                    << fastdds::StatusMask::offered_incompatible_qos();
  auto* const writer =
      state_->publisher->create_datawriter(its_topic.topic, WriterQosFrom(delivery), matches.get(), mask);
  if (writer == nullptr) throw state_->Refused("publish", "writer", topic);
  const std::lock_guard lock(state_->mutex);
  state_->outputs.push_back({topic, writer, std::move(matches)});
  return static_cast<int>(state_->outputs.size()) - 1;
}

void Bus::SubscribeRaw(const TopicInfo& topic, TopicDataType* type, bool from_others, Keep keep,
                       RawHandler handler) {
  const State::Topic its_topic = state_->TopicOf(topic.name, type);
  if (from_others && state_->IsAdvertised(topic.name)) throw OwnOutput(topic.name);
  CheckedType* const checked = its_topic.type;
  checked->AllowBytes(topic.most_bytes);
  if (topic.most_bytes > state_->guard->largest_sample) state_->guard->largest_sample = topic.most_bytes;
  const bool is_command = topic.delivery == Delivery::kCommand;
  Input& input = state_->inputs.emplace_back(
      Input{.topic = topic,
            .handler = std::move(handler),
            .dds_topic = its_topic.topic,
            .type = checked,
            .sample = Sample(*checked),
            .newest = Sample(*checked),
            .matches = nullptr,
            .from_others = from_others,
            .sole_writer = SoleWriter<WriterId>(SilenceOf(topic.delivery), is_command),
            .gaps = {},
            .keep = keep});
  state_->OpenReader(input);
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
  RawHandler raw = [handler = std::move(handler)](const void* sample, const Arrival& arrival) {
    handler({*static_cast<const BytesType::Sample*>(sample), arrival.source_stamp, arrival.reception_stamp,
             arrival.missed});
  };
  for (Input& input : state_->inputs) {
    if (input.topic.name != topic.name || input.reader != nullptr) continue;
    input.handler = std::move(raw);  // it was unsubscribed
    input.keep = keep;
    input.gaps = {};
    return state_->OpenReader(input);
  }
  SubscribeRaw(of_all_writers, new BytesType(topic.type_name), false, keep, std::move(raw));
}

void Bus::UnsubscribeBytes(const std::string& topic) {
  for (Input& input : state_->inputs) {
    if (input.topic.name == topic && input.reader != nullptr) state_->CloseReader(input);
  }
}

int Bus::WritersOfRaw(const char* topic) const {
  const auto found =
      std::ranges::find_if(state_->inputs, [&](const Input& input) { return input.topic.name == topic; });
  return found == state_->inputs.end() ? 0 : found->matches->count();
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
  THALWEG_CHECK(period > Duration::zero());
  state_->topic_timers.push_back({period, std::move(handler), Now() + period});
}

void Bus::EveryWall(Duration period, std::function<void()> handler) {
  THALWEG_CHECK(period > Duration::zero());
  state_->wall_timers.push_back({period, std::move(handler), std::chrono::steady_clock::now() + period});
}

void Bus::Post(std::function<void()> task) {
  {
    const std::lock_guard lock(state_->mutex);
    state_->tasks.push_back(std::move(task));
  }
  state_->wake.set_trigger_value(true);
}

Time Bus::Now() const {
  if (state_->clock == ClockSource::kTopic) return Time{Duration(state_->topic_now)};
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
