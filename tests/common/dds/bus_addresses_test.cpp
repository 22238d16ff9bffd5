#include <arpa/inet.h>
#include <dlfcn.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <gtest/gtest.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/dds/bus.h"
#include "tests/common/dds/small_messages.h"
#include "tests/support/test_bus.h"

namespace {

/// An entry in the list of the machine's addresses. Lists that were handed out may still hold it, so it
/// stays.
struct ExtraAddress {
  std::string interface = "lo";
  sockaddr_in address{};
  ifaddrs entry{};
};

std::mutex extra_mutex;
std::deque<ExtraAddress> extras;
ifaddrs* extra = nullptr;

/// Gives this process's machine another address of the loopback network, all of which work on Linux.
void AddAddress(const std::string& text) {
  const std::lock_guard lock(extra_mutex);
  ExtraAddress& added = extras.emplace_back();
  added.address.sin_family = AF_INET;
  inet_pton(AF_INET, text.c_str(), &added.address.sin_addr);
  added.entry.ifa_name = added.interface.data();
  added.entry.ifa_flags = IFF_UP | IFF_RUNNING | IFF_LOOPBACK;
  added.entry.ifa_addr = reinterpret_cast<sockaddr*>(&added.address);
  extra = &added.entry;
}

}  // namespace

/// Takes the place of the C library's, for this program and for Fast DDS.
extern "C" int getifaddrs(ifaddrs** list) noexcept {
  static const auto real = reinterpret_cast<int (*)(ifaddrs**)>(dlsym(RTLD_NEXT, "getifaddrs"));
  const int result = real(list);
  const std::lock_guard lock(extra_mutex);
  if (result != 0 || extra == nullptr) return result;
  ifaddrs* last = *list;
  while (last->ifa_next != nullptr) last = last->ifa_next;
  last->ifa_next = extra;  // the C library frees the list as one block, which this is no part of
  return result;
}

