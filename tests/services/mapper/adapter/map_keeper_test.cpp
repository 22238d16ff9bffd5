#include "services/mapper/adapter/map_keeper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <fstream>
#include <memory>

#include "common/files/write_file.h"
#include "tests/services/mapper/adapter/example_map.h"
#include "tests/services/mapper/adapter/scanned_map.h"
#include "tests/support/full_disk.h"

namespace thalweg::mapper {
namespace {

namespace fs = std::filesystem;
using std::chrono_literals::operator""h;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using test::ExpectSameMap;
using test::FullDisk;
using test::ScannedMap;
using test::TestFolder;
using testing::HasSubstr;
using Kind = MapKeeper::Event::Kind;

/// What a keeper reports, from any thread.
class Events {
 public:
  void Add(const MapKeeper::Event& event) {
    const std::lock_guard lock(mutex_);
    events_.push_back(event);
    changed_.notify_all();
  }
  int Count(Kind kind) const {
    const std::lock_guard lock(mutex_);
    return CountLocked(kind);
  }
  /// Waits until there are so many; false if they do not come.
  bool Await(Kind kind, int count) const {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, 60s, [&] { return CountLocked(kind) >= count; });
  }
  /// Describes the last failure.
  std::string Text() const {
    const std::lock_guard lock(mutex_);
    std::string text;
    for (const auto& event : events_) text = event.kind == Kind::kFailed ? event.text : text;
    return text;
  }

 private:
  int CountLocked(Kind kind) const {
    return static_cast<int>(std::ranges::count(events_, kind, &MapKeeper::Event::kind));
  }
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::vector<MapKeeper::Event> events_;
};

/// A disk of its own of 64 kB at a folder, until destroyed; needs the right to mount.
class SmallDisk {
 public:
  explicit SmallDisk(const fs::path& folder) : folder_(folder) {
    fs::create_directories(folder);
    mounted_ = mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=64k") == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool mounted() const { return mounted_; }

 private:
  fs::path folder_;
  bool mounted_ = false;
};

class MapKeeperTest : public testing::Test {
 protected:
  MapKeeperTest() {
    options_.checkpoint_file = folder_.path() / "map" / "checkpoint.map";
    options_.patience = 1h;
  }

  /// Starts a keeper with what the files hold.
  void Open() {
    keeper_.reset();
    auto stored = LoadStoredMap(options_.checkpoint_file);
    ASSERT_TRUE(stored) << stored.error();
    const MapPosition at = stored->has_value() ? (*stored)->checkpoint.position : MapPosition{};
    std::optional<JournalEnds> ends = stored->has_value() ? (*stored)->journal.ends : std::nullopt;
    keeper_ = std::make_unique<MapKeeper>(options_, map_.voxel_size(), at, std::move(ends),
                                          [this](const auto& event) { events_->Add(event); });
  }
  void Begin() {
    Open();
    keeper_->WriteCheckpoint(Copy());
  }
  Checkpoint Copy() const {
    Checkpoint copy{CopyOf(map_.StateAfter(map_.scans()).grid), map_.StateAfter(map_.scans()).colors};
    copy.position = keeper_->position();
    return copy;
  }
  void Scan() { keeper_->Add(map_.Scan()); }
  void Scan(int times) {
    for (int k = 0; k < times; ++k) Scan();
  }
  /// Ends the keeper once it has done its work.
  void Close() { keeper_.reset(); }
  fs::path Journal() const { return JournalOf(options_.checkpoint_file); }

  /// Expects that the files hold the map after so many scans, and what `from_journal` says.
  void ExpectStored(std::uint64_t scans, std::optional<std::uint64_t> from_journal = std::nullopt) const {
    const auto stored = LoadStoredMap(options_.checkpoint_file);
    ASSERT_TRUE(stored && stored->has_value());
    EXPECT_EQ((*stored)->checkpoint.position.number, scans);
    ExpectSameMap((*stored)->checkpoint, map_.StateAfter(scans));
    EXPECT_EQ((*stored)->journal.problem, "");
    if (from_journal) {
      EXPECT_EQ((*stored)->journal.applied, *from_journal);
    }
  }
  void ExpectNothingUnfinished() const {
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
      EXPECT_NE(entry.path().extension(), ".unfinished");
    }
  }

