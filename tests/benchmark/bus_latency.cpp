// Time from Write in one process to the handler in another, by size of the message, over UDP and shared
// memory, without and with security.
//
//   bench_bus_latency [KEYS]   KEYS: a folder of deploy/make-keys; without it, only what is not secured is
//   measured

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "common/dds/bus.h"

namespace {

using namespace thalweg;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;

constexpr std::array<std::size_t, 3> kSizes = {1'000, 100'000, 1'000'000};
constexpr int kMessages = 100;  // of each size, after the first ten

struct Setup {
  bool shared_memory;
  std::string keys;
};

dds::BusOptions OptionsOf(const Setup& setup, const std::string& role) {
  dds::BusOptions options;
  options.name = role;
  options.domain = 1 + getppid() % 99;
  options.partition = "bus-latency";
  options.shared_memory = setup.shared_memory;
  options.security_dir = setup.keys;
  options.publish_health = false;
  return options;
}

std::int64_t SteadyNanoseconds() {
  return std::chrono::steady_clock::now().time_since_epoch().count();
}

void Send(const Setup& setup) {
  dds::Bus bus(OptionsOf(setup, "simulator"));
  const auto out = bus.Advertise<dds::topics::DepthPoints>();
  if (!bus.SpinUntil([&] { return out.readers() > 0; }, 60s)) return;
  sensor_msgs::msg::PointCloud2 message;
  for (const std::size_t size : kSizes) {
    message.data().resize(size);
    message.width(static_cast<std::uint32_t>(size));
    for (int k = -10; k < kMessages; ++k) {
      const std::int64_t now = SteadyNanoseconds();
      message.header().stamp().sec(static_cast<std::int32_t>(now / 1'000'000'000));
      message.header().stamp().nanosec(static_cast<std::uint32_t>(now % 1'000'000'000));
      message.height(k < 0 ? 0 : 1);
      out.Write(message);
      bus.SpinUntil([] { return false; }, 50ms);
    }
  }
  message.width(0);  // the end
  const auto has_left = [&] {
    out.Write(message);
    return out.readers() == 0;
  };
  while (!has_left()) bus.SpinUntil([] { return false; }, 100ms);
}

void Receive(const Setup& setup) {
  std::array<std::vector<double>, kSizes.size()> latencies_ms;
  bool ended = false;
  dds::Bus bus(OptionsOf(setup, "mapper"));
  bus.Subscribe<dds::topics::DepthPoints>([&](const auto& message) {
    const auto& stamp = message.header().stamp();
    const std::int64_t sent = std::int64_t{stamp.sec()} * 1'000'000'000 + stamp.nanosec();
    const auto size = std::ranges::find(kSizes, message.width()) - kSizes.begin();
    if (message.width() == 0) {
      ended = true;
    } else if (message.height() == 1) {
      const auto latency = static_cast<double>(SteadyNanoseconds() - sent);
      latencies_ms[static_cast<std::size_t>(size)].push_back(latency * 1e-6);
    }
  });
  bus.SpinUntil([&] { return ended; }, 300s);
  std::printf("| %s | %s |", setup.shared_memory ? "shared memory" : "UDP",
              setup.keys.empty() ? "no" : "yes");
  for (std::vector<double>& of_size : latencies_ms) {
    if (of_size.empty()) {
      std::printf(" none arrived |");
      continue;
    }
    std::ranges::sort(of_size);
    std::printf(" %.2f, %.2f (%zu) |", of_size[of_size.size() / 2], of_size[of_size.size() * 95 / 100],
                of_size.size());
  }
  std::printf("\n");
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
  const std::string keys = argc > 1 ? argv[1] : "";
  std::printf("| transport | secured | 1 kB [ms] | 100 kB [ms] | 1 MB [ms] |\n|---|---|---|---|---|\n");
  std::fflush(stdout);
  for (const bool shared_memory : {false, true}) {
    for (const std::string& its_keys : keys.empty() ? std::vector{keys} : std::vector{std::string(), keys}) {
      const Setup setup{shared_memory, its_keys};
      const pid_t receiver = Spawn([&] { Receive(setup); });
      const pid_t sender = Spawn([&] { Send(setup); });
      waitpid(receiver, nullptr, 0);
      waitpid(sender, nullptr, 0);
    }
  }
}