namespace thalweg::dds {
namespace {

namespace fastrtps = eprosima::fastrtps;
using test::BusOptionsForTest;
using test::kPatience;
using test::Numbered;
using test::Saying;

/// Options of a bus whose name no other process uses.
BusOptions OptionsOf(const std::string& name) {
  return BusOptionsForTest(name + std::to_string(getpid()));
}

/// The participants that a bus knows by a name of OptionsOf.
std::set<std::string> KnownTo(const Bus& bus, const std::string& name) {
  std::set<std::string> ids;
  for (const Participant& participant : bus.Graph().participants) {
    if (participant.name == OptionsOf(name).name) ids.insert(participant.id);
  }
  return ids;
}

std::size_t EntriesIn(const std::string& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

class Addresses : public testing::Test {
 protected:
  Addresses() {
    // Between processes, samples pass through the network; between participants of one, they need not.
    fastrtps::LibrarySettingsAttributes settings;
    settings.intraprocess_delivery = fastrtps::INTRAPROCESS_OFF;
    fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
  }

  /// Handles both buses in turn until `done`; returns false if it takes too long.
  static bool SpinBoth(Bus& a, Bus& b, const std::function<bool()>& done) {
    constexpr auto kTurn = std::chrono::milliseconds(5);
    const auto latest = std::chrono::steady_clock::now() + kPatience;
    while (!a.SpinUntil(done, kTurn) && !b.SpinUntil(done, kTurn)) {
      if (std::chrono::steady_clock::now() >= latest) return false;
    }
    return true;
  }

  /// Gives the machine another address, and waits until both buses use it and know each other again.
  void Move(Bus& a, Bus& b) {
    const auto before_a = KnownTo(b, "a");
    const auto before_b = KnownTo(a, "b");
    AddAddress("127.0.7." + std::to_string(++moves_));
    ASSERT_TRUE(SpinBoth(a, b, [&] {
      const auto now_a = KnownTo(b, "a");
      const auto now_b = KnownTo(a, "b");
      return now_a.size() == 1 && now_a != before_a && now_b.size() == 1 && now_b != before_b;
    })) << moves_;
  }

 private:
  static inline int moves_ = 0;  // over all tests, since addresses stay until the next one comes
};

TEST_F(Addresses, SamplesPassAsBeforeHoweverOftenTheyChange) {
  constexpr int kMoves = 20;
  Bus a(OptionsOf("a"));
  Bus b(OptionsOf("b"));
  const auto state = a.Advertise<topics::MotionStatus>();
  const auto there = a.Advertise<topics::MapUpdates>();
  const auto back = b.Advertise<topics::SurfaceUpdates>();
  std::vector<std::string> states;
  std::uint64_t come_there = 0;
  std::uint64_t come_back = 0;
  b.Subscribe<topics::MotionStatus>([&](const auto& m) { states.push_back(m.reason()); });
  b.Subscribe<topics::MapUpdates>([&](const auto& m) { come_there = m.number(); });
  a.Subscribe<topics::SurfaceUpdates>([&](const auto& m) { come_back = m.number(); });

  std::size_t threads = 0;
  std::size_t files = 0;
  for (int k = 1; k <= kMoves; ++k) {
    state.Write(Saying(std::to_string(k)));
    ASSERT_TRUE(SpinBoth(a, b, [&] { return !states.empty() && states.back() == std::to_string(k); }));
    states.clear();
    Move(a, b);
    ASSERT_TRUE(SpinBoth(a, b, [&] { return !states.empty(); })) << "the state for those that come later";
    EXPECT_EQ(states.back(), std::to_string(k));

    ASSERT_TRUE(SpinBoth(a, b, [&] {
      return there.readers() == 1 && back.readers() == 1 && b.Writers<topics::MapUpdates>() == 1 &&
             a.Writers<topics::SurfaceUpdates>() == 1;
    }));
    const auto number = static_cast<std::uint64_t>(k);
    thalweg_msgs::msg::SurfaceUpdate reply;
    reply.number(number);
    EXPECT_TRUE(there.Write(Numbered(number)));
    EXPECT_TRUE(back.Write(reply));
    ASSERT_TRUE(SpinBoth(a, b, [&] { return come_there == number && come_back == number; })) << k;
    if (k == 1) {
      threads = EntriesIn("/proc/self/task");
      files = EntriesIn("/proc/self/fd");
    }
  }
  EXPECT_LE(EntriesIn("/proc/self/task"), threads);
  EXPECT_LE(EntriesIn("/proc/self/fd"), files);
}

TEST_F(Addresses, WhoComesLaterGetsWhatWasSaidBeforeTheyChanged) {
  Bus a(OptionsOf("a"));
  Bus b(OptionsOf("b"));
  const auto state = a.Advertise<topics::MotionStatus>();
  const auto log = a.Advertise<topics::Log>();
  state.Write(Saying("old"));
  state.Write(Saying("latest"));
  rcl_interfaces::msg::Log line;
  const std::vector<std::string> lines = {"one", "two", "three"};
  for (const std::string& text : lines) {
    line.msg(text);
    log.Write(line);
  }
  Move(a, b);

  Bus late(OptionsOf("late"));
  std::vector<std::string> states;
  std::vector<std::string> heard;
  late.Subscribe<topics::MotionStatus>([&](const auto& m) { states.push_back(m.reason()); });
  late.Subscribe<topics::Log>([&](const auto& m) { heard.push_back(m.msg()); });
  ASSERT_TRUE(late.SpinUntil([&] { return !states.empty() && heard.size() == lines.size(); }, kPatience));
  EXPECT_EQ(states, std::vector<std::string>{"latest"});
  EXPECT_EQ(heard, lines);
}

TEST_F(Addresses, AThreadMayWriteWhileTheyChange) {
  Bus a(OptionsOf("a"));
  Bus b(OptionsOf("b"));
  const auto state = a.Advertise<topics::MotionStatus>();
  const auto log = a.Advertise<topics::MapUpdates>();
  std::uint64_t heard = 0;
  b.Subscribe<topics::MotionStatus>([](const auto&) {});
  b.Subscribe<topics::MapUpdates>([&](const auto& m) { heard = m.number(); });
  std::atomic<std::uint64_t> written = 0;
  std::jthread writer([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      state.Write(Saying("moving"));
      log.Write(Numbered(++written));
      log.AwaitDelivery(std::chrono::milliseconds(1));
    }
  });
  for (int k = 0; k < 5; ++k) {
    Move(a, b);
    const std::uint64_t until_now = written;
    ASSERT_TRUE(SpinBoth(a, b, [&] { return heard > until_now; })) << k;
  }
}

TEST_F(Addresses, ABusOfThisMachineAloneStaysAsItIs) {
  BusOptions here = OptionsOf("local");
  here.local_only = true;
  Bus local(here);
  Bus network(OptionsOf("network"));
  ASSERT_TRUE(SpinBoth(local, network, [&] {
    return KnownTo(local, "network").size() == 1 && KnownTo(network, "local").size() == 1;
  }));
  const auto stays = KnownTo(network, "local");
  const auto goes = KnownTo(local, "network");
  AddAddress("127.0.8.1");
  ASSERT_TRUE(SpinBoth(local, network, [&] {
    const auto now = KnownTo(local, "network");
    return now.size() == 1 && now != goes && !KnownTo(network, "local").empty();
  }));
  EXPECT_EQ(KnownTo(network, "local"), stays);
}

}  // namespace
}  // namespace thalweg::dds
