#include "common/dds/shared_memory_ports.h"

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/TransportInterface.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <fastdds/rtps/common/LocatorList.hpp>
#include <filesystem>
#include <future>
#include <memory>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

#include "common/dds/bus.h"
#include "tests/support/test_bus.h"

namespace thalweg::dds {
namespace {

namespace fastdds_rtps = eprosima::fastdds::rtps;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""us;

/// Writes into a port of shared memory, as a peer of whoever listens there.
class PortWriter {
 public:
  explicit PortWriter(std::uint32_t port)
      : transport_(fastdds_rtps::SharedMemTransportDescriptor().create_transport()),
        locator_(LOCATOR_KIND_SHM, port) {
    locator_.address[0] = 'U';  // unicast
    list_.push_back(locator_);
    if (!transport_->init() || !transport_->OpenOutputChannel(senders_, locator_)) {
      throw std::runtime_error("cannot write into port " + std::to_string(port));
    }
  }
  void Write() {
    static constexpr std::array<unsigned char, 20> kHeader = {'R', 'T', 'P', 'S', 2, 3};
    fastdds_rtps::Locators begin(list_.begin());
    fastdds_rtps::Locators end(list_.end());
    senders_.front()->send(kHeader.data(), kHeader.size(), &begin, &end,
                           std::chrono::steady_clock::now() + 1s);
  }

 private:
  const std::unique_ptr<fastdds_rtps::TransportInterface> transport_;
  fastdds_rtps::Locator locator_;
  fastdds_rtps::LocatorList list_;
  fastdds_rtps::SendResourceList senders_;
};

/// A process that writes into a port, once it learns of one. It pauses after each message, so that whoever
/// listens has done with it and waits: a listener that processes a message when it finds the port locked ends
/// its process in Fast DDS 2.9, which nothing here prevents.
class WritingProcess {
 public:
  /// Before this process has other threads.
  WritingProcess() {
    std::array<int, 2> ports{};
    if (pipe(ports.data()) != 0) throw std::runtime_error("no pipe");
    process_ = fork();
    if (process_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      std::uint32_t port = 0;
      if (read(ports[0], &port, sizeof port) != static_cast<int>(sizeof port)) _exit(0);
      for (PortWriter writer(port);; std::this_thread::sleep_for(300us)) writer.Write();
    }
    close(ports[0]);
    port_ = ports[1];
  }
  ~WritingProcess() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    close(port_);
  }
  WritingProcess(const WritingProcess&) = delete;
  WritingProcess& operator=(const WritingProcess&) = delete;

  void Start(std::uint32_t port) const {
    ASSERT_EQ(write(port_, &port, sizeof port), static_cast<int>(sizeof port));
  }
  void Stop() const {
    kill(process_, SIGSTOP);
    int status = 0;
    ASSERT_EQ(waitpid(process_, &status, WUNTRACED), process_);
    ASSERT_TRUE(WIFSTOPPED(status));
  }
  void GoOn() const { kill(process_, SIGCONT); }
  void Kill() const { kill(process_, SIGKILL); }

 private:
  pid_t process_ = -1;
  int port_ = -1;
};

/// The discovery ports of a domain's participants in shared memory.
std::set<std::uint32_t> PortsOf(int domain) {
  std::set<std::uint32_t> ports;
  static const std::regex kPort("fastrtps_port([0-9]{8,10})");
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
    const std::string name = entry.path().filename().string();
    std::smatch parts;
    if (!std::regex_match(name, parts, kPort)) continue;
    const auto port = static_cast<std::uint32_t>(std::stoul(parts[1].str()));
    if (port / 10'000'000 == static_cast<std::uint32_t>(domain) + 1 && port % 2 == 0) ports.insert(port);
  }
  return ports;
}

TEST(SharedMemoryPorts, AParticipantEndsAlthoughAPeerWasKilledWhileItHeldTheLockOfAPort) {
  const WritingProcess peer;
  const BusOptions options = test::BusOptionsForTest("test");
  const std::set<std::uint32_t> before = PortsOf(options.domain);
  auto bus = std::make_unique<Bus>(options);
  const std::set<std::uint32_t> after = PortsOf(options.domain);
  const auto port =
      std::find_if(after.begin(), after.end(), [&](std::uint32_t p) { return before.count(p) == 0; });
  ASSERT_NE(port, after.end());
  PortWriter other(*port);
  other.Write();
  peer.Start(*port);
  // The peer is stopped at any of its instructions until it is found to hold the lock.
  std::future<void> written;
  for (bool locked = false; !locked;) {
    peer.Stop();
    ASSERT_FALSE(HasFatalFailure()) << "the peer ended";
    written = std::async(std::launch::async, [&] { other.Write(); });
    locked = written.wait_for(100ms) == std::future_status::timeout;
    if (locked) break;
    peer.GoOn();
    std::this_thread::sleep_for(200us);
  }
  peer.Kill();
  bus.reset();
}

}  // namespace
}  // namespace thalweg::dds
