#include "services/inspector/adapter/machine.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace thalweg::inspector {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

class Machine : public testing::Test {
 protected:
  Machine() { fs::create_directories(folder_); }
  ~Machine() override { fs::remove_all(folder_); }

  void Write(const fs::path& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }

  const fs::path folder_ = fs::path(testing::TempDir()) /
                           (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + '.' +
                            std::to_string(getpid()));
};

TEST_F(Machine, DomainsAreThoseOfDiscoveryPortsWithTheirProcesses) {
  const auto row = [](int port, int inode) {
    std::array<char, 8> hex{};
    std::snprintf(hex.data(), hex.size(), "%04X", static_cast<unsigned>(port));
    return "  1: 00000000:" + std::string(hex.data()) +
           " 00000000:0000 07 00000000:00000000 00:00000000 00000000 0 0 " + std::to_string(inode) +
           " 2 0 0\n";
  };
  const auto discovery = [&](int domain, int inode) { return row(7400 + 250 * domain, inode); };
  const auto unicast = [&](int domain, int inode) { return row(7400 + 250 * domain + 12, inode); };
  Write("net/udp", "  sl  local_address ...\n" + discovery(0, 11) + unicast(0, 21) + discovery(7, 12) +
                       unicast(7, 22) + unicast(7, 32) + row(7401, 13) + discovery(9, 14) + unicast(9, 24) +
                       discovery(11, 15) + unicast(11, 25) + discovery(193, 16) + discovery(50, 17) +
                       "nonsense\n");
  const auto process = [&](const std::string& number, const std::string& words,
                           const std::vector<int>& inodes) {
    Write(number + "/cmdline", words);
    fs::create_directories(folder_ / number / "fd");
    fs::create_symlink("/dev/null", folder_ / number / "fd/3");
    int file = 4;
    for (const int inode : inodes)
      fs::create_symlink("socket:[" + std::to_string(inode) + "]",
                         folder_ / number / "fd" / std::to_string(file++));
  };
  process("100", std::string("/usr/bin/thalweg-mapper\0--domain\0", 33), {12, 22});
  process("101", std::string("driver\0", 7), {12, 32, 14, 24});
  process("102", std::string("browser\0", 8), {16});                     // given this port by chance
  process(std::to_string(getpid()), std::string("own\0", 4), {15, 25});  // this process, which is left out
  const std::vector<DomainFacts> domains = DomainsInUse(folder_);
  ASSERT_EQ(domains.size(), 3U);
  EXPECT_EQ(domains[0].number, 0);  // of a process whose files are not shown
  EXPECT_TRUE(domains[0].processes.empty());
  EXPECT_EQ(domains[1].number, 7);
  EXPECT_THAT(domains[1].processes, ElementsAre("driver (101)", "thalweg-mapper (100)"));
  EXPECT_EQ(domains[2].number, 9);
}

TEST_F(Machine, FilesThatAKilledProcessLeftInSharedMemoryAreCountedAndKept) {
  const std::string segment = "fastrtps_0123456789abcdef";
  Write(segment, std::string(100'000, 'x'));
  Write(segment + "_el", "");
  const auto old = fs::file_time_type::clock::now() - std::chrono::minutes(1);
  for (const auto& entry : fs::directory_iterator(folder_)) fs::last_write_time(entry.path(), old);
  const SharedMemoryFacts facts = ReadSharedMemory(folder_);
  EXPECT_TRUE(facts.is_there);
  EXPECT_TRUE(facts.is_writable);
  EXPECT_EQ(facts.owner, facts.user);
  EXPECT_EQ(facts.stale_files, 1U);
  EXPECT_GE(facts.stale_bytes, 100'000U);
  EXPECT_LT(facts.stale_bytes, 200'000U);
  EXPECT_TRUE(facts.other_owners.empty());
  EXPECT_TRUE(fs::exists(folder_ / segment));
  EXPECT_FALSE(ReadSharedMemory(folder_ / "absent").is_there);
}

TEST_F(Machine, ItsInterfacesHoldTheLoopback) {
  const std::vector<InterfaceFacts> interfaces = ReadInterfaces();
  const auto loopback = std::ranges::find(interfaces, "127.0.0.1", &InterfaceFacts::address);
  ASSERT_NE(loopback, interfaces.end());
  EXPECT_TRUE(loopback->is_loopback);
}

TEST_F(Machine, NumbersAndFreeRoomAreReadWhereTheyAre) {
  Write("number", "4194304\n");
  Write("text", "none\n");
  EXPECT_EQ(NumberInFile(folder_ / "number"), 4194304U);
  EXPECT_FALSE(NumberInFile(folder_ / "text"));
  EXPECT_FALSE(NumberInFile(folder_ / "absent"));
  EXPECT_GT(FreeBytes(folder_ / "to" / "be" / "made").value_or(0), 0U);
}

}  // namespace
}  // namespace thalweg::inspector
