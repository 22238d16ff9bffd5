#include "common/dds/shared_memory_files.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

namespace thalweg::dds {
namespace {

namespace fs = std::filesystem;

class SharedMemoryFiles : public testing::Test {
 protected:
  SharedMemoryFiles()
      : folder_(fs::path(testing::TempDir()) / ("shared_memory_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~SharedMemoryFiles() override { fs::remove_all(folder_); }

  fs::path Make(const std::string& name, int age_s) const {
    std::ofstream(folder_ / name) << "x";
    fs::last_write_time(folder_ / name, fs::file_time_type::clock::now() - std::chrono::seconds(age_s));
    return folder_ / name;
  }
  const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

TEST_F(SharedMemoryFiles, OfKilledProcessesAreRemovedAndAllElseStays) {
  const fs::path killed = Make("fastrtps_0123456789abcdef", 60);
  const fs::path killed_lock = Make("fastrtps_0123456789abcdef_el", 60);
  const fs::path living = Make("fastrtps_1111111111111111", 60);
  const fs::path living_lock = Make("fastrtps_1111111111111111_el", 60);
  const fs::path young = Make("fastrtps_2222222222222222", 0);
  const fs::path young_lock = Make("fastrtps_2222222222222222_el", 0);
  const fs::path other = Make("somebody_elses_el", 60);
  const int lock = open(living_lock.c_str(), O_RDWR);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);

  EXPECT_EQ(RemoveStaleFiles(folder()), 1);
  EXPECT_FALSE(fs::exists(killed));
  EXPECT_FALSE(fs::exists(killed_lock));
  for (const fs::path& file : {living, living_lock, young, young_lock, other}) {
    EXPECT_TRUE(fs::exists(file)) << file;
  }
  close(lock);
}

TEST_F(SharedMemoryFiles, PortsOfADomainAreRemovedWhenNobodyListensInIt) {
  const fs::path killed = Make("fastrtps_port7410", 60);
  const fs::path killed_lock = Make("fastrtps_port7410_el", 60);
  const fs::path killed_mutex = Make("sem.fastrtps_port7410_mutex", 60);
  const fs::path unlocked = Make("fastrtps_port7411", 60);
  const fs::path young = Make("fastrtps_port7413", 1);
  const fs::path young_lock = Make("fastrtps_port7413_el", 1);
  const fs::path living = Make("fastrtps_port7660", 60);
  const fs::path living_lock = Make("fastrtps_port7660_el", 60);
  const fs::path living_peer = Make("fastrtps_port7661", 60);  // a process may still write to it
  const int lock = open(living_lock.c_str(), O_RDWR);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);

  EXPECT_EQ(RemoveStaleFiles(folder()), 2);
  for (const fs::path& file : {killed, killed_lock, killed_mutex, unlocked}) {
    EXPECT_FALSE(fs::exists(file)) << file;
  }
  for (const fs::path& file : {young, young_lock, living, living_lock, living_peer}) {
    EXPECT_TRUE(fs::exists(file)) << file;
  }
  close(lock);
  EXPECT_EQ(RemoveStaleFiles(folder()), 2);
  EXPECT_FALSE(fs::exists(living_peer));
}

TEST_F(SharedMemoryFiles, PortsThatFastDdsIsAboutToMakeKeepTheirMutex) {
  const fs::path mutex = Make("sem.fastrtps_port40000011_mutex", 1);
  const fs::path left = Make("sem.fastrtps_port40000013_mutex", 60);
  RemoveStaleFiles(folder());
  EXPECT_TRUE(fs::exists(mutex));
  EXPECT_FALSE(fs::exists(left));
}

TEST_F(SharedMemoryFiles, NumbersThatNoPortHasAreSomebodyElses) {
  for (const char* const number :
       {"9999999999", "4999999999", "0720000006", "70000", "100", "7399", "2340000000"}) {
    Make("fastrtps_port" + std::string(number), 60);
  }
  EXPECT_TRUE(StaleFiles(folder()).empty());
  Make("fastrtps_port2330000000", 60);
  EXPECT_EQ(StaleFiles(folder()).size(), 1U);
}

TEST_F(SharedMemoryFiles, AreNoneWhereThereIsNoSuchFolder) {
  EXPECT_EQ(RemoveStaleFiles(folder() / "nowhere"), 0);
  EXPECT_GT(FreshSharedPorts(0, folder() / "nowhere"), 0U);
}

TEST_F(SharedMemoryFiles, PortsBeyondThoseOfUdpBelongToDomains) {
  const std::string first = "fastrtps_port" + std::to_string(FreshSharedPorts(3, folder()));
  const fs::path living = Make(first, 60);
  const fs::path living_lock = Make(first + "_el", 60);
  const std::string other = "fastrtps_port" + std::to_string(FreshSharedPorts(3, folder()));
  const fs::path killed = Make(other, 60);  // a process may still write to it
  const fs::path killed_lock = Make(other + "_el", 60);
  const fs::path of_all = Make("fastrtps_port" + std::to_string(7400 + 3 * 250), 60);  // hears multicast
  const fs::path elsewhere = Make("fastrtps_port" + std::to_string(FreshSharedPorts(4, folder())), 60);
  const int lock = open(living_lock.c_str(), O_RDWR);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);

