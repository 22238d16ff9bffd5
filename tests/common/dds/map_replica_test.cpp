#include "common/dds/map_replica.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <random>
#include <utility>

#include "common/dds/convert.h"
#include "common/dds/map_log.h"

namespace thalweg::dds {
namespace {

using thalweg_msgs::msg::MapBlock;
using thalweg_msgs::msg::MapUpdate;

constexpr double kVoxel = 0.1;
const Time kNow{std::chrono::seconds(12)};
const RigidTransform kPose = MakeTransform(RotationFromYawPitch(0.5, 0.1), {1.0, 2.0, 3.0});

void CopyInto(OccupancyGrid& to, const OccupancyGrid& from) {
  to.Clear();
  from.ForEachKnown([&](const VoxelIndex& i, float log_odds) { to.Set(i, log_odds); });
}

MeasuredShares SomeShares() {
  MeasuredShares shares;
  for (std::size_t k = 0; k < shares.of_255.size(); ++k)
    shares.of_255[k] = static_cast<std::uint8_t>(255 - k);
  return shares;
}

/// A mapper that changes voxels at random and remembers its map after each update.
class RandomMapper {
 public:
  explicit RandomMapper(std::mt19937& random) : random_(random) { Restart(false); }

  void Restart(bool keep_map) {
    if (!keep_map) grid_.Clear();
    log_ = MapLog(++session_, kVoxel);
    Remember();
  }
  MapUpdate Change() {
    std::uniform_int_distribution<std::int32_t> coordinate(-12,
                                                           // Across block boundaries, on both sides of 0
                                                           11);
    std::uniform_real_distribution<float> log_odds(-2.0F, 3.5F);
    for (int scan = 0; scan < 2; ++scan) {
      std::vector<VoxelChange> changes;
      for (int k = 0; k < 30; ++k) {
        const VoxelIndex i{coordinate(random_), coordinate(random_), coordinate(random_)};
        changes.push_back({i, k == 0 ? OccupancyGrid::kUnknown : log_odds(random_)});
        grid_.Set(i, changes.back().log_odds);
      }
      log_.Add(kNow, {.T_WC = kPose, .measured = SomeShares()}, changes);
    }
    MapUpdate update = log_.TakeUpdate();
    Remember();
    return update;
  }
  MapUpdate FullCopy() const { return log_.FullCopy(grid_); }
  const OccupancyGrid& grid() const { return grid_; }
  const MapLog& log() const { return log_; }
  const OccupancyGrid& MapAt(std::uint64_t session, std::uint64_t number) const {
    return history_.at({session, number});
  }

 private:
  void Remember() {
    OccupancyGrid& copy = history_.try_emplace({session_, log_.number()}, kVoxel).first->second;
    CopyInto(copy, grid_);
  }

  std::mt19937& random_;
  std::uint64_t session_ = 100;
  OccupancyGrid grid_{kVoxel};
  MapLog log_{1, kVoxel};
  std::map<std::pair<std::uint64_t, std::uint64_t>, OccupancyGrid> history_;
};

/// A reader that applies what arrives, and maintains a second grid from the reported changes alone.
struct Reader {
  MapReplica replica;
  OccupancyGrid from_changes{kVoxel};

