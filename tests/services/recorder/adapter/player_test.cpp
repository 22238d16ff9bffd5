#include "services/recorder/adapter/player.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <limits>
#include <thread>

#include "common/dds/convert.h"
#include "common/dds/map_log.h"
#include "common/dds/map_replica.h"
#include "common/dds/schema.h"
#include "common/dds/topic_table.h"
#include "services/recorder/adapter/mapped_file.h"
#include "services/recorder/adapter/recording_file.h"
#include "tests/support/test_bus.h"

// A replay that is steered; one that is not is in recorder_test.cpp, what is chosen in
// player_options_test.cpp.

namespace thalweg::recorder {
namespace {

namespace topics = dds::topics;
using namespace thalweg_msgs::msg;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using thalweg::test::BusOptionsForTest;
using thalweg::test::kPatience;

constexpr Time kBegin{1000s};  // log time of the first message
constexpr Duration kLength = 10s;

std::vector<std::uint8_t> OdometryAt(Duration time) {
  RigidTransform pose = RigidTransform::Identity();
  pose.translation().x() = Seconds(time);
  return dds::Encode<topics::Odometry>(dds::OdometryToIdl(Time{time}, pose, {1, 0, 0}, {0, 0, 0}));
}

/// The recording that is played: 10 s of odometry at 10 Hz; from 1 s on, each half second, an update of the
/// map by one voxel; a status and a log line a second; and transforms of two publishers.
class Recording {
 public:
  explicit Recording(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    Write();
    file_.emplace(folder_ / "a.mcap");
    reader_.emplace(*McapReader::Open(file_->bytes()));
  }
  ~Recording() { std::filesystem::remove_all(folder_); }
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  const McapReader& reader() const { return *reader_; }

  /// The map that a reader of the whole recording has at some time.
  dds::MapReplica MapAt(Duration time) const {
    dds::MapReplica map;
    for (const auto& [at, update] : updates_) {
      if (at < time) {
        EXPECT_TRUE(map.Apply(update));
      }
    }
    return map;
  }

 private:
  void Write() {
    enum : std::size_t { kOdometry, kMap, kStatus, kLog, kStatic };
    std::vector<Channel> channels;
    for (const auto& topic : {dds::InfoOf<topics::Odometry>(), dds::InfoOf<topics::MapUpdates>(),
                              dds::InfoOf<topics::ExplorationStatus>(), dds::InfoOf<topics::Log>(),
                              dds::InfoOf<topics::StaticTransforms>()}) {
      channels.push_back({.topic = "/" + topic.name, .type = dds::Ros2TypeName(topic.type_name)});
    }
    RecordingFile file({.file = folder_ / "a.mcap"}, channels);
    const auto write = [&](std::size_t channel, Duration at, const std::vector<std::uint8_t>& bytes) {
      file.Write(channel, 0, kBegin + at, kBegin + at, bytes);
    };
    const auto write_update = [&](Duration at, const MapUpdate& update) {
      updates_.emplace_back(at, update);
      write(kMap, at, dds::Encode<topics::MapUpdates>(update));
    };
    for (const char* const frame : {"base_link", "camera"}) {
      tf2_msgs::msg::TFMessage message;
      message.transforms().resize(1);
      message.transforms()[0].child_frame_id(frame);
      write(kStatic, 0s, dds::Encode<topics::StaticTransforms>(message));
    }
    dds::MapLog log(42, 0.1);
    for (Duration at = 0s; at <= kLength; at += 100ms) {
      write(kOdometry, at, OdometryAt(at));
      if (at == 1s) write_update(at, log.FullCopy(OccupancyGrid(0.1)));
      if (at >= 1s && at % 500ms == 0s) {
        // The voxel's log-odds change later, so that an old value would show.
        const int k = static_cast<int>(at / 500ms);
        const std::vector<VoxelChange> changes = {{{k, k % 3, 0}, 1.0F}, {{0, 0, 0}, static_cast<float>(k)}};
        log.Add(Time{at}, changes);
        write_update(at, log.TakeUpdate());
      }
      if (at % 1s != 0s) continue;
      thalweg_msgs::msg::ExplorationStatus status;
      status.activity(std::to_string(at / 1s));
      write(kStatus, at, dds::Encode<topics::ExplorationStatus>(status));
      rcl_interfaces::msg::Log line;
      line.msg(std::to_string(at / 1s));
      write(kLog, at, dds::Encode<topics::Log>(line));
    }
    file.Close();
  }
  std::filesystem::path folder_;
  std::vector<std::pair<Duration, MapUpdate>> updates_;
  std::optional<MappedFile> file_;
  std::optional<McapReader> reader_;
};

/// What somebody who reads everything holds, and sends.
class Reader {
 public:
  explicit Reader(const std::string& name)
      : bus(BusOptionsForTest(name)),
        commands(bus.Advertise<topics::ReplayCommands>()),
        requests(bus.Advertise<topics::MapRequests>()) {
    bus.Subscribe<topics::ReplayStatus>([this](const auto& message) { statuses.push_back(message); });
    bus.Subscribe<topics::Odometry>(
        [this](const auto& message) { positions.push_back(message.pose().pose().position().x()); });
    bus.Subscribe<topics::MapUpdates>([this](const auto& message) {
      ++updates;
      EXPECT_TRUE(map.Apply(message));
    });
    bus.Subscribe<topics::ExplorationStatus>([this](const auto& message) { activity = message.activity(); });
    bus.Subscribe<topics::Log>([this](const auto& message) { lines.push_back(message.msg()); });
    bus.Subscribe<topics::StaticTransforms>([this](const auto& message) {
      frames.clear();
      for (const auto& transform : message.transforms()) frames.push_back(transform.child_frame_id());
    });
    bus.EveryWall(500ms, [this] {
      if (map.missing()) requests.Write(map.MakeRequest(Time{}, "reader"));
    });
  }

