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
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

#include "common/dds/bus.h"
#include "common/dds/rtps_ports.h"
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
  explicit PortWriter(int port)
      : transport_(fastdds_rtps::SharedMemTransportDescriptor().create_transport()),
        locator_(LOCATOR_KIND_SHM, static_cast<std::uint32_t>(port)) {
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
      int port = 0;
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

  void Start(int port) const { ASSERT_EQ(write(port_, &port, sizeof port), static_cast<int>(sizeof port)); }
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
std::set<int> PortsOf(int domain) {
  std::set<int> ports;
  for (int id = 0; id < 120; ++id) {
    const int port = FirstPortOf(domain, id);
    if (std::filesystem::exists("/dev/shm/fastrtps_port" + std::to_string(port))) ports.insert(port);
  }
  return ports;
}

TEST(SharedMemoryPorts, AParticipantEndsAlthoughAPeerWasKilledWhileItHeldTheLockOfAPort) {
  const WritingProcess peer;
  const BusOptions options = test::BusOptionsForTest("test");
  const std::set<int> before = PortsOf(options.domain);
  auto bus = std::make_unique<Bus>(options);
  const std::set<int> after = PortsOf(options.domain);
  const auto port = std::find_if(after.begin(), after.end(), [&](int p) { return before.count(p) == 0; });
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
