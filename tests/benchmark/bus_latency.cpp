// Time from a write in one process to the handler in another, by size of the message: the bus beside Fast DDS
// itself, used directly with the same type and the same QoS; with a listener, which is called on a thread of
// Fast DDS, and with a wait set, which like the bus hands the sample to a thread of the application. Where
// the bus sends shorter RTPS messages than Fast DDS does by itself, also with a wait set and messages of that
// length, which tells what the bus costs from what short messages cost. All are in the same two processes and
// take turns, so that the machine's load is the same for all.
//
//   bench_bus_latency [KEYS]   KEYS: a folder of deploy/make-keys; without it, only what is not secured is
//   measured

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/dds/bus.h"
#include "common/dds/qos.h"
#include "common/dds/security.h"

namespace {

namespace tdds = thalweg::dds;  // Fast DDS has a namespace dds, too
namespace fastdds = eprosima::fastdds::dds;
namespace transport = eprosima::fastdds::rtps;
using Topic = tdds::topics::DepthPoints;
using Message = sensor_msgs::msg::PointCloud2;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;

constexpr std::array<std::size_t, 4> kSizes = {1'000, 100'000, 1'000'000, 4'000'000};
constexpr int kMessages = 100;  // of each size, after the first ten
constexpr auto kPause = 25ms;

struct Setup {
  const char* name;
  bool shared_memory;
  bool local_only;  ///< Else RTPS messages are of a size that a network takes; those of Fast DDS never are.
  std::string keys;

  std::uint32_t message_bytes() const { return tdds::LargestMessageBytes(local_only, !keys.empty()); }
  bool sends_short_messages() const {
    return message_bytes() < transport::UDPv4TransportDescriptor().maxMessageSize;
  }
};

std::int64_t SteadyNanoseconds() {
  return std::chrono::steady_clock::now().time_since_epoch().count();
}

tdds::BusOptions OptionsOf(const Setup& setup, const std::string& role) {
  tdds::BusOptions options;
  options.name = role;
  options.domain = 1 + getppid() % 99;
  options.partition = "bus-latency";
  options.shared_memory = setup.shared_memory;
  options.local_only = setup.local_only;
  options.security_dir = setup.keys;
  options.publish_health = false;
  return options;
}

/// A participant with the topic in a partition of its own, by nothing but Fast DDS.
class DirectParticipant {
 public:
  /// @param message_bytes  The largest RTPS message; nothing = what Fast DDS sends by itself.
  DirectParticipant(const Setup& setup, const std::string& role,
                    std::optional<std::uint32_t> message_bytes = {}) {
    const tdds::BusOptions options = OptionsOf(setup, role);
    fastdds::DomainParticipantQos qos;
    qos.name(role);
    if (!setup.keys.empty()) {
      const auto now = std::chrono::system_clock::now();
      qos.properties() = tdds::PropertiesFrom(tdds::CheckKeys(setup.keys, role, now));
    }
    qos.transport().use_builtin_transports = false;
    qos.transport().send_socket_buffer_size = tdds::kSocketBufferBytes;
    qos.transport().listen_socket_buffer_size = tdds::kSocketBufferBytes;
    if (setup.shared_memory) {
      const auto memory = std::make_shared<transport::SharedMemTransportDescriptor>();
      memory->segment_size(static_cast<std::uint32_t>(options.segment_mb) * 1'000'000U);
      qos.transport().user_transports.push_back(memory);
    }
    const auto udp = std::make_shared<transport::UDPv4TransportDescriptor>();
    if (message_bytes) udp->maxMessageSize = *message_bytes;
    qos.transport().user_transports.push_back(udp);
    participant_ = NotNull(fastdds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<std::uint32_t>(options.domain), qos));
    const fastdds::TypeSupport type(thalweg::dds::TypeSupportOf<Topic>().release());
    type.register_type(participant_);
    topic_ = NotNull(participant_->create_topic(std::string("rt/") + Topic::kName, type.get_type_name(),
                                                fastdds::TOPIC_QOS_DEFAULT));
  }
  ~DirectParticipant() {
    participant_->delete_contained_entities();
    fastdds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  DirectParticipant(const DirectParticipant&) = delete;
  DirectParticipant& operator=(const DirectParticipant&) = delete;

  fastdds::DataWriter* Writer(const char* partition) {
    fastdds::PublisherQos qos;
    qos.partition().push_back(partition);
    return NotNull(NotNull(participant_->create_publisher(qos))
                       ->create_datawriter(topic_, tdds::WriterQosFrom(Topic::kDelivery)));
  }
  /// @param listener  May be null.
  fastdds::DataReader* Reader(const char* partition, fastdds::DataReaderListener* listener) {
    fastdds::SubscriberQos qos;
    qos.partition().push_back(partition);
    return NotNull(NotNull(participant_->create_subscriber(qos))
                       ->create_datareader(topic_, tdds::ReaderQosFrom(Topic::kDelivery), listener));
  }

 private:
  template <class Entity>
  static Entity* NotNull(Entity* entity) {
    if (entity == nullptr) throw std::runtime_error("Fast DDS created no entity");
    return entity;
  }
  fastdds::DomainParticipant* participant_;
  fastdds::Topic* topic_;
};

/// Collects the latencies of one way, by size.
class Latencies {
 public:
  /// @return Whether this is the last message.
  bool Add(const Message& message) {
    const auto& stamp = message.header().stamp();
    const std::int64_t sent = std::int64_t{stamp.sec()} * 1'000'000'000 + stamp.nanosec();
    if (message.width() == 0) return true;
    if (message.height() == 1) {
      const auto size = std::ranges::find(kSizes, message.width()) - kSizes.begin();
      const auto latency = static_cast<double>(SteadyNanoseconds() - sent);
      by_size_ms_[static_cast<std::size_t>(size)].push_back(latency * 1e-6);
    }
    return false;
  }
  /// @param share  0.5: the median. @return Infinity if nothing arrived.
  double Quantile(std::size_t size, double share) {
    std::vector<double>& all = by_size_ms_[size];
    if (all.empty()) return HUGE_VAL;
    std::ranges::sort(all);
    return all[static_cast<std::size_t>(share * static_cast<double>(all.size() - 1))];
  }
  std::size_t count(std::size_t size) const { return by_size_ms_[size].size(); }