  void Take(const MapUpdate& update) {
    const Result<std::optional<MapReplica::Applied>> applied = replica.Apply(update);
    ASSERT_TRUE(applied) << applied.error();
    if (!*applied) return;
    if ((*applied)->replaced) return CopyInto(from_changes, replica.grid());
    for (const VoxelChange& change : (*applied)->changes) from_changes.Set(change.voxel, change.log_odds);
  }
};

class MapReplicaOverABadNetwork : public testing::TestWithParam<int> {};

TEST_P(MapReplicaOverABadNetwork, IsExactWhateverIsLostRepeatedReorderedOrRestarted) {
  std::mt19937 random(static_cast<unsigned>(GetParam()));
  const auto chance = [&](int percent) { return std::uniform_int_distribution(0, 99)(random) < percent; };
  RandomMapper mapper(random);
  Reader reader;
  std::deque<MapUpdate> network;
  const auto send = [&](const MapUpdate& update) {
    if (chance(80)) network.push_back(update);  // otherwise lost
    if (chance(10)) network.push_back(update);  // repeated
  };
  for (int step = 0; step < 300; ++step) {
    if (chance(3)) mapper.Restart(chance(50));
    send(mapper.Change());
    if (reader.replica.missing() && chance(30)) send(mapper.FullCopy());
    while (!network.empty() && chance(70)) {
      const std::size_t next = chance(25) ? std::min<std::size_t>(network.size() - 1, 3) : 0;  // reordered
      reader.Take(network[next]);
      network.erase(network.begin() + static_cast<std::ptrdiff_t>(next));
      if (!reader.replica.has_map()) continue;
      // At all times it is one of the mapper's maps, never a mixture, and so is the grid built from the
      // changes.
      ASSERT_TRUE(
          reader.replica.grid().SameAs(mapper.MapAt(reader.replica.session(), reader.replica.number())));
      ASSERT_TRUE(reader.replica.grid().SameAs(reader.from_changes));
    }
  }
  for (const MapUpdate& update : network) reader.Take(update);
  reader.Take(mapper.Change());
  if (reader.replica.missing()) reader.Take(mapper.FullCopy());
  EXPECT_FALSE(reader.replica.missing()) << *reader.replica.missing();
  EXPECT_EQ(reader.replica.session(), mapper.log().session());
  EXPECT_EQ(reader.replica.number(), mapper.log().number());
  EXPECT_TRUE(reader.replica.grid().SameAs(mapper.grid()));
}

INSTANTIATE_TEST_SUITE_P(Seeds, MapReplicaOverABadNetwork, testing::Range(1, 13));

TEST(MapReplica, WantsAFullCopyFirstAndThenGoesOnFromIt) {
  std::mt19937 random(1);
  RandomMapper mapper(random);
  MapReplica replica;
  EXPECT_EQ(replica.missing(), "no map yet");
  const auto applied = replica.Apply(mapper.Change());
  ASSERT_TRUE(applied);
  EXPECT_FALSE(*applied);
  ASSERT_TRUE(replica.Apply(mapper.FullCopy()));
  EXPECT_FALSE(replica.missing());
  const auto next = replica.Apply(mapper.Change());
  ASSERT_TRUE(next && *next);
  EXPECT_FALSE((*next)->replaced);
  ASSERT_EQ((*next)->scans.size(), 2U);
  EXPECT_TRUE((*next)->scans[0].T_WC.isApprox(kPose, 1e-12));
  ASSERT_TRUE((*next)->scans[0].measured);
  EXPECT_EQ((*next)->scans[0].measured->of_255, SomeShares().of_255);
}

TEST(MapReplica, AsksWithWhatItHolds) {
  std::mt19937 random(2);
  RandomMapper mapper(random);
  MapReplica replica;
  mapper.Change();
  ASSERT_TRUE(replica.Apply(mapper.FullCopy()));
  mapper.Change();  // lost
  ASSERT_TRUE(replica.Apply(mapper.Change()));
  ASSERT_TRUE(replica.missing());
  const thalweg_msgs::msg::MapRequest request = replica.MakeRequest(kNow, "explorer");
  EXPECT_EQ(request.reader(), "explorer");
  EXPECT_EQ(request.session(), mapper.log().session());
  EXPECT_EQ(request.number(), 1U);
  EXPECT_EQ(request.reason(), "updates after 1 were lost");
}

TEST(MapReplica, IgnoresAFullCopyThatItDoesNotNeed) {
  std::mt19937 random(3);
  RandomMapper mapper(random);
  MapReplica replica;
  mapper.Change();
  ASSERT_TRUE(replica.Apply(mapper.FullCopy()));
  const auto again = replica.Apply(mapper.FullCopy());
  ASSERT_TRUE(again);
  EXPECT_FALSE(*again);
}

TEST(MapReplica, NoticesARestartedMapperAndTakesItsMap) {
  std::mt19937 random(4);
  RandomMapper mapper(random);
  MapReplica replica;
  mapper.Change();
  ASSERT_TRUE(replica.Apply(mapper.FullCopy()));
  mapper.Restart(true);
  ASSERT_TRUE(replica.Apply(mapper.Change()));
  EXPECT_EQ(replica.missing(), "the mapper was restarted");
  ASSERT_TRUE(replica.Apply(mapper.FullCopy()));
  EXPECT_FALSE(replica.missing());
  EXPECT_TRUE(replica.grid().SameAs(mapper.grid()));
}

TEST(MapReplica, FitsUpdatesOntoAFullCopyThatIsNewerThanItsNumber) {
  OccupancyGrid grid(kVoxel);
  MapLog log(5, kVoxel);
  MapReplica replica;
  const std::vector<VoxelChange> changes = {{{1, 2, 3}, 0.5F}, {{-9, 0, 0}, -0.4F}};
  for (const VoxelChange& change : changes) grid.Set(change.voxel, change.log_odds);
  log.Add(kNow, {.T_WC = kPose}, changes);
  ASSERT_TRUE(log.has_news());
  ASSERT_TRUE(replica.Apply(log.FullCopy(grid)));
  ASSERT_TRUE(replica.Apply(log.TakeUpdate()));
  EXPECT_FALSE(log.has_news());
  EXPECT_FALSE(replica.missing());
  EXPECT_TRUE(replica.grid().SameAs(grid));
}

/// A reader that has the mapper's map, and how it fares with the mapper's messages after a false one.
class AfterAFalseUpdate : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(replica_.Apply(mapper_.FullCopy()));
    ASSERT_TRUE(replica_.Apply(mapper_.Change()));
  }
  MapUpdate False(bool full, std::uint64_t ahead) {
    MapUpdate update;
    update.header(MakeHeader(kNow, kMapFrame));
    update.session(mapper_.log().session());
    update.number(mapper_.log().number() + ahead);
    update.full(full);
    update.voxel_size_m(kVoxel);
    return update;
  }
  /// Lets the mapper make ten updates and answer requests; the reader must then have its map.
  void ExpectThatItRecovers() {
    for (int k = 0; k < 10; ++k) {
      ASSERT_TRUE(replica_.Apply(mapper_.Change()));
      if (replica_.missing()) {
        ASSERT_TRUE(replica_.Apply(mapper_.FullCopy()));
      }
    }
    EXPECT_FALSE(replica_.missing());
    EXPECT_EQ(replica_.number(), mapper_.log().number());
    EXPECT_TRUE(replica_.grid().SameAs(mapper_.grid()));
  }

