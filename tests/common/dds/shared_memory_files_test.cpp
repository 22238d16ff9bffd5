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

TEST_F(SharedMemoryFiles, AreNoneWhereThereIsNoSuchFolder) {
  EXPECT_EQ(RemoveStaleFiles(folder() / "nowhere"), 0);
  EXPECT_GE(FreshParticipantId(0, folder() / "nowhere"), 0);
}

TEST_F(SharedMemoryFiles, AParticipantIdIsFreshWhenNeitherOfItsPortsLeftAnything) {
  for (int id = 0; id < 120; ++id) {
    const int port = 7400 + 3 * 250 + 10 + 2 * id;
    if (id % 3 == 0 && id != 42) Make("fastrtps_port" + std::to_string(port), 1);
    if (id % 3 == 1) Make("fastrtps_port" + std::to_string(port + 1) + "_el", 1);
    if (id % 3 == 2) Make("sem.fastrtps_port" + std::to_string(port) + "_mutex", 1);
  }
  EXPECT_EQ(FreshParticipantId(3, folder()), 42);
}

TEST_F(SharedMemoryFiles, WhereNoParticipantIdIsFreshTheOneLeftTheLongestAgoIsTaken) {
  int lock_of_living = -1;
  for (int id = 0; id < 120; ++id) {
    const std::string port = "fastrtps_port" + std::to_string(7400 + 3 * 250 + 10 + 2 * id);
    Make(port, id == 7 ? 500 : id == 42 ? 400 : 60);
    const fs::path lock = Make(port + "_el", 60 + (id == 42 ? 300 : 0));
    if (id == 7) lock_of_living = open(lock.c_str(), O_RDWR);
  }
  ASSERT_EQ(flock(lock_of_living, LOCK_EX), 0);
  EXPECT_EQ(FreshParticipantId(3, folder()), 42);
  close(lock_of_living);
}

TEST_F(SharedMemoryFiles, TheLastDomainHasFewerIdsBecausePortsEnd) {
  for (int id = 0; id < 62; ++id) Make("fastrtps_port" + std::to_string(7400 + 232 * 250 + 10 + 2 * id), 1);
  EXPECT_EQ(FreshParticipantId(232, folder()), 62);  // ports 65534 and 65535
}

TEST_F(SharedMemoryFiles, TwoParticipantIdsSeldomAgree) {
  std::set<int> seen;
  for (int k = 0; k < 20; ++k) seen.insert(FreshParticipantId(0, folder()));
  EXPECT_GT(seen.size(), 5U);
}

}  // namespace
}  // namespace thalweg::dds
