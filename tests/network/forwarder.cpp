#include <fcntl.h>
#include <linux/if.h>
#include <linux/if_tun.h>
#include <sched.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <queue>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <tuple>
#include <vector>

#include "common/base/statistics.h"
#include "common/service/command_line.h"
#include "tests/network/link_model.h"
#include "tests/network/rtps_tally.h"

namespace thalweg::network {
namespace {

using Json = nlohmann::ordered_json;
using Steady = std::chrono::steady_clock;
using Frame = std::vector<std::uint8_t>;

constexpr LinkTime kNever = LinkTime::max();

[[noreturn]] void Fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

class File {
 public:
  File(int descriptor, const std::string& what) : descriptor_(descriptor) {
    if (descriptor < 0) Fail(what);
  }
  ~File() { close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};

/// Attaches to the TAP device of the given name in a namespace below /run/netns.
/// @param place  NAMESPACE/DEVICE.
int OpenTap(const std::string& place) {
  const std::size_t slash = place.find('/');
  if (slash == std::string::npos) throw std::runtime_error(place + ": must be NAMESPACE/DEVICE");
  const std::string name = place.substr(slash + 1);
  ifreq request{};
  if (name.empty() || name.size() >= sizeof(request.ifr_name)) {
    throw std::runtime_error(place + ": a device's name has 1 to 15 letters");
  }
  name.copy(request.ifr_name, name.size());
  request.ifr_flags = IFF_TAP | IFF_NO_PI;

  const File home(open("/proc/self/ns/net", O_RDONLY | O_CLOEXEC), "/proc/self/ns/net");
  const std::string path = "/run/netns/" + place.substr(0, slash);
  const File away(open(path.c_str(), O_RDONLY | O_CLOEXEC), path);
  if (setns(away.get(), CLONE_NEWNET) != 0) Fail("cannot enter " + path);
  const int tap = open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (tap < 0) Fail("/dev/net/tun");
  if (ioctl(tap, TUNSETIFF, &request) != 0) Fail("cannot attach to " + place);
  if (setns(home.get(), CLONE_NEWNET) != 0) Fail("cannot return to the first namespace");
  return tap;
}

struct Counts {
  std::uint64_t packets = 0;
  std::uint64_t bytes = 0;
  std::uint64_t arrived = 0;
  std::uint64_t lost = 0;
  std::uint64_t cut = 0;
  std::uint64_t queue_full = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t refused = 0;  ///< By the receiving device.
};

/// One direction of the link: from one device to the other.
class Path {
 public:
  Path(const LinkOptions& options, std::uint64_t seed, int from, int to, RtpsTally::Direction direction,
       RtpsTally& tally)
      : model_(options, seed), from_(from), to_(to), direction_(direction), tally_(tally) {}

  int from() const { return from_; }

  /// Takes frames from the device until it has no more, at most as many as the other direction can wait for.
  void TakeFrames(Steady::time_point begin) {
    constexpr int kMost = 64;
    for (int i = 0; i < kMost; ++i) {
      const ssize_t size = read(from_, buffer_.data(), buffer_.size());
      if (size <= 0) return;
      Take({buffer_.data(), static_cast<std::size_t>(size)}, Steady::now() - begin);
    }
  }
  void DeliverDue(Steady::time_point begin) {
    while (!waiting_.empty()) {
      const LinkTime now = Steady::now() - begin;
      if (waiting_.top().arrival > now) return;
      Deliver(waiting_.top().frame, waiting_.top().copies);
      lateness_.Add(std::chrono::duration<double, std::milli>(now - waiting_.top().arrival).count());
      waiting_.pop();
    }
  }
  /// When the next waiting frame arrives; kNever if none waits.
  LinkTime next_arrival() const { return waiting_.empty() ? kNever : waiting_.top().arrival; }

  Json ToJson() const {
    const auto lateness = lateness_.Summarize();
    Json topics = Json::object();
    for (const auto& [name, count] : tally_.topics(direction_)) {
      topics[name] = {{"bytes", count.bytes}, {"packets", count.packets}, {"samples", count.samples}};
    }
    return {{"packets", counts_.packets},
            {"bytes", counts_.bytes},
            {"arrived", counts_.arrived},
            {"lost", counts_.lost},
            {"cut", counts_.cut},
            {"queue_full", counts_.queue_full},
            {"duplicated", counts_.duplicated},
            {"refused_by_device", counts_.refused},
            {"late_p50_ms", lateness.p50_ms},
            {"late_p95_ms", lateness.p95_ms},
            {"late_max_ms", lateness.max_ms},
            {"by_topic", std::move(topics)}};
  }

 private:
  struct Waiting {
    LinkTime arrival;
    std::uint64_t number;  ///< Frames that arrive at one time keep their order.
    int copies;
    Frame frame;
    bool operator<(const Waiting& other) const {  // the earliest is on top
      return std::tie(arrival, number) > std::tie(other.arrival, other.number);
    }
  };