  TestFolder folder_;
  MapKeeper::Options options_;
  ScannedMap map_;
  std::unique_ptr<Events> events_ = std::make_unique<Events>();
  std::unique_ptr<MapKeeper> keeper_;
};

TEST_F(MapKeeperTest, HoldsTheMapBitByBitAfterEachScan) {
  Begin();
  for (int scans = 1; scans <= 8; ++scans) {
    Scan();
    ASSERT_TRUE(events_->Await(Kind::kStored, scans));
    ExpectStored(static_cast<std::uint64_t>(scans), scans);
  }
  EXPECT_EQ(events_->Count(Kind::kFailed), 0);
}

TEST_F(MapKeeperTest, GoesOnFromWhatItFinds) {
  Begin();
  for (int starts = 0; starts < 4; ++starts) {
    Scan(3);
    Close();
    ExpectStored(map_.scans());
    Open();
    EXPECT_FALSE(keeper_->NeedsCheckpoint());
  }
}

TEST_F(MapKeeperTest, CutsOffATornRecordAndGoesOnAfterTheLastWholeOne) {
  Begin();
  Scan(3);
  Close();
  const auto whole = fs::file_size(Journal());
  for (const std::uintmax_t garbage : {1, 27, 28, 29, 500}) {
    std::ofstream(Journal(), std::ios::app | std::ios::binary) << std::string(garbage, 'x');
    Open();
    EXPECT_EQ(fs::file_size(Journal()), whole);
    Close();
  }
  fs::resize_file(Journal(), whole - 1);
  ScannedMap same;  // the same course again, up to the last whole record
  same.Scan();
  same.Scan();
  std::swap(map_, same);
  Open();
  EXPECT_EQ(keeper_->position().number, 2U);
  Scan(2);
  Close();
  ExpectStored(4, 4);
}

TEST_F(MapKeeperTest, AddNeverLeavesTwoScansToBeLost) {
  std::atomic<int> added = 0;
  std::atomic<int> appended = 0;
  options_.before_append = [&] {
    ++appended;
    EXPECT_LE(added, appended) << "scans were taken while one before them was not stored";
  };
  Begin();
  for (int k = 0; k < 50; ++k) {
    Scan();
    ++added;
  }
  Close();
  EXPECT_EQ(appended, 50);
}

TEST_F(MapKeeperTest, FoldsALongJournalIntoANewCheckpoint) {
  options_.most_journal_bytes = 1;
  Begin();
  const auto at_first = fs::file_size(options_.checkpoint_file);
  while (!keeper_->NeedsCheckpoint()) {
    Scan();
    ASSERT_TRUE(events_->Await(Kind::kStored, static_cast<int>(map_.scans())));
  }
  EXPECT_GT(fs::file_size(Journal()), at_first);
  keeper_->WriteCheckpoint(Copy());
  EXPECT_EQ(fs::file_size(Journal()), kJournalHeadBytes);
  ExpectStored(map_.scans(), 0);
  Scan(2);
  Close();
  ExpectStored(map_.scans(), 2);
}

TEST_F(MapKeeperTest, ScansThatComeWhileACheckpointIsWrittenStayInTheJournal) {
  Begin();
  Scan(3);
  const Checkpoint copy = Copy();
  Scan(2);
  ASSERT_TRUE(events_->Await(Kind::kStored, 5));
  keeper_->WriteCheckpoint(copy);
  ExpectStored(5, 2);
  Scan();
  Close();
  ExpectStored(6, 3);
}

TEST_F(MapKeeperTest, AnOlderCheckpointDoesNotReplaceANewerOne) {
  Begin();
  Scan(2);
  const Checkpoint older = Copy();
  Scan(2);
  keeper_->WriteCheckpoint(Copy());
  keeper_->WriteCheckpoint(older);
  Close();
  ExpectStored(4, 0);
}

TEST_F(MapKeeperTest, KilledBetweenCheckpointAndNewJournalNothingIsLost) {
  Begin();
  Scan(4);
  const Checkpoint copy = Copy();
  Scan(2);
  Close();
  const fs::path old_journal = folder_.path() / "old";
  fs::copy_file(Journal(), old_journal);
  Open();
  keeper_->WriteCheckpoint(copy);
  Close();
  fs::copy_file(old_journal, Journal(), fs::copy_options::overwrite_existing);
  ExpectStored(6, 2);
  Open();
  Scan();
  Close();
  ExpectStored(7, 3);
}

TEST_F(MapKeeperTest, AJournalOfAnotherMapOrCourseIsNotApplied) {
  Begin();
  Scan(2);
  Close();
  const fs::path other = folder_.path() / "other";
  fs::copy(options_.checkpoint_file.parent_path(), other);
  const auto use = [&] {
    const auto stored = LoadStoredMap(options_.checkpoint_file);
    return (*stored)->journal;
  };
  // Two courses of the same map, of the same length.
  Open();
  Scan(2);
  keeper_->WriteCheckpoint(Copy());
  Close();
  const fs::path file = std::exchange(options_.checkpoint_file, other / "checkpoint.map");
  ScannedMap another(99);
  another.Scan();
  another.Scan();
  std::swap(map_, another);
  Open();
  Scan(3);
  Close();
  std::swap(map_, another);
  options_.checkpoint_file = file;
  fs::copy_file(other / "checkpoint.journal", Journal(), fs::copy_options::overwrite_existing);
  EXPECT_THAT(use().problem, HasSubstr("another course"));
  EXPECT_EQ(use().applied, 0U);
  EXPECT_FALSE(use().ends);
  // A journal that begins later than the checkpoint ends.
  fs::copy_file(file, folder_.path() / "newer");
  fs::copy_file(other / "checkpoint.map", file, fs::copy_options::overwrite_existing);
  std::ofstream(Journal(), std::ios::binary);
  Open();
  Close();
  {
    const auto head = EncodeHead({map_.voxel_size(), {LoadCheckpoint(file)->value().position.map, 1, 9}});
    std::ofstream(Journal(), std::ios::binary) << std::string(head.begin(), head.end());
  }
  EXPECT_THAT(use().problem, HasSubstr("begins after scan 9"));
  // Another map.
  const auto head = EncodeHead({map_.voxel_size(), {123, 1, 0}});
  std::ofstream(Journal(), std::ios::binary) << std::string(head.begin(), head.end());
  EXPECT_THAT(use().problem, HasSubstr("another map"));
}

TEST_F(MapKeeperTest, AFullDiskCostsNothingOnceThereIsRoomAgain) {
  Begin();
  Scan(2);
  ASSERT_TRUE(events_->Await(Kind::kStored, 2));
  {
    const FullDisk full(fs::file_size(Journal()) + 40);  // room for part of a record
    Scan();
    ASSERT_TRUE(events_->Await(Kind::kFailed, 1));
    Scan(3);
    keeper_->Maintain();
    ASSERT_TRUE(events_->Await(Kind::kFailed, 2));
    EXPECT_THROW(keeper_->WriteCheckpoint(Copy()), std::runtime_error);
    EXPECT_FALSE(keeper_->NeedsCheckpoint()) << "not before the next Maintain";
    EXPECT_EQ(events_->Count(Kind::kStored), 2);
  }
  EXPECT_THAT(events_->Text(), HasSubstr("cannot be written: File too large"));
  ExpectStored(2, 2);
  ExpectNothingUnfinished();
  keeper_->WriteCheckpoint(Copy());
  ASSERT_TRUE(events_->Await(Kind::kRecovered, 1));
  ExpectStored(6, 0);
  Scan();
  Close();
  ExpectStored(7, 1);
  EXPECT_EQ(events_->Count(Kind::kRecovered), 1);
}

TEST_F(MapKeeperTest, WhatWaitedForRoomIsAppendedByTheNextMaintain) {
  Begin();
  Scan();
  ASSERT_TRUE(events_->Await(Kind::kStored, 1));
  {
    const FullDisk full(fs::file_size(Journal()));
    Scan(5);
    ASSERT_TRUE(events_->Await(Kind::kFailed, 1));
  }
  keeper_->Maintain();
  ASSERT_TRUE(events_->Await(Kind::kRecovered, 1));
  ExpectStored(6, 6);
  EXPECT_FALSE(keeper_->NeedsCheckpoint());
}

TEST_F(MapKeeperTest, GoesOnWhenSomebodyMakesRoomOnItsDisk) {
  const fs::path disk = options_.checkpoint_file.parent_path();
  const SmallDisk small(disk);
  if (!small.mounted()) GTEST_SKIP() << "may not mount a small disk";
  Begin();
  Scan();
  ASSERT_TRUE(events_->Await(Kind::kStored, 1));
  std::ofstream(disk / "other") << std::string(100'000, 'x');  // all that is left
  while (events_->Count(Kind::kFailed) == 0) Scan();
  EXPECT_THAT(events_->Text(), HasSubstr("No space left on device"));
  EXPECT_THROW(keeper_->WriteCheckpoint(Copy()), std::runtime_error);
  ExpectNothingUnfinished();
  const auto stored = LoadStoredMap(options_.checkpoint_file);
  ASSERT_TRUE(stored && stored->has_value());
  EXPECT_EQ((*stored)->journal.problem, "") << "nothing half is left";
  ExpectSameMap((*stored)->checkpoint, map_.StateAfter((*stored)->checkpoint.position.number));
  fs::remove(disk / "other");
  keeper_->Maintain();
  EXPECT_TRUE(keeper_->NeedsCheckpoint()) << "the one that failed";
  keeper_->WriteCheckpoint(Copy());
  ASSERT_TRUE(events_->Await(Kind::kRecovered, 1));
  ExpectStored(map_.scans());
}

TEST_F(MapKeeperTest, MoreThanMayWaitIsForgottenAndComesBackWithACheckpoint) {
  options_.most_waiting_bytes = 20'000;
  Begin();
  Scan();
  ASSERT_TRUE(events_->Await(Kind::kStored, 1));
  {
    const FullDisk full(fs::file_size(Journal()));
    while (!keeper_->NeedsCheckpoint()) Scan();
    ExpectStored(1, 1);
  }
  keeper_->Maintain();
  EXPECT_TRUE(keeper_->NeedsCheckpoint());
  EXPECT_EQ(events_->Count(Kind::kRecovered), 0) << "scans are missing";
  const auto forgotten = static_cast<int>(map_.scans());
  keeper_->WriteCheckpoint(Copy());
  ASSERT_TRUE(events_->Await(Kind::kRecovered, 1));
  EXPECT_FALSE(keeper_->NeedsCheckpoint());
  Scan();
  Close();
  ExpectStored(static_cast<std::uint64_t>(forgotten) + 1, 1);
}

/// A disk that takes nothing until it is opened.
class Gate {
 public:
  void Pass() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return open_; });
  }
  void Open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
};

