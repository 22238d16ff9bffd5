// Attacks a run with Fast DDS alone, without a Bus: reads every topic of the table, and writes to it lies,
// what it heard, and what it heard with bytes changed. Prints a line for each topic, with tabs in between:
// its name; how many readers its writer matched at most; how many writers its reader matched at most; how
// many samples it took; how many it sent; and what was refused to it. Ends after SECONDS, or by SIGTERM.
//
// Takes the name of a service.
//
// usage: attack_fast_dds DOMAIN SECONDS [--topic NAME]... [--keys DIR ROLE] [--rights DIR]
//        attack_fast_dds --topics
//        attack_fast_dds --lies DIR
//   --topic NAME     only this topic
//   --keys DIR ROLE  as this role, with its keys
//   --rights DIR     with the permissions and the governance of that folder instead
//   --topics         prints the names of all topics instead
//   --lies DIR       writes the lies to files instead, DIR/NUMBER_OF_THE_TOPIC.NUMBER.cdr

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <deque>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/dds/bytes_type.h"
#include "common/dds/security.h"
#include "common/dds/topic_table.h"
#include "tests/security/lies.h"

namespace thalweg::test {
namespace {

namespace fs = std::filesystem;
namespace fastdds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;
using Bytes = dds::BytesType::Sample;
using std::chrono_literals::operator""ms;

std::atomic<bool> stopped = false;  // NOLINT: set by a signal

struct Args {
  int domain = 0;
  double seconds = 0.0;
  std::vector<std::string> only;
  std::string keys;
  std::string role;
  std::string rights;
  std::string lies;
  bool topics = false;
};

Args ParseArgs(int argc, char** argv) {
  Args args;
  std::vector<std::string> plain;
  const auto next = [&](int& k) -> std::string {
    if (k + 1 >= argc) throw std::runtime_error(std::string(argv[k]) + " needs a value");
    return argv[++k];
  };
  for (int k = 1; k < argc; ++k) {
    const std::string arg = argv[k];
    if (arg == "--topic") {
      args.only.push_back(next(k));
    } else if (arg == "--keys") {
      args.keys = next(k);
      args.role = next(k);
    } else if (arg == "--rights") {
      args.rights = next(k);
    } else if (arg == "--lies") {
      args.lies = next(k);
    } else if (arg == "--topics") {
      args.topics = true;
    } else {
      plain.push_back(arg);
    }
  }
  if (args.topics || !args.lies.empty()) return args;
  if (plain.size() != 2) throw std::runtime_error("usage: attack_fast_dds DOMAIN SECONDS [OPTION]...");
  args.domain = std::stoi(plain[0]);
  args.seconds = std::stod(plain[1]);
  return args;
}

/// Files for an attacker that cannot make lies itself. Their stamps are 10 s after the beginning.
void WriteLies(const fs::path& folder) {
  fs::create_directories(folder);
  Heard heard;
  heard.now += std::chrono::seconds(10);
  std::size_t number = 0;
  for (const dds::TopicInfo& topic : dds::AllTopics()) {
    std::size_t k = 0;
    for (const Lie& lie : LiesFor(topic, heard)) {
      const std::string name = std::to_string(number) + '.' + std::to_string(k++) + ".cdr";
      std::ofstream out(folder / name, std::ios::binary);
      out.write(reinterpret_cast<const char*>(lie.bytes.data()),
                static_cast<std::streamsize>(lie.bytes.size()));
    }
    ++number;
  }
}

/// A reader and a writer of one topic, and what came of them.
struct Target {
  const dds::TopicInfo* topic;
  fastdds::DataReader* reader = nullptr;
  fastdds::DataWriter* writer = nullptr;
  std::vector<Lie> lies = {};
  std::deque<Bytes> heard = {};  ///< The latest.
  std::size_t turn = 0;
  int most_readers = 0;
  int most_writers = 0;
  int taken = 0;
  int sent = 0;
};

fastdds::DomainParticipantQos ParticipantQosOf(const Args& args) {
  fastdds::DomainParticipantQos qos;
  qos.name("mapper");
  if (args.keys.empty()) return qos;
  const auto now = std::chrono::system_clock::now();
  qos.properties() = dds::PropertiesFrom(dds::CheckKeys(args.keys, args.role, now));
  if (args.rights.empty()) return qos;
  const auto rights = dds::PropertiesFrom(dds::CheckKeys(args.rights, args.role, now));
  for (auto& property : qos.properties().properties()) {
    for (const auto& other : rights.properties()) {
      const bool is_right = property.name().find("Access-Permissions.") != std::string::npos;
      if (is_right && property.name() == other.name()) property = other;
    }
  }
  return qos;
}

class Attacker {
 public:
  explicit Attacker(const Args& args)
      : participant_(fastdds::DomainParticipantFactory::get_instance()->create_participant(
            static_cast<std::uint32_t>(args.domain), ParticipantQosOf(args))) {
    if (participant_ == nullptr) throw std::runtime_error("Fast DDS refuses the participant");
    publisher_ = participant_->create_publisher(fastdds::PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(fastdds::SUBSCRIBER_QOS_DEFAULT);
    for (const dds::TopicInfo& topic : dds::AllTopics()) {
      if (args.only.empty() || std::ranges::count(args.only, topic.name) > 0) {
        targets_.push_back({.topic = &topic});
      }
    }
    if (targets_.empty()) throw std::runtime_error("no such topic");
    // What lies have to fit is listened to, even if it is not attacked.
    for (const dds::TopicInfo& topic : dds::AllTopics()) {
      const bool is_heard = topic.name == dds::topics::Clock::kName ||
                            topic.name == dds::topics::Odometry::kName ||
                            topic.name == dds::topics::MapUpdates::kName;
      if (is_heard && Find(topic) == nullptr) listened_.push_back({.topic = &topic});
    }
    for (Target& target : targets_) Open(target, true);
    for (Target& target : listened_) Open(target, false);
  }
  ~Attacker() {
    participant_->delete_contained_entities();
    fastdds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Attacker(const Attacker&) = delete;
  Attacker& operator=(const Attacker&) = delete;

  void Step() {
    for (Target& target : listened_) Read(target);
    for (Target& target : targets_) {
      Read(target);
      if (target.writer != nullptr) Write(target);
      NoteMatches(target);
    }
  }

  void Print() const {
    for (const Target& target : targets_) {
      std::string refused;
      if (target.reader == nullptr) refused += "a reader";
      if (target.writer == nullptr) refused += refused.empty() ? "a writer" : " and a writer";
      std::cout << target.topic->name << '\t' << target.most_readers << '\t' << target.most_writers << '\t'
                << target.taken << '\t' << target.sent << '\t' << (refused.empty() ? "-" : refused) << '\n';
    }
    std::cout.flush();
  }

 private:
  Target* Find(const dds::TopicInfo& topic) {
    const auto found = std::ranges::find(targets_, &topic, &Target::topic);
    return found == targets_.end() ? nullptr : &*found;
  }

  void Open(Target& target, bool writes) {
    const dds::TopicInfo& info = *target.topic;
    fastdds::TypeSupport type(new dds::BytesType(info.type_name));
    type.register_type(participant_);
    auto* const topic =
        participant_->create_topic("rt/" + info.name, info.type_name, fastdds::TOPIC_QOS_DEFAULT);
    if (topic == nullptr) return;
    fastdds::DataReaderQos reader_qos;  // takes from whoever writes
    reader_qos.reliability().kind = fastdds::BEST_EFFORT_RELIABILITY_QOS;
    reader_qos.history().depth = 100;
    reader_qos.data_sharing().off();
    reader_qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_RESERVE_MEMORY_MODE;
    target.reader = subscriber_->create_datareader(topic, reader_qos);
    if (!writes) return;
    fastdds::DataWriterQos writer_qos;  // offers what any reader requests
    writer_qos.reliability().kind = fastdds::RELIABLE_RELIABILITY_QOS;
    writer_qos.reliability().max_blocking_time = eprosima::fastrtps::Duration_t(0, 1'000'000);
    writer_qos.durability().kind = fastdds::TRANSIENT_LOCAL_DURABILITY_QOS;
    writer_qos.history().depth = 8;
    writer_qos.publish_mode().kind = fastdds::ASYNCHRONOUS_PUBLISH_MODE;
    writer_qos.data_sharing().off();
    writer_qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::DYNAMIC_RESERVE_MEMORY_MODE;
    target.writer = publisher_->create_datawriter(topic, writer_qos);
  }

  void Read(Target& target) {
    constexpr std::size_t kKept = 20;
    if (target.reader == nullptr) return;
    Bytes bytes;
    fastdds::SampleInfo info;
    while (target.reader->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK) {
      const bool is_own =
          target.writer != nullptr && info.publication_handle == target.writer->get_instance_handle();
      if (!info.valid_data || is_own) continue;
      ++target.taken;
      heard_.Note(*target.topic, bytes);
      target.heard.push_back(std::move(bytes));
      if (target.heard.size() > kKept) target.heard.pop_front();
      bytes = {};
    }
  }

  /// In turn a lie, what was heard, and that with bytes changed.
  void Write(Target& target) {
    const std::size_t turn = target.turn++;
    if (target.lies.empty() || turn % 32 == 0) target.lies = LiesFor(*target.topic, heard_);
    Bytes bytes;
    if (turn % 4 != 3 || target.heard.empty()) {
      bytes = target.lies[turn % target.lies.size()].bytes;
    } else {
      bytes = target.heard[random_() % target.heard.size()];
      const bool changes = turn % 8 == 7 && bytes.size() > dds::BytesType::kHeaderBytes;
      for (int k = 0; changes && k < 3; ++k) {
        const std::size_t room = bytes.size() - dds::BytesType::kHeaderBytes;
        bytes[dds::BytesType::kHeaderBytes + random_() % room] = static_cast<std::uint8_t>(random_());
      }
    }
    if (target.writer->write(&bytes)) ++target.sent;
  }

  static void NoteMatches(Target& target) {
    if (target.writer != nullptr) {
      fastdds::PublicationMatchedStatus status;
      target.writer->get_publication_matched_status(status);
      const int own = target.reader != nullptr ? 1 : 0;  // it hears itself
      target.most_readers = std::max(target.most_readers, status.current_count - own);
    }
    if (target.reader != nullptr) {
      fastdds::SubscriptionMatchedStatus status;
      target.reader->get_subscription_matched_status(status);
      const int own = target.writer != nullptr ? 1 : 0;
      target.most_writers = std::max(target.most_writers, status.current_count - own);
    }
  }

  fastdds::DomainParticipant* participant_;
  fastdds::Publisher* publisher_ = nullptr;
  fastdds::Subscriber* subscriber_ = nullptr;
  std::vector<Target> targets_;
  std::vector<Target> listened_;
  Heard heard_;
  std::mt19937 random_{1};
};

int Main(int argc, char** argv) {
  const Args args = ParseArgs(argc, argv);
  if (args.topics) {
    for (const dds::TopicInfo& topic : dds::AllTopics()) std::cout << topic.name << '\n';
    return EXIT_SUCCESS;
  }
  if (!args.lies.empty()) {
    WriteLies(args.lies);
    return EXIT_SUCCESS;
  }
  fastdds::Log::ClearConsumers();  // which print to the standard output
  std::signal(SIGTERM, [](int) { stopped = true; });
  std::signal(SIGINT, [](int) { stopped = true; });
  Attacker attacker(args);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(args.seconds);
  while (!stopped && std::chrono::steady_clock::now() < end) {
    attacker.Step();
    std::this_thread::sleep_for(10ms);
  }
  attacker.Print();
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace thalweg::test

int main(int argc, char** argv) try {
  return thalweg::test::Main(argc, argv);
} catch (const std::exception& error) {
  std::cerr << "attack_fast_dds: " << error.what() << '\n';
  return EXIT_FAILURE;
}