  void Take(std::span<const std::uint8_t> frame, LinkTime now) {
    ++counts_.packets;
    counts_.bytes += frame.size();
    tally_.Count(direction_, frame);
    const LinkModel::Passage passage = model_.Send(now, frame.size());
    switch (passage.fate) {
      case LinkModel::Fate::kLost:
        ++counts_.lost;
        return;
      case LinkModel::Fate::kCut:
        ++counts_.cut;
        return;
      case LinkModel::Fate::kQueueFull:
        ++counts_.queue_full;
        return;
      case LinkModel::Fate::kArrives:
        break;
    }
    if (waiting_.empty() && passage.arrival <= now) {
      Deliver(frame, passage.copies);
    } else {
      waiting_.push({passage.arrival, counts_.packets, passage.copies, Frame(frame.begin(), frame.end())});
    }
  }
  void Deliver(std::span<const std::uint8_t> frame, int copies) {
    for (int copy = 0; copy < copies; ++copy) {
      const bool taken = write(to_, frame.data(), frame.size()) == static_cast<ssize_t>(frame.size());
      ++(taken ? counts_.arrived : counts_.refused);
    }
    counts_.duplicated += copies > 1 ? 1 : 0;
  }

  LinkModel model_;
  int from_;
  int to_;
  RtpsTally::Direction direction_;
  RtpsTally& tally_;
  std::priority_queue<Waiting> waiting_;
  Counts counts_;
  TimingStatistics lateness_;
  std::array<std::uint8_t, 65'536> buffer_{};
};

/// Sets the timer to when the next frame of either path arrives.
class ArrivalTimer {
 public:
  explicit ArrivalTimer(Steady::time_point begin)
      : begin_(begin), timer_(timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC), "timerfd") {}
  int descriptor() const { return timer_.get(); }
  void Set(LinkTime arrival) {
    if (arrival == set_) return;
    set_ = arrival;
    itimerspec due{};  // zero disarms
    if (arrival != kNever) {
      // steady_clock is CLOCK_MONOTONIC. A time of zero would disarm, but the clock is past it.
      const auto at = (begin_ + arrival).time_since_epoch();
      const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(at);
      due.it_value = {.tv_sec = seconds.count(), .tv_nsec = (at - seconds).count()};
    }
    if (timerfd_settime(timer_.get(), TFD_TIMER_ABSTIME, &due, nullptr) != 0) Fail("timerfd_settime");
  }
  /// To be called when it has expired.
  void Clear() {
    std::uint64_t expirations = 0;
    if (read(timer_.get(), &expirations, sizeof(expirations)) > 0) set_ = kNever;
  }

 private:
  Steady::time_point begin_;
  File timer_;
  LinkTime set_ = kNever;
};

void Listen(const File& poll, int descriptor) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = descriptor;
  if (epoll_ctl(poll.get(), EPOLL_CTL_ADD, descriptor, &event) != 0) Fail("epoll_ctl");
}

/// Forwards until SIGINT or SIGTERM.
void Forward(std::array<Path, 2>& paths, Steady::time_point begin) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
  const File end(signalfd(-1, &signals, SFD_CLOEXEC), "signalfd");
  const File poll(epoll_create1(EPOLL_CLOEXEC), "epoll");
  ArrivalTimer timer(begin);
  Listen(poll, end.get());
  Listen(poll, timer.descriptor());
  for (const Path& path : paths) Listen(poll, path.from());

  while (true) {
    std::array<epoll_event, 4> events;
    const int count = epoll_wait(poll.get(), events.data(), static_cast<int>(events.size()), -1);
    if (count < 0 && errno != EINTR) Fail("epoll_wait");
    for (const epoll_event& event : std::span(events).first(static_cast<std::size_t>(std::max(0, count)))) {
      if (event.data.fd == end.get()) return;
      if (event.data.fd == timer.descriptor()) timer.Clear();
      for (Path& path : paths) {
        if (event.data.fd == path.from()) path.TakeFrames(begin);
      }
    }
    LinkTime next = kNever;
    for (Path& path : paths) {
      path.DeliverDue(begin);
      next = std::min(next, path.next_arrival());
    }
    timer.Set(next);
  }
}

LinkTime FromSeconds(double seconds) {
  return std::chrono::duration_cast<LinkTime>(std::chrono::duration<double>(seconds));
}

/// @param text  FROM+LENGTH or FROM+LENGTH/EVERY, in seconds.
Cut CutFrom(const std::string& text) {
  const auto fail = [&] {
    return std::runtime_error("cut \"" + text + "\": must be FROM+LENGTH[/EVERY], in seconds");
  };
  std::istringstream in(text);
  double from = 0.0;
  double length = 0.0;
  double every = 0.0;
  char plus = '\0';
  char slash = '\0';
  if (!(in >> from >> plus >> length) || plus != '+') throw fail();
  if (in >> slash && (slash != '/' || !(in >> every))) throw fail();
  if (in.clear(), in >> slash) throw fail();
  return {.from = FromSeconds(from), .length = FromSeconds(length), .every = FromSeconds(every)};
}