TEST_F(MapKeeperTest, ADiskThatHangsDoesNotHoldUpTheMap) {
  Gate gate;
  options_.patience = 0ms;
  options_.before_append = [&gate] { gate.Pass(); };
  Begin();
  Scan(40);  // returns, although nothing is written
  EXPECT_EQ(events_->Count(Kind::kStored), 0);
  gate.Open();
  Close();
  ExpectStored(40, 40);
  EXPECT_EQ(events_->Count(Kind::kFailed), 0);
}

TEST_F(MapKeeperTest, ADiskThatIsTooSlowIsReportedAndCaughtUpWith) {
  Gate gate;
  options_.patience = 0ms;
  options_.most_waiting_bytes = 20'000;
  options_.before_append = [&gate] { gate.Pass(); };
  Begin();
  while (events_->Count(Kind::kFailed) == 0) Scan();
  EXPECT_THAT(events_->Text(), HasSubstr("too slow"));
  gate.Open();
  keeper_->WriteCheckpoint(Copy());
  ASSERT_TRUE(events_->Await(Kind::kRecovered, 1));
  Close();
  ExpectStored(map_.scans());
}

TEST_F(MapKeeperTest, FilesThatWereRemovedAreWrittenAgain) {
  Begin();
  Scan(3);
  ASSERT_TRUE(events_->Await(Kind::kStored, 3));
  for (const fs::path& removed :
       {options_.checkpoint_file, Journal(), options_.checkpoint_file.parent_path()}) {
    const int failed = events_->Count(Kind::kFailed);
    const int recovered = events_->Count(Kind::kRecovered);
    fs::remove_all(removed);
    keeper_->Maintain();
    EXPECT_EQ(events_->Count(Kind::kFailed), failed + 1);
    EXPECT_THAT(events_->Text(), HasSubstr("was removed"));
    EXPECT_TRUE(keeper_->NeedsCheckpoint());
    Scan();
    keeper_->WriteCheckpoint(Copy());
    ASSERT_TRUE(events_->Await(Kind::kRecovered, recovered + 1));
    ExpectStored(map_.scans());
  }
}