  bool Until(const std::function<bool()>& done) { return bus.SpinUntil(done, kPatience); }
  bool UntilStatus(const std::function<bool(const ReplayStatus&)>& done) {
    return Until([&] { return !statuses.empty() && done(statuses.back()); });
  }
  /// Waits until the player hears it and it hears the player.
  bool Joins() {
    return Until([&] {
      return commands.readers() > 0 && requests.readers() > 0 && bus.Writers<topics::ReplayStatus>() > 0 &&
             bus.Writers<topics::Odometry>() > 0 && bus.Writers<topics::MapUpdates>() > 0 &&
             bus.Writers<topics::ExplorationStatus>() > 0 && bus.Writers<topics::Log>() > 0 &&
             bus.Writers<topics::StaticTransforms>() > 0;
    });
  }
  void Send(ReplayCommandKind kind, Time time = {}, double rate = 0.0, const std::string& sender = "test") {
    ReplayCommand command;
    command.sender(sender);
    command.kind(kind);
    command.time(dds::ToIdl(time));
    command.rate(rate);
    commands.Write(command);
  }
  /// Seeks while paused, and waits until its map is the one of that time.
  void SeekTo(Duration time, const Recording& recording) {
    Send(REPLAY_SEEK, kBegin + time);
    const dds::MapReplica expected = recording.MapAt(time);
    EXPECT_TRUE(Until([&] { return HoldsMap(expected); })) << Seconds(time) << " s";
  }
  bool HoldsMap(const dds::MapReplica& expected) const {
    if (!map.has_map() || !expected.has_map()) {
      return map.has_map() && map.grid().block_count() == 0 && !expected.has_map();
    }
    if (map.grid().block_count() != expected.grid().block_count()) return false;
    bool same = true;
    expected.grid().ForEachBlock([&](const VoxelIndex& index, const OccupancyGrid::Block& block) {
      const OccupancyGrid::Block* const own = map.grid().FindBlock(index);
      for (std::size_t k = 0; k < block.size(); ++k) {
        same = same && own != nullptr &&
               ((std::isnan((*own)[k]) && std::isnan(block[k])) || (*own)[k] == block[k]);
      }
    });
    return same;
  }

