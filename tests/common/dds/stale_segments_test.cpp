#include "common/dds/stale_segments.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace thalweg::dds {
namespace {

namespace fs = std::filesystem;

class StaleSegments : public testing::Test {
 protected:
  StaleSegments() : folder_(fs::path(testing::TempDir()) / ("segments_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~StaleSegments() override { fs::remove_all(folder_); }

  fs::path Make(const std::string& name, int age_s) const {
    std::ofstream(folder_ / name) << "x";
    fs::last_write_time(folder_ / name, fs::file_time_type::clock::now() - std::chrono::seconds(age_s));
    return folder_ / name;
  }
  const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

TEST_F(StaleSegments, OfKilledProcessesAreRemovedAndAllElseStays) {
  const fs::path killed = Make("fastrtps_0123456789abcdef", 60);
  const fs::path killed_lock = Make("fastrtps_0123456789abcdef_el", 60);
  const fs::path living = Make("fastrtps_1111111111111111", 60);
  const fs::path living_lock = Make("fastrtps_1111111111111111_el", 60);
  const fs::path young = Make("fastrtps_2222222222222222", 0);
  const fs::path young_lock = Make("fastrtps_2222222222222222_el", 0);
  const fs::path port = Make("fastrtps_port7410_el", 60);
  const fs::path other = Make("somebody_elses_el", 60);
  const int lock = open(living_lock.c_str(), O_RDWR);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);

  EXPECT_EQ(RemoveStaleSegments(folder()), 1);
  EXPECT_FALSE(fs::exists(killed));
  EXPECT_FALSE(fs::exists(killed_lock));
  for (const fs::path& file : {living, living_lock, young, young_lock, port, other}) {
    EXPECT_TRUE(fs::exists(file)) << file;
  }
  close(lock);
}

TEST_F(StaleSegments, AreNoneWhereThereIsNoSuchFolder) {
  EXPECT_EQ(RemoveStaleSegments(folder() / "nowhere"), 0);
}

}  // namespace
}  // namespace thalweg::dds
