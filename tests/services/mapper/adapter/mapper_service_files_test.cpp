#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "services/mapper/adapter/mapper_service.h"
#include "tests/services/mapper/support/mapper_service_fixture.h"
#include "tests/support/log_text.h"

namespace thalweg::mapper {
namespace {

namespace topics = dds::topics;
using test::At;
using test::CloudAt;
using test::Listener;
using test::MapperServiceTest;
using test::PoseAt;
using thalweg::test::BusOptionsForTest;
using thalweg::test::LogText;

TEST_P(MapperServiceTest, AfterAKillItGoesOnFromItsCheckpointInANewSession) {
  options_.checkpoint_period = std::chrono::milliseconds(10);
  Start();
  for (int i = 1; i <= 3; ++i) Scan(0.5 * i);
  const OccupancyGrid before = CopyOf(mapper_->grid());
  const auto written = [&] {
    const auto loaded = LoadCheckpoint(folder_.path() / MapperService::kCheckpointFile);
    return loaded && loaded->has_value() && (*loaded)->grid.SameAs(before);
  };
  ASSERT_TRUE(SpinUntil(written));
  EXPECT_FALSE(SaysThatItResumed());
  Kill();
  Start();
  EXPECT_TRUE(SaysThatItResumed());
  EXPECT_TRUE(mapper_->grid().SameAs(before));
  Listener listener;
  Connect(listener);
  ASSERT_TRUE(listener.Follow(*bus_, 0, 0));
  const std::uint64_t session = listener.replica().session();
  EXPECT_TRUE(listener.replica().grid().SameAs(before));
  Kill();
  Start();
  Connect(listener);
  Scan(2.0);
  ASSERT_TRUE(listener.Follow(*bus_, session, 1)) << "the listener notices the restart";
  EXPECT_TRUE(listener.replica().grid().SameAs(mapper_->grid()));
}

TEST_P(MapperServiceTest, AfterAKillNoScanButTheLastIsMissing) {
  Start();
  std::vector<OccupancyGrid> states;
  for (int i = 1; i <= 5; ++i) {
    Scan(0.5 * i);
    states.push_back(CopyOf(mapper_->grid()));
    const auto stored = LoadStoredMap(folder_.path() / MapperService::kCheckpointFile);
    ASSERT_TRUE(stored) << stored.error();
    const std::uint64_t number = stored->has_value() ? (*stored)->checkpoint.position.number : 0;
    EXPECT_GE(number + 1, states.size());
    if (number > 0) {
      EXPECT_TRUE((*stored)->checkpoint.grid.SameAs(states.at(number - 1)));
    }
  }
}

TEST_P(MapperServiceTest, FilesThatCannotBeWrittenStayWholeAreToldOnceAndTriedAgain) {
  options_.checkpoint_period = std::chrono::milliseconds(10);
  const auto file = folder_.path() / MapperService::kCheckpointFile;
  const auto in_the_way = folder_.path() / (std::string(MapperService::kCheckpointFile) + ".unfinished");
  const LogText log;
  Start();
  Scan(1.0);
  const OccupancyGrid before = CopyOf(mapper_->grid());
  const auto stored = [&] {
    auto loaded = LoadCheckpoint(file);
    return loaded && loaded->has_value() ? *std::move(loaded) : std::nullopt;
  };
  ASSERT_TRUE(SpinUntil([&] { return stored() && stored()->position.number == 1; }));
  // Without its journal the map needs a new checkpoint, which cannot be written either.
  std::filesystem::create_directories(in_the_way);
  std::filesystem::remove(JournalOf(file));
  ASSERT_TRUE(SpinUntil([&] { return Dropped() >= 4; })) << Dropped() << log.Text();  // attempts
  Scan(2.0);
  const auto counters = bus_->health().ToMessage(Time{}).dropped();
  ASSERT_EQ(counters.size(), 1U);
  EXPECT_EQ(counters[0].name(), dds::Health::kFiles);
  EXPECT_THAT(counters[0].last(), testing::HasSubstr(MapperService::kCheckpointFile));
  EXPECT_EQ(log.Count("what is on disk stays whole"), 1);
  ASSERT_TRUE(stored());
  EXPECT_EQ(stored()->position.number, 0U) << "the checkpoint from before is whole";
  std::filesystem::remove(in_the_way);
  ASSERT_TRUE(SpinUntil([&] { return log.Count("can be written again") == 1; }));
  ASSERT_TRUE(stored());
  EXPECT_EQ(stored()->position.number, 2U);
  EXPECT_TRUE(stored()->grid.SameAs(mapper_->grid()));
  EXPECT_THAT(bus_->health().ToMessage(Time{}).dropped()[0].last(), testing::HasSubstr("again"));
}

TEST_P(MapperServiceTest, ResumesBeforeATornScanAndSaysWhatItCutOff) {
  Start();
  Scan(1.0);
  const OccupancyGrid first = CopyOf(mapper_->grid());
  Scan(2.0);
  Kill();
  const auto journal = JournalOf(folder_.path() / MapperService::kCheckpointFile);
  std::filesystem::resize_file(journal, std::filesystem::file_size(journal) - 1);
  const LogText log;
  Start();
  EXPECT_TRUE(mapper_->grid().SameAs(first));
  EXPECT_EQ(log.Count("the record after scan 1 is cut off; 1 scans before it are used"), 1);
  EXPECT_EQ(log.Count("after 1 scans, 1 of them from its journal"), 1);
  Scan(3.0);
}

TEST_P(MapperServiceTest, RefusesACheckpointOfAnotherPlaceBeforeItChangesIt) {
  Start();
  for (int i = 1; i <= 6; ++i) Scan(0.5 * i);
  mapper_->Save();
  Kill();
  const auto file = folder_.path() / MapperService::kCheckpointFile;
  const auto before = LoadStoredMap(file);
  Start();
  // The same pose, and a wall across the room a meter ahead.
  PointCloud wall = CloudAt(1.5);
  for (Eigen::Vector3f& p_C : wall.points_C) p_C *= 1.0F / p_C.z();
  odometry_.Write(dds::OdometryToIdl(At(10.5), PoseAt(1.5), {0, 0, 0}, {0, 0, 0}));
  points_.Write(dds::ToIdl(At(10.5), wall));
  try {
    SpinUntil([&] { return Scans() == 1; });
    FAIL() << "it was fused";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("checkpoint.map is of another place"),
                                             testing::HasSubstr("choose another --out or remove the file")));
  }
  Kill();
  const auto after = LoadStoredMap(file);
  ASSERT_TRUE(before && after && before->has_value() && after->has_value());
  EXPECT_EQ((*after)->checkpoint.position, (*before)->checkpoint.position);
  EXPECT_TRUE((*after)->checkpoint.grid.SameAs((*before)->checkpoint.grid));
}