 private:
  std::array<std::vector<double>, kSizes.size()> by_size_ms_;
};

void TakeAll(fastdds::DataReader& reader, Message& message, Latencies& latencies) {
  fastdds::SampleInfo info;
  while (reader.take_next_sample(&message, &info) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
    if (info.valid_data) latencies.Add(message);
  }
}

class DirectListener final : public fastdds::DataReaderListener {
 public:
  void on_data_available(fastdds::DataReader* reader) override { TakeAll(*reader, message_, latencies); }
  Latencies latencies;

 private:
  Message message_;
};

/// Waits for samples on a thread of its own.
class DirectWaiter {
 public:
  explicit DirectWaiter(fastdds::DataReader& reader) : reader_(reader) {
    reader.get_statuscondition().set_enabled_statuses(fastdds::StatusMask::data_available());
    wait_set_.attach_condition(reader.get_statuscondition());
    thread_ = std::jthread([this](const std::stop_token& stop) {
      Message message;
      fastdds::ConditionSeq active;
      while (!stop.stop_requested()) {
        wait_set_.wait(active, eprosima::fastrtps::Duration_t(0, 100'000'000));
        TakeAll(reader_, message, latencies);
      }
    });
  }
  void Stop() { thread_ = {}; }
  Latencies latencies;  ///< To be read after Stop.