  dds::Bus bus;
  dds::Bus::Publisher<topics::ReplayCommands> commands;
  dds::Bus::Publisher<topics::MapRequests> requests;
  std::vector<ReplayStatus> statuses;
  std::vector<double> positions;
  dds::MapReplica map;
  int updates = 0;
  std::string activity;
  std::vector<std::string> lines, frames;
};

Duration NowIn(const ReplayStatus& status) {
  return *dds::FromIdl(status.now()) - kBegin;
}

TEST(PlayerOptions, NameATopicToPlayToRenameOrToPlayAnotherAs) {
  EXPECT_FALSE(Names({}, "health"));
  EXPECT_TRUE(Names({.topics = {"clock", "/health"}}, "health"));
  EXPECT_TRUE(Names({.topics = {"hea*"}}, "health"));
  EXPECT_FALSE(Names({.topics = {"healthy"}}, "health"));
  EXPECT_TRUE(Names({.remap = {{"health", "old"}}}, "health"));
  EXPECT_TRUE(Names({.remap = {{"old", "/health"}}}, "health"));
  EXPECT_FALSE(Names({.remap = {{"old", "new"}}}, "health"));
}

class PlayerTest : public testing::Test {
 protected:
  /// Begins to play for a reader that is there.
  void Play(PlayerOptions options) {
    options.name = "a.mcap";
    player.emplace(recording.reader(), options, bus);
    ASSERT_TRUE(player->AwaitReaders(kPatience));
    playing = std::jthread([this](const std::stop_token& stop) { player->Run(stop); });
    ASSERT_TRUE(reader.Joins());
  }

