// The load that Shade's logger is said to take, both images of a Bumblebee2 (1024 x 768 pixels at 20 Hz, here
// gray) and three laser scanners at 50 Hz (here of 541 points, as clouds of one topic), through `thalweg
// record` and back through `thalweg replay`: what is lost, what it costs, and how far from its own pace a
// recording is replayed.
//
//   bench_recorder_load [SECONDS]   default 30; the recording is written to the current folder and removed

#include <sys/resource.h>
#include <sys/wait.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/base/time.h"
#include "common/dds/bus.h"
#include "common/dds/topic_table.h"
#include "common/dds/topics.h"
#include "services/cli/process/child_process.h"
#include "services/recorder/adapter/mapped_file.h"
#include "services/recorder/core/mcap_reader.h"

namespace {

using namespace thalweg;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;
using Wall = std::chrono::steady_clock;

constexpr int kWidth = 1024;
constexpr int kHeight = 768;
constexpr int kImagesPerSecond = 20;
constexpr int kPoints = 541;
constexpr int kScansPerSecond = 3 * 50;

/// Gray values as a camera's: a gradient and noise of 3 gray values, which compresses little.
sensor_msgs::msg::Image MakeImage() {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 3);
  sensor_msgs::msg::Image image;
  image.width(kWidth);
  image.height(kHeight);
  image.step(kWidth);
  image.encoding("mono8");
  image.header().frame_id("camera_optical_frame");
  image.data().resize(std::size_t{kWidth} * kHeight);
  for (std::size_t i = 0; i < image.data().size(); ++i) {
    const double gradient = 40 + 160.0 * static_cast<double>(i % kWidth) / kWidth;
    image.data()[i] = static_cast<std::uint8_t>(std::lround(gradient + noise(random)));
  }
  return image;
}

sensor_msgs::msg::PointCloud2 MakeScan() {
  std::mt19937 random(2);
  sensor_msgs::msg::PointCloud2 cloud;
  constexpr std::uint32_t kPointBytes = 12;
  cloud.header().frame_id("camera_optical_frame");
  cloud.width(kPoints);
  cloud.height(1);
  cloud.point_step(kPointBytes);
  cloud.row_step(kPointBytes * kPoints);
  cloud.data().resize(std::size_t{kPointBytes} * kPoints);
  for (std::uint8_t& byte : cloud.data()) byte = static_cast<std::uint8_t>(random());
  return cloud;
}

dds::BusOptions Options(int domain) {
  dds::BusOptions options;
  options.name = "load";
  options.domain = domain;
  options.local_only = true;
  options.publish_health = false;
  return options;
}

pid_t Start(const std::filesystem::path& folder, std::vector<std::string> arguments, int domain) {
  arguments.insert(arguments.end(), {"--domain", std::to_string(domain)});
  return cli::StartProcess(
      {.name = arguments.front(),
       .executable = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "thalweg",
       .arguments = arguments,
       .log = folder / (arguments.front() + ".log")});
}

