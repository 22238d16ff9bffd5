#include "services/inspector/adapter/machine.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

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
  Write("net/udp", "  sl  local_address ...\n" + row(7400, 11) + row(7400 + 250 * 7, 12) + row(7411, 13) +
                       row(7400 + 250 * 9, 14) + row(7400 + 250 * 11, 15) + "nonsense\n");
  Write("100/cmdline", std::string("/usr/bin/thalweg-mapper\0--domain\0", 33));
  Write("101/cmdline", std::string("driver\0", 7));
  fs::create_directories(folder_ / "100/fd");
  fs::create_directories(folder_ / "101/fd");
  fs::create_symlink("socket:[12]", folder_ / "100/fd/3");
  fs::create_symlink("/dev/null", folder_ / "100/fd/4");
  fs::create_symlink("socket:[12]", folder_ / "101/fd/3");
  fs::create_symlink("socket:[14]", folder_ / "101/fd/4");
  const fs::path own_files = folder_ / std::to_string(getpid()) / "fd";  // of this process, which is left out
  fs::create_directories(own_files);
  fs::create_symlink("socket:[15]", own_files / "3");
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