  Recording recording{testing::TempDir() + "/player-" + std::to_string(getpid())};
  dds::Bus bus{BusOptionsForTest("player")};
  Reader reader{"reader"};
  std::optional<Player> player;
  std::jthread playing;
};

TEST_F(PlayerTest, ItPausesSeeksAndChangesItsRateAsCommanded) {
  Play({.stay = true, .paused = true});
  ASSERT_TRUE(reader.UntilStatus([](const auto& status) { return status.paused(); }));
  const ReplayStatus first = reader.statuses.back();
  EXPECT_EQ(first.file(), "a.mcap");
  EXPECT_EQ(*dds::FromIdl(first.begin()), kBegin);
  EXPECT_EQ(*dds::FromIdl(first.end()), kBegin + kLength);
  EXPECT_EQ(NowIn(first), 0s);
  EXPECT_EQ(first.rate(), 1.0);

  reader.Send(REPLAY_SEEK, kBegin + 5s);
  ASSERT_TRUE(reader.Until([&] { return !reader.positions.empty(); }));
  EXPECT_THAT(reader.positions, testing::ElementsAre(testing::DoubleEq(4.9)))
      << "the last one before, since it stands";
  EXPECT_TRUE(reader.UntilStatus([](const auto& status) { return NowIn(status) == 5s; }));
  EXPECT_TRUE(reader.statuses.back().paused());

  reader.Send(REPLAY_RATE, {}, 50.0);
  ASSERT_TRUE(reader.UntilStatus([](const auto& status) { return status.rate() == 50.0; }));
  reader.Send(REPLAY_RESUME);
  ASSERT_TRUE(reader.UntilStatus([](const auto& status) { return NowIn(status) == kLength; }));
  ASSERT_TRUE(reader.Until([&] { return reader.positions.size() == 52; }));
  for (std::size_t k = 1; k < reader.positions.size(); ++k)
    EXPECT_DOUBLE_EQ(reader.positions[k], 5.0 + 0.1 * static_cast<double>(k - 1));

  reader.Send(REPLAY_PAUSE);
  ASSERT_TRUE(reader.UntilStatus([](const auto& status) { return status.paused(); }));
  reader.Send(REPLAY_SEEK, kBegin + 2s);
  ASSERT_TRUE(reader.Until([&] { return reader.positions.back() < 2.0; }));
  EXPECT_DOUBLE_EQ(reader.positions.back(), 1.9);
  EXPECT_EQ(reader.positions.size(), 53U);
  EXPECT_TRUE(reader.UntilStatus([](const auto& status) { return NowIn(status) == 2s; }));

  // Either end as others compute it.
  reader.Send(REPLAY_SEEK, kBegin + kLength + Duration(500));
  EXPECT_TRUE(reader.UntilStatus([](const auto& status) { return NowIn(status) == kLength; }));
  reader.Send(REPLAY_SEEK, kBegin - Duration(500));
  EXPECT_TRUE(reader.UntilStatus([](const auto& status) { return NowIn(status) == 0s; }));
}

TEST_F(PlayerTest, AtItsEndItStaysAndBeginsAgainWhenResumed) {
  Play({.rate = 100.0, .stay = true});
  ASSERT_TRUE(reader.UntilStatus([](const auto& status) { return status.paused(); }));
  EXPECT_EQ(NowIn(reader.statuses.back()), kLength);
  ASSERT_TRUE(reader.Until([&] { return !reader.positions.empty() && reader.positions.back() > 9.95; }));
  reader.positions.clear();
  reader.Send(REPLAY_RESUME);
  ASSERT_TRUE(reader.Until([&] { return !reader.positions.empty() && reader.positions.back() > 9.95; }));
  EXPECT_EQ(reader.positions.front(), 0.0);
}

TEST_F(PlayerTest, WithoutThatItEndsAndSaysSo) {
  Play({.rate = 100.0});
  ASSERT_TRUE(reader.UntilStatus([](const auto& status) { return status.paused(); }));
  EXPECT_EQ(NowIn(reader.statuses.back()), kLength);
  playing.join();
}

TEST_F(PlayerTest, WhatIsCommandedWhileItWaitsForReadersHoldsWhenItBegins) {
  player.emplace(recording.reader(), PlayerOptions{.name = "a.mcap", .stay = true}, bus);
  ASSERT_TRUE(player->AwaitReaders(kPatience));
  player->Pause();
  playing = std::jthread([this](const std::stop_token& stop) { player->Run(stop); });
  ASSERT_TRUE(reader.Joins());
  reader.Send(REPLAY_SEEK, kBegin + 5s);
  ASSERT_TRUE(reader.UntilStatus([](const auto& status) { return NowIn(status) == 5s; }));
  EXPECT_TRUE(reader.statuses.back().paused());
  ASSERT_TRUE(reader.Until([&] { return !reader.positions.empty(); }));
  EXPECT_THAT(reader.positions, testing::ElementsAre(testing::DoubleEq(4.9))) << "nothing was played";
}

TEST_F(PlayerTest, WhatMakesNoSenseIsRefusedWithItsReasonAndChangesNothing) {
  Play({.paused = true});
  ASSERT_TRUE(reader.UntilStatus([](const auto& status) { return status.paused(); }));
  struct Case {
    ReplayCommandKind kind;
    Time time;
    double rate;
    std::string sender;
    std::string reason;
  };
  const std::string rates = ", must be 0.001 to 1000";
  const std::vector<Case> cases = {
      {REPLAY_SEEK, kBegin + 11s, 0, "a",
       "the time is 11.000 s after the recording's beginning, must be 0 to 10.000 s"},
      {REPLAY_SEEK, kBegin - 1s, 0, "a",
       "the time is -1.000 s after the recording's beginning, must be 0 to 10.000 s"},
      {REPLAY_RATE, {}, 0, "a", "the rate is 0" + rates},
      {REPLAY_RATE, {}, -1, "a", "the rate is -1" + rates},
      {REPLAY_RATE, {}, std::numeric_limits<double>::infinity(), "a", "the rate is inf" + rates},
      {REPLAY_RATE, {}, std::numeric_limits<double>::quiet_NaN(), "a", "the rate is nan" + rates},
      {REPLAY_RESUME, {}, 0, "\x1b[2J", "the sender must be at most 64 characters of printable ASCII"},
      {REPLAY_RESUME,
       {},
       0,
       std::string(65, 'x'),
       "the sender must be at most 64 characters of printable ASCII"},
      {static_cast<ReplayCommandKind>(7), {}, 0, "a", "there is no command of kind 7"},
  };
  for (const Case& each : cases) {
    reader.Send(each.kind, each.time, each.rate, each.sender);
    EXPECT_TRUE(reader.UntilStatus([&](const auto& status) { return status.last_refusal() == each.reason; }))
        << each.reason << ", not " << reader.statuses.back().last_refusal();
  }
  const ReplayStatus status = reader.statuses.back();
  EXPECT_TRUE(status.paused());
  EXPECT_EQ(status.rate(), 1.0);
  EXPECT_EQ(NowIn(status), 0s);
  reader.Send(REPLAY_RATE, {}, 2.0);
  EXPECT_TRUE(reader.UntilStatus([](const auto& its) { return its.last_refusal().empty(); }));
  playing.request_stop();
  playing.join();
  EXPECT_EQ(bus.health().rejected(), cases.size());
}

TEST_F(PlayerTest, AfterEachSeekAReaderHoldsTheMapOfThatTimeAndLaterUpdatesFit) {
  Play({.stay = true, .paused = true});
  for (const Duration time : {Duration(6s), Duration(9s), Duration(2600ms), Duration(0s), Duration(5500ms)})
    reader.SeekTo(time, recording);
  reader.Send(REPLAY_RATE, {}, 20.0);
  reader.Send(REPLAY_RESUME);
  ASSERT_TRUE(reader.UntilStatus([](const auto& status) { return NowIn(status) == kLength; }));
  EXPECT_TRUE(reader.Until([&] { return reader.HoldsMap(recording.MapAt(kLength + 1s)); }));
  EXPECT_FALSE(reader.map.missing());
}

TEST_F(PlayerTest, AfterASeekReadersHoldStatesLogLinesAndTransformsOfThatTime) {
  Play({.stay = true, .paused = true});
  reader.SeekTo(7500ms, recording);
  EXPECT_TRUE(reader.Until([&] { return reader.activity == "7" && reader.lines.size() == 8; }));
  EXPECT_EQ(reader.lines.back(), "7");
  EXPECT_TRUE(reader.Until([&] { return reader.frames.size() == 2; }));
  reader.lines.clear();
  reader.SeekTo(3s, recording);
  EXPECT_TRUE(reader.Until([&] { return reader.activity == "2" && reader.lines.size() == 3; }));
  EXPECT_THAT(reader.frames, testing::UnorderedElementsAre("base_link", "camera"));
}

TEST_F(PlayerTest, BackAtTheVeryBeginningReadersHoldWhatIsSaidFirst) {
  Play({.stay = true, .paused = true});
  reader.SeekTo(7500ms, recording);
  ASSERT_TRUE(reader.Until([&] { return reader.activity == "7" && !reader.positions.empty(); }));
  reader.SeekTo(0s, recording);
  EXPECT_TRUE(reader.Until([&] { return reader.activity == "0" && reader.positions.back() == 0.0; }));
  Reader late("late");
  EXPECT_TRUE(late.Until([&] { return late.activity == "0" && !late.positions.empty(); }));
  EXPECT_EQ(late.positions.back(), 0.0);
}

TEST_F(PlayerTest, WhoJoinsLateIsGivenTheMapOnRequestAndTheStates) {
  Play({.rate = 20.0, .stay = true});
  ASSERT_TRUE(reader.UntilStatus([](const auto& status) { return NowIn(status) == kLength; }));
  {
    Reader late("late");
    EXPECT_TRUE(late.Until([&] { return late.HoldsMap(recording.MapAt(kLength + 1s)); }));
    EXPECT_TRUE(late.Until([&] { return late.activity == "10" && late.lines.size() == 11; }));
    EXPECT_TRUE(late.UntilStatus([](const auto& status) { return status.paused(); }));
    EXPECT_TRUE(late.Until([&] { return !late.positions.empty(); })) << "the last pose";
    EXPECT_DOUBLE_EQ(late.positions.back(), 10.0);
  }
  reader.SeekTo(4s, recording);
  Reader later("later");
  EXPECT_TRUE(later.Until([&] { return later.HoldsMap(recording.MapAt(4s)); }));
  EXPECT_TRUE(later.Until([&] { return later.activity == "3" && later.frames.size() == 2; }));
  EXPECT_TRUE(later.Until([&] { return !later.positions.empty(); }));
  EXPECT_DOUBLE_EQ(later.positions.back(), 3.9);
}

TEST_F(PlayerTest, WithAStartItBeginsAsAfterASeek) {
  Play({.start = 6.2, .paused = true});
  reader.requests.Write(reader.map.MakeRequest(Time{}, "reader"));
  EXPECT_TRUE(reader.Until([&] { return reader.HoldsMap(recording.MapAt(6200ms)); }));
  EXPECT_EQ(reader.map.session(), 42U) << "nobody has another state yet";
  EXPECT_TRUE(reader.Until([&] { return reader.activity == "6"; }));
}

TEST_F(PlayerTest, EachLoopBeginsWithoutAMapAndEndsWithAllOfIt) {
  Play({.rate = 10.0, .loop = true});
  int loops = 0;
  bool empty = true;
  EXPECT_TRUE(reader.Until([&] {
    if (!reader.map.has_map()) return false;
    const bool is_empty = reader.map.grid().block_count() == 0;
    loops += is_empty && !empty ? 1 : 0;
    empty = is_empty;
    return loops == 2;
  }));
  EXPECT_TRUE(reader.Until([&] { return reader.HoldsMap(recording.MapAt(kLength + 1s)); }));
  EXPECT_FALSE(reader.map.missing());
}

TEST_F(PlayerTest, ALoopThatARateWouldMakeTooShortIsRefused) {
  Play({.loop = true, .start = 9.0, .paused = true});
  ASSERT_TRUE(reader.UntilStatus([](const auto& status) { return status.paused(); }));
  reader.Send(REPLAY_RATE, {}, 101.0);
  EXPECT_TRUE(reader.UntilStatus([](const auto& status) {
    return status.last_refusal() ==
           "the rate is 101, must be 0.001 to 100, since a loop takes at least 10 ms";
  }));
  EXPECT_EQ(player->progress().rate, 1.0);
  player->SetRate(1000.0);
  EXPECT_EQ(player->progress().rate, 100.0) << "the nearest, as by keys";
}

/// A recording of a second with more messages than can be played in a millisecond, which it takes at the
/// fastest rate.
class LatePlayerTest : public testing::Test {
 protected:
  static constexpr int kMessages = 200'000;
  static constexpr Duration kPeriod = std::chrono::microseconds(5);