struct Args {
  std::string robot;
  std::string base;
  std::string out;
  std::uint64_t seed = 1;
  double delay_ms = 0.0;
  double jitter_ms = 0.0;
  double held_back_ms = 10.0;
  double rate_mbit = 0.0;
  double queue_kb = 64.0;
  LinkOptions link;
  std::vector<std::string> cuts;
  std::vector<std::string> cuts_to_base;
  std::vector<std::string> cuts_to_robot;
};

void AddOptions(CLI::App& app, Args& args) {
  app.add_option("--robot", args.robot, "NAMESPACE/DEVICE of the TAP on the robot's side")->required();
  app.add_option("--base", args.base, "NAMESPACE/DEVICE of the TAP on the base station's side")->required();
  app.add_option("--out", args.out, "File for the counts, as JSON, written at SIGINT or SIGTERM")->required();
  app.add_option("--seed", args.seed, "Of the random numbers")->capture_default_str();
  app.add_option("--delay-ms", args.delay_ms, "Mean delay in each direction");
  app.add_option("--jitter-ms", args.jitter_ms, "Delays are uniform in delay +- jitter");
  app.add_option("--loss", args.link.loss, "Probability that a packet is lost");
  app.add_option("--duplicate", args.link.duplicate, "Probability that a packet arrives twice");
  app.add_option("--reorder", args.link.reorder, "Probability that a packet is held back");
  app.add_option("--held-back-ms", args.held_back_ms, "By how much")->capture_default_str();
  app.add_option("--rate-mbit", args.rate_mbit, "Megabits per second in each direction; 0 = unlimited");
  app.add_option("--queue-kb", args.queue_kb, "Kilobytes that wait before a line of limited rate")
      ->capture_default_str();
  app.add_option("--cut", args.cuts, "FROM+LENGTH[/EVERY] in seconds: nothing passes; may be repeated");
  app.add_option("--cut-to-base", args.cuts_to_base, "The same in the direction to the base station alone");
  app.add_option("--cut-to-robot", args.cuts_to_robot, "The same in the direction to the robot alone");
}

LinkOptions LinkFrom(const Args& args, const std::vector<std::string>& cuts) {
  constexpr double kMilli = 1e-3;
  LinkOptions link = args.link;
  link.delay = FromSeconds(args.delay_ms * kMilli);
  link.jitter = FromSeconds(args.jitter_ms * kMilli);
  link.held_back = FromSeconds(args.held_back_ms * kMilli);
  link.rate = args.rate_mbit * 1e6;
  link.queue_bytes = static_cast<std::size_t>(std::max(0.0, args.queue_kb) * 1e3);
  for (const std::string& cut : args.cuts) link.cuts.push_back(CutFrom(cut));
  for (const std::string& cut : cuts) link.cuts.push_back(CutFrom(cut));
  return link;
}

double CpuSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void Run(const Args& args) {
  const File robot(OpenTap(args.robot), args.robot);
  const File base(OpenTap(args.base), args.base);
  RtpsTally tally;
  std::array<Path, 2> paths = {
      Path(LinkFrom(args, args.cuts_to_base), args.seed, robot.get(), base.get(), RtpsTally::kFirst, tally),
      Path(LinkFrom(args, args.cuts_to_robot), args.seed + 1, base.get(), robot.get(), RtpsTally::kSecond,
           tally)};
  std::ofstream out(args.out);
  if (!out) throw std::runtime_error("cannot write " + args.out);
  const auto begin = Steady::now();
  Forward(paths, begin);
  const Json json = {{"duration_s", std::chrono::duration<double>(Steady::now() - begin).count()},
                     {"cpu_s", CpuSeconds()},
                     {"to_base", paths[0].ToJson()},
                     {"to_robot", paths[1].ToJson()}};
  out << json.dump(1) << '\n';
  if (!out.flush()) throw std::runtime_error("cannot write " + args.out);
}

}  // namespace
}  // namespace thalweg::network

/// Carries Ethernet frames between two TAP devices, each in a network namespace of its own, over a link that
/// delays, loses, reorders, duplicates and limits them. For kernels without netem, and to count by topic.
int main(int argc, char** argv) try {
  CLI::App app("Carries Ethernet frames between two TAP devices over a link with faults",
               "network_forwarder");
  thalweg::network::Args args;
  thalweg::network::AddOptions(app, args);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return thalweg::ReportParseError(app, error, "network_forwarder");
  }
  thalweg::network::Run(args);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::cerr << "network_forwarder: " << error.what() << '\n';
  return EXIT_FAILURE;
}