 private:
  fastdds::DataReader& reader_;
  fastdds::WaitSet wait_set_;
  std::jthread thread_;
};

constexpr auto kListening = "latency-of-a-listener";
constexpr auto kWaiting = "latency-of-a-wait-set";
constexpr auto kShort = "latency-of-short-messages";

void Send(const Setup& setup) {
  tdds::Bus bus(OptionsOf(setup, "simulator"));
  const auto out = bus.Advertise<Topic>();
  DirectParticipant direct(setup, "simulator");
  std::vector writers = {direct.Writer(kListening), direct.Writer(kWaiting)};
  std::optional<DirectParticipant> shorter;
  if (setup.sends_short_messages()) {
    shorter.emplace(setup, "simulator", setup.message_bytes());
    writers.push_back(shorter->Writer(kShort));
  }
  const auto has_reader = [](fastdds::DataWriter* writer) {
    fastdds::PublicationMatchedStatus matched;
    writer->get_publication_matched_status(matched);
    return matched.current_count > 0;
  };
  const auto all_meet = [&] { return out.readers() > 0 && std::ranges::all_of(writers, has_reader); };
  if (!bus.SpinUntil(all_meet, 60s)) return;
  Message message;
  const auto stamp = [&] {
    const std::int64_t now = SteadyNanoseconds();
    message.header().stamp().sec(static_cast<std::int32_t>(now / 1'000'000'000));
    message.header().stamp().nanosec(static_cast<std::uint32_t>(now % 1'000'000'000));
  };
  const auto pause = [&] { bus.SpinUntil([] { return false; }, kPause); };
  for (const std::size_t size : kSizes) {
    message.data().resize(size);
    message.width(static_cast<std::uint32_t>(size));
    for (int k = -10; k < kMessages; ++k) {
      message.height(k < 0 ? 0 : 1);
      stamp();
      out.Write(message);
      pause();
      for (fastdds::DataWriter* writer : writers) {
        stamp();
        writer->write(&message);
        pause();
      }
    }
  }
  message.width(0);  // the end
  message.data().clear();
  const auto has_left = [&] {
    out.Write(message);
    return out.readers() == 0;
  };
  while (!has_left()) bus.SpinUntil([] { return false; }, 100ms);
}

void Receive(const Setup& setup) {
  Latencies by_bus;
  DirectListener listener;
  DirectParticipant direct(setup, "mapper");
  direct.Reader(kListening, &listener);
  DirectWaiter waiter(*direct.Reader(kWaiting, nullptr));
  std::optional<DirectParticipant> shorter;
  std::optional<DirectWaiter> short_waiter;
  if (setup.sends_short_messages()) {
    shorter.emplace(setup, "mapper", setup.message_bytes());
    short_waiter.emplace(*shorter->Reader(kShort, nullptr));
  }
  {
    tdds::Bus bus(OptionsOf(setup, "mapper"));
    bool ended = false;
    bus.Subscribe<Topic>([&](const Message& message) { ended = by_bus.Add(message); });
    bus.SpinUntil([&] { return ended; }, 300s);
  }
  waiter.Stop();
  if (short_waiter) short_waiter->Stop();
  for (std::size_t size = 0; size < kSizes.size(); ++size) {
    std::printf("| %s | %s | %zu kB", setup.name, setup.keys.empty() ? "no" : "yes", kSizes[size] / 1000);
    const std::array peers = {&waiter.latencies, &listener.latencies,
                              short_waiter ? &short_waiter->latencies : nullptr};
    const auto print_times = [&](Latencies& latencies) {
      std::printf(" | %.3f, %.3f (%zu)", latencies.Quantile(size, 0.5), latencies.Quantile(size, 0.95),
                  latencies.count(size));
    };
    print_times(by_bus);
    for (Latencies* peer : peers) peer != nullptr ? print_times(*peer) : void(std::printf(" |"));
    const double median = by_bus.Quantile(size, 0.5);
    for (Latencies* peer : peers) {
      peer != nullptr ? void(std::printf(" | %.2f", median / peer->Quantile(size, 0.5)))
                      : void(std::printf(" |"));
    }
    std::printf(" |\n");
  }
  std::fflush(stdout);
}

/// Runs `task` in a process of its own, since Fast DDS shortcuts what stays within one.
pid_t Spawn(const std::function<void()>& task) {
  const pid_t pid = fork();
  if (pid != 0) return pid;
  task();
  std::exit(EXIT_SUCCESS);
}

}  // namespace

int main(int argc, char** argv) {
  std::printf(
      "| transport | keys | size | bus [ms] | Fast DDS, wait set [ms] | Fast DDS, listener [ms] | Fast DDS, "
      "wait "
      "set, short messages [ms] | bus / wait set | bus / listener | bus / short messages "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n");
  std::fflush(stdout);
  std::vector<Setup> setups = {{"shared memory", true, true, ""},
                               {"UDP, this machine", false, true, ""},
                               {"UDP, network", false, false, ""}};
  if (argc > 1) {
    setups.push_back({"UDP, this machine", false, true, argv[1]});
    setups.push_back({"UDP, network", false, false, argv[1]});
  }
  for (const Setup& setup : setups) {
    const pid_t receiver = Spawn([&] { Receive(setup); });
    const pid_t sender = Spawn([&] { Send(setup); });
    waitpid(receiver, nullptr, 0);
    waitpid(sender, nullptr, 0);
  }
}