  LatePlayerTest() {
    const dds::TopicInfo topic = dds::InfoOf<topics::Clock>();
    RecordingFile out({.file = file_},
                      {{.topic = "/" + topic.name, .type = dds::Ros2TypeName(topic.type_name)}});
    const auto message = dds::Encode<topics::Clock>({});
    for (int k = 0; k < kMessages; ++k) {
      const Time at = kBegin + k * kPeriod;
      out.Write(0, 0, at, at, message);
    }
    out.Close();
    mapped.emplace(file_);
    recording.emplace(*McapReader::Open(mapped->bytes()));
    player.emplace(*recording, PlayerOptions{.rate = PlaybackClock::kFastest, .stay = true, .paused = true},
                   bus);
    playing = std::jthread([this](const std::stop_token& stop) { player->Run(stop); });
  }
  ~LatePlayerTest() override { std::filesystem::remove(file_); }
  /// Plays until its rate would have brought it to the end, and a message that late has been published.
  /// Between two messages the player does not know how late the next one is.
  void PlayUntilItIsLate() {
    player->Resume();
    AwaitNext();
    const auto begin = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() < begin + 2ms) std::this_thread::yield();
    AwaitNext();  // was perhaps published before
    AwaitNext();
  }
  /// Waits until another message is the next; not beyond the end.
  void AwaitNext() {
    const Time before = player->progress().now;
    while (player->progress().now == before && before < *recording->end()) std::this_thread::yield();
  }
  /// Ends the replay. Returns the log time of the message that would have come next.
  Time NextAtTheEnd() {
    playing.request_stop();
    playing.join();
    return kBegin + player->status().messages * kPeriod;
  }