  EXPECT_EQ(RemoveStaleFiles(folder()), 1);
  EXPECT_FALSE(fs::exists(elsewhere));
  for (const fs::path& file : {living, living_lock, killed, killed_lock, of_all}) {
    EXPECT_TRUE(fs::exists(file)) << file;
  }
  close(lock);
  EXPECT_EQ(RemoveStaleFiles(folder()), 3);
}

TEST_F(SharedMemoryFiles, PortsAreFreshWhenNeitherOfThemLeftAnything) {
  for (std::uint32_t pair = 0; pair < 500; ++pair) {
    const std::string port =
        "fastrtps_port" + std::to_string(40'000'000 + 2 * pair + pair % 2);  // of domain 3
    if (pair % 3 == 0 && pair != 42) Make(port, 1);
    if (pair % 3 == 1) Make(port + "_el", 1);
    if (pair % 3 == 2) Make("sem." + port + "_mutex", 1);
  }
  EXPECT_EQ(FreshSharedPorts(3, folder()), 40'000'000U + 2 * 42);
}

TEST_F(SharedMemoryFiles, WhereNoPortsAreFreshThoseLeftTheLongestAgoAreTaken) {
  int lock_of_living = -1;
  for (std::uint32_t pair = 0; pair < 500; ++pair) {
    const std::string port = "fastrtps_port" + std::to_string(40'000'000 + 2 * pair);
    Make(port, pair == 7 ? 500 : pair == 42 ? 400 : 60);
    const fs::path lock = Make(port + "_el", 60 + (pair == 7 || pair == 42 ? 300 : 0));
    if (pair == 7) lock_of_living = open(lock.c_str(), O_RDWR);
  }
  ASSERT_EQ(flock(lock_of_living, LOCK_EX), 0);
  EXPECT_EQ(FreshSharedPorts(3, folder()), 40'000'000U + 2 * 42);
  close(lock_of_living);
}

TEST_F(SharedMemoryFiles, PortsOfTwoParticipantsSeldomAgree) {
  for (const int domain : {0, 232}) {
    std::set<std::uint32_t> seen;
    for (int k = 0; k < 20; ++k) seen.insert(FreshSharedPorts(domain, folder()));
    EXPECT_GT(seen.size(), 10U);
    for (const std::uint32_t port : seen) {
      EXPECT_EQ(port / 10'000'000, static_cast<std::uint32_t>(domain) + 1);
      EXPECT_EQ(port % 2, 0U);
    }
  }
}

}  // namespace
}  // namespace thalweg::dds