TEST_F(MapKeeperTest, WhatAKilledProcessLeftUnfinishedIsRemoved) {
  Begin();
  Scan();
  Close();
  std::ofstream(UnfinishedOf(options_.checkpoint_file)) << "half a checkpoint";
  std::ofstream(UnfinishedOf(Journal())) << "half a journal";
  Open();
  ExpectNothingUnfinished();
  ExpectStored(1, 1);
}

// A child process fuses scans and is killed in the middle of it, also while it folds the journal.
TEST_F(MapKeeperTest, AProcessKilledAtAnyMomentLosesItsLastScanAtMost) {
  constexpr std::uint64_t kScans = 60;
  std::vector<MapPatch> patches;
  for (std::uint64_t k = 0; k < kScans; ++k) patches.push_back(map_.Scan());
  options_.most_journal_bytes = 20'000;
  for (int round = 0; round < 16; ++round) {
    fs::remove_all(options_.checkpoint_file.parent_path());
    std::array<int, 2> done{};
    ASSERT_EQ(pipe(done.data()), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      MapKeeper keeper(options_, map_.voxel_size(), {}, std::nullopt, [](const auto&) {});
      for (std::uint64_t number = 0; number < kScans; ++number) {
        if (keeper.NeedsCheckpoint()) {
          Checkpoint copy{CopyOf(map_.StateAfter(number).grid), map_.StateAfter(number).colors};
          copy.position = keeper.position();
          keeper.WriteCheckpoint(copy);
        }
        keeper.Add(patches[number]);
        const char one = 1;
        if (write(done[1], &one, 1) != 1) _exit(1);
      }
      pause();
    }
    std::uint64_t added = 0;
    for (char one = 0; added < static_cast<std::uint64_t>(3 * round + 1); ++added) {
      ASSERT_EQ(read(done[0], &one, 1), 1);
    }
    ASSERT_EQ(kill(child, SIGKILL), 0);
    ASSERT_EQ(waitpid(child, nullptr, 0), child);
    close(done[0]);
    close(done[1]);
    const auto stored = LoadStoredMap(options_.checkpoint_file);
    ASSERT_TRUE(stored && stored->has_value()) << stored.error();
    const std::uint64_t number = (*stored)->checkpoint.position.number;
    EXPECT_GE(number + 1, added) << "round " << round;
    ExpectSameMap((*stored)->checkpoint, map_.StateAfter(number));
    EXPECT_TRUE((*stored)->journal.ends);
  }
}

}  // namespace
}  // namespace thalweg::mapper