TEST_P(MapperServiceTest, SaveWritesWhatItCanAndNamesTheRest) {
  Start();
  Scan(1.0);
  std::filesystem::create_directories(folder_.path() / "map.bt");  // in the way of the file
  try {
    mapper_->Save();
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), (folder_.path() / "map.bt").string() + ": cannot be written: Is a directory");
  }
  for (const char* name : {"checkpoint.map", "map.ot", "map.ply"}) {
    EXPECT_TRUE(std::filesystem::is_regular_file(folder_.path() / name)) << name;
  }
}

TEST_P(MapperServiceTest, StartsEmptyFromACheckpointThatIsGarbledAndKeepsIt) {
  std::ofstream(folder_.path() / MapperService::kCheckpointFile) << "THALWEG1 and then nonsense";
  Start();
  EXPECT_EQ(mapper_->grid().block_count(), 0u);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "checkpoint.map.unused"));
  Scan(1.0);
}

TEST_P(MapperServiceTest, RefusesACheckpointOfAnotherVoxelSize) {
  Start();
  Scan(1.0);
  mapper_->Save();
  Kill();
  options_.map.voxel_size = 0.05;
  dds::Bus bus(BusOptionsForTest("mapper"));
  try {
    MapperService mapper(options_, bus);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr(MapperService::kCheckpointFile),
                                             testing::HasSubstr("0.1"), testing::HasSubstr("0.05")));
  }
  options_.checkpoint_period = Duration::zero();
  EXPECT_NO_THROW(MapperService(options_, bus)) << "without checkpoints there is none to refuse";
}

TEST_P(MapperServiceTest, SaveLeavesTheMapAsFiles) {
  Start();
  Scan(1.0);
  mapper_->Save();
  octomap::OcTree tree((folder_.path() / "map.bt").string());
  EXPECT_GT(tree.size(), 100u);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "map.ot"));
  EXPECT_GT(std::filesystem::file_size(folder_.path() / "map.ply"), 1000u);
}

}  // namespace
}  // namespace thalweg::mapper