  std::mt19937 random_{6};
  RandomMapper mapper_{random_};
  MapReplica replica_;
};

TEST_F(AfterAFalseUpdate, ANumberFarAheadIsForgotten) {
  ASSERT_TRUE(replica_.Apply(False(false, 1'000'000'000)));
  EXPECT_TRUE(replica_.missing());
  ExpectThatItRecovers();
}

TEST_F(AfterAFalseUpdate, AnEmptyFullCopyFarAheadIsReplaced) {
  ASSERT_TRUE(replica_.Apply(False(true, 1'000'000'000)));
  ExpectThatItRecovers();
}

TEST(MapLog, KeepsTheLastOfSeveralValuesOfAVoxel) {
  const std::vector<VoxelChange> changes = {{{0, 0, 0}, 0.5F}, {{8, 0, 0}, 1.0F}, {{0, 0, 0}, -0.4F}};
  const std::vector<MapBlock> blocks = BlocksOf(changes);
  ASSERT_EQ(blocks.size(), 2U);
  EXPECT_EQ(blocks[0].log_odds(), std::vector<float>{-0.4F});
  EXPECT_EQ(blocks[1].x(), 1);
}

TEST(MapLog, SessionsAreNotZeroAndDiffer) {
  const std::uint64_t session = MapLog::MakeSession();
  EXPECT_NE(session, 0U);
  EXPECT_NE(session, MapLog::MakeSession());
}

struct UpdateLie {
  const char* what;
  std::function<void(MapUpdate&)> tell;
  const char* named;  ///< What the error must name.
};

TEST(MapReplica, RefusesUpdatesThatLieAndKeepsItsMap) {
  constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
  constexpr float kEndless = std::numeric_limits<float>::infinity();
  const std::vector<UpdateLie> lies = {
      {"no session", [](MapUpdate& u) { u.session(0); }, "session"},
      {"number 0", [](MapUpdate& u) { u.number(0); }, "number"},
      {"voxel size 0", [](MapUpdate& u) { u.voxel_size_m(0.0); }, "voxel_size_m"},
      {"negative voxel size", [](MapUpdate& u) { u.voxel_size_m(-0.1); }, "voxel_size_m"},
      {"voxel size NaN", [=](MapUpdate& u) { u.voxel_size_m(kNoNumber); }, "voxel_size_m"},
      {"infinite voxel size", [=](MapUpdate& u) { u.voxel_size_m(kEndless); }, "voxel_size_m"},
      {"other voxel size", [](MapUpdate& u) { u.voxel_size_m(0.2); }, "voxel_size_m"},
      {"other frame", [](MapUpdate& u) { u.header().frame_id("moon"); }, "moon"},
      {"bad stamp", [](MapUpdate& u) { u.header().stamp().nanosec(4'000'000'000); }, "nanosec"},
      {"more bits than values", [](MapUpdate& u) { u.blocks()[0].mask()[63] = 0xFF; }, "mask"},
      {"more values than bits", [](MapUpdate& u) { u.blocks()[0].log_odds().push_back(0.0F); }, "mask"},
      {"infinite value", [=](MapUpdate& u) { u.blocks()[0].log_odds()[0] = kEndless; }, "infinite"},
      {"index too large", [](MapUpdate& u) { u.blocks()[0].x(4096); }, "4096"},
      {"index too small", [](MapUpdate& u) { u.blocks()[0].z(-2'000'000'000); }, "-2000000000"},
      {"block twice", [](MapUpdate& u) { u.blocks().push_back(u.blocks()[0]); }, "twice"},
      {"scan pose NaN", [=](MapUpdate& u) { u.scans()[0].map_from_camera().position().x(kNoNumber); },
       "position"},
      {"one share too few", [](MapUpdate& u) { u.scans()[1].measured().pop_back(); }, "measured is 63"},
      {"one share too many", [](MapUpdate& u) { u.scans()[1].measured().push_back(0); }, "measured is 65"},
      {"scans in a full copy", [](MapUpdate& u) { u.full(true); }, "scans"},
  };
  std::mt19937 random(5);
  RandomMapper mapper(random);
  MapReplica replica;
  mapper.Change();
  ASSERT_TRUE(replica.Apply(mapper.FullCopy()));
  const MapUpdate honest = mapper.Change();
  for (const UpdateLie& lie : lies) {
    MapUpdate update = honest;
    lie.tell(update);
    const auto result = replica.Apply(update);
    ASSERT_FALSE(result) << lie.what;
    EXPECT_NE(result.error().find(lie.named), std::string::npos) << lie.what << ": " << result.error();
    ASSERT_TRUE(replica.grid().SameAs(mapper.MapAt(mapper.log().session(), 1))) << lie.what;
    ASSERT_FALSE(replica.missing()) << lie.what;
  }
  ASSERT_TRUE(replica.Apply(honest));
  EXPECT_TRUE(replica.grid().SameAs(mapper.grid()));
}

/// An update that lists blocks of one voxel each, from `first` on.
MapUpdate ThinBlocks(std::size_t first, std::size_t count) {
  MapUpdate update;
  update.header(MakeHeader(kNow, kMapFrame));
  update.session(7);
  update.number(1);
  update.voxel_size_m(kVoxel);
  update.blocks().resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    MapBlock& block = update.blocks()[k];
    const auto n = static_cast<std::int32_t>(first + k);
    block.x(n % 1000);
    block.y(n / 1000);
    block.mask()[0] = 1;
    block.log_odds({1.0F});
  }
  return update;
}

TEST(MapReplica, RefusesAMapOfMoreBlocksThanAReaderHolds) {
  MapUpdate copy = ThinBlocks(0, MapReplica::kMostBlocks + 1);
  copy.full(true);
  MapReplica replica;
  const auto refused = replica.Apply(copy);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("131073 blocks"), std::string::npos) << refused.error();
  EXPECT_FALSE(replica.has_map());

  copy.blocks().resize(3);
  ASSERT_TRUE(replica.Apply(copy));
  MapUpdate change = ThinBlocks(2, MapReplica::kMostBlocks - 1);  // of which it has one already
  change.number(2);
  const auto too_many = replica.Apply(change);
  ASSERT_FALSE(too_many);
  EXPECT_EQ(replica.grid().block_count(), 3U);
  change.blocks().resize(100);
  ASSERT_TRUE(replica.Apply(change));
  EXPECT_EQ(replica.grid().block_count(), 102U);
}

}  // namespace
}  // namespace thalweg::dds