/// Waits for a child that must succeed. @return its processor time [s]
double Await(pid_t child, const std::filesystem::path& log) {
  int status = 0;
  rusage usage{};
  if (wait4(child, &status, 0, &usage) != child || status != 0) {
    throw std::runtime_error(cli::DescribeEnd(status) + "\n" + cli::LastLines(log, 10));
  }
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// @return how many messages were published, by topic
std::map<std::string, int> Publish(dds::Bus& bus, int seconds) {
  const auto left = bus.Advertise<dds::topics::LeftImage>();
  const auto right = bus.Advertise<dds::topics::RightImage>();
  const auto scans = bus.Advertise<dds::topics::DepthPoints>();
  const auto has_readers = [&] { return left.readers() > 0 && right.readers() > 0 && scans.readers() > 0; };
  if (!bus.SpinUntil(has_readers, 20s)) throw std::runtime_error("thalweg record does not read");
  bus.SpinUntil([] { return false; }, 1s);  // until the readers have matched on their side, too

  const sensor_msgs::msg::Image image = MakeImage();
  const sensor_msgs::msg::PointCloud2 scan = MakeScan();
  std::map<std::string, int> published;
  constexpr int kTicks = 300;  // a second: both rates divide it
  const auto begin = Wall::now();
  for (int tick = 0; tick < seconds * kTicks; ++tick) {
    std::this_thread::sleep_until(begin + std::chrono::nanoseconds(1'000'000'000LL * tick / kTicks));
    if (tick % (kTicks / kImagesPerSecond) == 0) {
      published[dds::topics::LeftImage::kName] += left.Write(image) ? 1 : 0;
      published[dds::topics::RightImage::kName] += right.Write(image) ? 1 : 0;
    }
    if (tick % (kTicks / kScansPerSecond) == 0) {
      published[dds::topics::DepthPoints::kName] += scans.Write(scan) ? 1 : 0;
    }
  }
  bus.SpinUntil([] { return false; }, 1s);  // what is still under way arrives
  return published;
}

/// A message's topic by its name in the table; recordings have a slash before it, as ROS 2 does.
std::string TopicOf(const recorder::McapReader& recording, const recorder::Message& message) {
  return recording.channels().at(message.channel).topic.substr(1);
}

/// Departure of replayed messages from the recording's own pace [ms].
class Lateness {
 public:
  explicit Lateness(const recorder::McapReader& recording) {
    recorder::MessageCursor cursor = recording.Read();
    while (const auto message = cursor.Next()) {
      recorded_[TopicOf(recording, *message)].push_back(message->log_time);
    }
  }
  void Add(const std::string& topic, Time written) {
    const std::size_t number = arrived_[topic]++;
    if (number >= recorded_[topic].size())
      throw std::runtime_error(topic + ": more messages than were recorded");
    late_ms_.push_back(1e3 * Seconds(written - recorded_[topic][number]));
  }
  std::size_t arrived() const { return late_ms_.size(); }
  double Rms() const {
    double mean = 0;
    for (const double late : late_ms_) mean += late / static_cast<double>(late_ms_.size());
    double sum = 0;
    for (const double late : late_ms_) sum += (late - mean) * (late - mean);
    return std::sqrt(sum / static_cast<double>(late_ms_.size()));
  }

 private:
  std::map<std::string, std::vector<Time>> recorded_;
  std::map<std::string, std::size_t> arrived_;
  std::vector<double> late_ms_;
};

void Measure(const std::filesystem::path& folder, int seconds) {
  const int domain = 1 + getpid() % 99;
  const std::filesystem::path file = folder / "load.mcap";
  std::map<std::string, int> published;
  const pid_t recording_child =
      Start(folder, {"record", "stereo/*", "depth/points", "-o", file.string()}, domain);
  {
    dds::Bus bus(Options(domain));
    published = Publish(bus, seconds);
  }
  kill(recording_child, SIGINT);
  const double cpu_s = Await(recording_child, folder / "record.log");

  const recorder::MappedFile mapped(file);
  const auto recording = recorder::McapReader::Open(mapped.bytes());
  if (!recording) throw std::runtime_error(recording.error());
  double megabytes = 0;
  std::map<std::string, int> recorded;
  for (recorder::MessageCursor cursor = recording->Read(); const auto message = cursor.Next();) {
    ++recorded[TopicOf(*recording, *message)];
    megabytes += 1e-6 * static_cast<double>(message->payload.size());
  }
  for (const auto& [topic, count] : published) {
    std::printf("%-24s %6d published %6d recorded\n", topic.c_str(), count, recorded[topic]);
  }
  std::printf("record: %.1f MB/s, file %.0f MB of %.0f, %.2f of a core\n", megabytes / seconds,
              1e-6 * static_cast<double>(recording->size()), megabytes, cpu_s / seconds);

  Lateness lateness(*recording);
  dds::Bus bus(Options(domain));
  for (const dds::TopicInfo& topic : dds::AllTopics()) {
    if (!recorded.contains(topic.name)) continue;
    bus.SubscribeBytes(
        topic,
        [&, name = topic.name](const dds::RawSample& sample) { lateness.Add(name, sample.source_stamp); },
        dds::Keep::kForRecording);
  }
  const pid_t replay_child = Start(folder, {"replay", file.string()}, domain);
  bus.SpinUntil([&] { return lateness.arrived() == recording->message_count(); },
                std::chrono::seconds(seconds + 20));
  const double replay_cpu_s = Await(replay_child, folder / "replay.log");
  std::printf("replay: %zu of %llu messages arrived, %.2f ms rms off the recording's pace, %.2f of a core\n",
              lateness.arrived(), static_cast<unsigned long long>(recording->message_count()), lateness.Rms(),
              replay_cpu_s / seconds);
  std::printf("        %s\n", cli::LastLines(folder / "replay.log", 1).c_str());
}

}  // namespace

int main(int argc, char** argv) {
  const int seconds = argc > 1 ? std::atoi(argv[1]) : 30;
  if (seconds <= 0) {
    std::fprintf(stderr, "usage: bench_recorder_load [SECONDS]\n");
    return 2;
  }
  const std::filesystem::path folder =
      std::filesystem::current_path() / ("recorder_load." + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  int code = EXIT_SUCCESS;
  try {
    Measure(folder, seconds);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_recorder_load: %s\n", error.what());
    code = EXIT_FAILURE;
  }
  std::filesystem::remove_all(folder);
  return code;
}