  const std::filesystem::path file_ = testing::TempDir() + "/late-" + std::to_string(getpid()) + ".mcap";
  dds::Bus bus{BusOptionsForTest("player")};
  std::optional<MappedFile> mapped;
  std::optional<McapReader> recording;
  std::optional<Player> player;
  std::jthread playing;
};

TEST_F(LatePlayerTest, AnotherRateGoesOnFromWhatWasPublishedLast) {
  PlayUntilItIsLate();
  player->SetRate(PlaybackClock::kSlowest);
  const Time at = player->progress().now;
  EXPECT_LT(at, *recording->end());
  const Time next = NextAtTheEnd();
  EXPECT_GE(next, at);
  EXPECT_LE(next, at + kPeriod + 20ms) << "at this rate 20 s go by until then";
  EXPECT_GT(player->status().late_max_ms, 0.5) << "that it was late is not forgotten";
}

TEST_F(LatePlayerTest, APauseIsWhereItWasPublishedLast) {
  PlayUntilItIsLate();
  player->Pause();
  const Time at = player->progress().now;
  EXPECT_LT(at, *recording->end());
  const Time next = NextAtTheEnd();
  EXPECT_GE(next, at);
  EXPECT_LE(next, at + kPeriod) << "a message may have been under way";
}

}  // namespace
}  // namespace thalweg::recorder
