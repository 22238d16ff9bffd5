#include "services/cli/report/run_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "common/voxel/for_each_voxel.h"
#include "services/cli/report/encoding.h"
#include "services/cli/report/packed_map.h"

namespace thalweg::cli {
namespace {

using testing::HasSubstr;

constexpr std::string_view kTemplate =
    "<html><script type=\"application/json\">@RUN_DATA@</script><script>draw()</script></html>";

std::vector<std::uint8_t> FromBase64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> held & 255U));
  }
  return bytes;
}

std::vector<std::uint8_t> Inflated(const std::string& base64, std::size_t most) {
  const std::vector<std::uint8_t> deflated = FromBase64(base64);
  std::vector<std::uint8_t> bytes(most);
  uLongf size = most;
  EXPECT_EQ(uncompress(bytes.data(), &size, deflated.data(), deflated.size()), Z_OK);
  bytes.resize(size);
  return bytes;
}

/// The data of a page, read as a browser does: up to the end of the script element.
nlohmann::json DataOf(const std::string& page) {
  const std::size_t begin = page.find("json\">") + 6;
  return nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

RunRecord AShortRun() {
  RunRecord record;
  record.scenario = "room";
  record.duration = 10.0;
  for (int n = 0; n <= 20; ++n) {
    record.trajectory.push_back({Time{} + FromSeconds(0.5 * n),
                                 MakeTransform(RotationFromYawPitch(0.1 * n, 0.0), {0.1 * n, 2.0, 1.2})});
    ProgressSample sample;
    sample.time = 0.5 * n;
    sample.distance = 0.1 * n;
    record.progress.push_back(sample);
  }
  record.decisions = {{.number = 1,
                       .time = 2.5,
                       .purpose = "going 2 m",
                       .target_W = Eigen::Vector3d(1, 2, 3),
                       .length = 2.0,
                       .interruption = "path blocked"}};
  record.frontiers = {{Eigen::Vector3d(4, 5, 6), 12, 2, "seen in vain"}};
  record.services = {{.name = "mapper",
                      .host = "box",
                      .processes = 2,
                      .uptime = 9.0,
                      .rejected = 3,
                      .dropped = 4,
                      .timings = {{"integration", 7, 1.0, 2.0, 3.0}}}};
  record.scenario_text = "explorer { strategy: \"flow\" }";
  return record;
}

TEST(RunPage, HoldsWhatIsKnownOfTheRun) {
  const nlohmann::json data = DataOf(RunPage(kTemplate, AShortRun(), nullptr, CoverageTally()));
  EXPECT_EQ(data["report"]["scenario"], "room");
  EXPECT_EQ(data["progress"]["t_s"].size(), 21U);
  EXPECT_TRUE(data["progress"]["coverage"][0].is_null());
  EXPECT_EQ(data["decisions"][0]["purpose"], "going 2 m");
  EXPECT_EQ(data["decisions"][0]["target"], nlohmann::json({1.0, 2.0, 3.0}));
  EXPECT_EQ(data["decisions"][0]["interruption"], "path blocked");
  EXPECT_EQ(data["frontiers"][0]["reason"], "seen in vain");
  EXPECT_EQ(data["services"][0]["processes"], 2);
  EXPECT_EQ(data["services"][0]["timings"][0]["p95_ms"], 2.0);
  EXPECT_EQ(data["scenario_text"], "explorer { strategy: \"flow\" }");
  EXPECT_TRUE(data["map"].is_null());
}

TEST(RunPage, ThePathComesBackToAMillimeter) {
  const RunRecord record = AShortRun();
  const nlohmann::json path = DataOf(RunPage(kTemplate, record, nullptr, CoverageTally()))["path"];
  ASSERT_EQ(path["poses"], 21);
  const std::vector<std::uint8_t> bytes = Inflated(path["data"], 1 << 20);
  ASSERT_EQ(bytes.size(), 21U * 8 * sizeof(float));
  for (std::size_t n = 0; n < 21; ++n) {
    float pose[8];
    std::memcpy(pose, bytes.data() + n * sizeof(pose), sizeof(pose));
    EXPECT_NEAR(pose[0], 0.5 * static_cast<double>(n), 1e-3);
    const Eigen::Vector3d p(pose[1], pose[2], pose[3]);
    EXPECT_LT((p - record.trajectory[n].T.translation()).norm(), 1e-3);
    const Eigen::Quaterniond q(pose[7], pose[4], pose[5], pose[6]);
    EXPECT_LT(q.angularDistance(Eigen::Quaterniond(record.trajectory[n].T.linear())), 1e-3);
  }
}

TEST(RunPage, NoTextOfTheRunIsMarkup) {
  const std::string evil = "</script><script>alert(1)</script><!--&amp;\xFF\u2028";
  RunRecord record = AShortRun();
  record.title = record.scenario = record.strategy = record.stop_reason = record.stop_details = evil;
  record.scenario_text = evil;
  record.warnings = {evil};
  record.decisions[0].purpose = record.decisions[0].interruption = evil;
  record.frontiers[0].reason = evil;
  record.services[0].name = record.services[0].host = record.services[0].timings[0].name = evil;
  record.rejected = {{evil, evil, 1, evil}};
  record.set_aside = {{evil, 1, 1}};
  record.planning = {{evil, 1, 1.0, 1.0, 1.0}};
  const std::string page = RunPage(kTemplate, record, nullptr, CoverageTally());
  const std::size_t begin = page.find("json\">") + 6;
  const std::size_t end = page.find("</script><script>draw()");
  ASSERT_NE(end, std::string::npos);
  EXPECT_EQ(page.substr(begin, end - begin).find_first_of("<>&"), std::string::npos);
  EXPECT_EQ(DataOf(page)["title"], "</script><script>alert(1)</script><!--&amp;\uFFFD\u2028");
}

TEST(RunPage, NumbersThatAreNotFiniteAreNull) {
  RunRecord record = AShortRun();
  record.decisions[0].length = std::nan("");
  record.progress[0].planning_ms = std::numeric_limits<double>::infinity();
  const nlohmann::json data = DataOf(RunPage(kTemplate, record, nullptr, CoverageTally()));
  EXPECT_TRUE(data["decisions"][0]["length_m"].is_null());
  EXPECT_TRUE(data["progress"]["planning_ms"][0].is_null());
}

TEST(RunPage, ATemplateWithoutAPlaceForDataIsRefused) {
  EXPECT_THROW(RunPage("<html></html>", AShortRun(), nullptr, CoverageTally()), std::invalid_argument);
}

/// Reads a packed map as the page does. @return For each occupied voxel when it became known.
std::map<std::array<int, 3>, int> Unpacked(const std::vector<std::uint8_t>& bytes, std::size_t blocks) {
  std::map<std::array<int, 3>, int> known_at;
  std::size_t next = 70 * blocks;
  for (std::size_t n = 0; n < blocks; ++n) {
    std::int16_t at[3];
    std::memcpy(at, bytes.data() + n * sizeof(at), sizeof(at));
    for (int k = 0; k < 512; ++k) {
      if ((bytes[6 * blocks + 64 * n + static_cast<std::size_t>(k / 8)] >> (k % 8) & 1) == 0) continue;
      known_at[{at[0] * 8 + k % 8, at[1] * 8 + k / 8 % 8, at[2] * 8 + k / 64}] = bytes.at(next++);
    }
  }
  EXPECT_EQ(next, bytes.size());
  return known_at;
}

/// Occupied where a seeded coin says so, free elsewhere; half is seen at 2 s, the rest at 8 s of 10 s.
struct RandomMap {
  OccupancyGrid grid{0.1};
  CoverageTally tally;
  std::map<std::array<int, 3>, int> expected;

  RandomMap() {
    std::mt19937 random(5);
    const auto see = [&](const VoxelBox& box, double time) {
      ForEachVoxel(box, [&](const VoxelIndex& i) {
        const bool occupied = random() % 4 == 0;
        grid.Set(i, occupied ? 1.0F : -1.0F);
        tally.Add(i);
        if (occupied) expected[{i.x, i.y, i.z}] = static_cast<int>(std::lround(255.0 * time / 10.0));
      });
      ProgressSample sample;
      sample.time = time;
      tally.Sample(sample, 0.001);
    };
    see({{-20, -9, -3}, {0, 9, 12}}, 2.0);
    see({{0, -9, -3}, {20, 9, 12}}, 8.0);
  }
};

TEST(PackedMap, HoldsEveryOccupiedVoxelAndWhenItBecameKnown) {
  const RandomMap map;
  const PackedMap packed = Pack(map.grid, map.tally, 10.0, 0);
  EXPECT_EQ(packed.occupied, map.expected.size());
  EXPECT_EQ(Unpacked(packed.bytes, packed.blocks), map.expected);
}

TEST(PackedMap, ACoarseVoxelIsOccupiedIfAnyPartIs) {
  const RandomMap map;
  const PackedMap packed = Pack(map.grid, map.tally, 10.0, 2);
  EXPECT_DOUBLE_EQ(packed.voxel_size, 0.4);
  std::set<std::array<int, 3>> expected;
  for (const auto& [i, time] : map.expected) expected.insert({i[0] >> 2, i[1] >> 2, i[2] >> 2});
  std::set<std::array<int, 3>> found;
  for (const auto& [i, time] : Unpacked(packed.bytes, packed.blocks)) found.insert(i);
  EXPECT_EQ(found, expected);
}

TEST(PackedMap, VoxelsTooFarForAViewerAreCountedInstead) {
  OccupancyGrid grid(0.1);
  grid.Set({1, 1, 1}, 1.0F);
  grid.Set({8 * kFarthestBlock, 0, 0}, 1.0F);
  grid.Set({0, 0, -8 * kFarthestBlock - 1}, 1.0F);
  const PackedMap packed = Pack(grid, CoverageTally(), 10.0, 0);
  EXPECT_EQ(packed.occupied, 1U);
  EXPECT_EQ(packed.left_out, 2U);
}

TEST(RunPage, StaysWithinItsLimitForALargeRunWithTextsOfFullLength) {
  RunRecord record = AShortRun();
  record.progress.resize(100'000, record.progress.back());
  record.trajectory.resize(500'000, record.trajectory.back());
  const std::string text(600, '<');  // six octets each
  record.decisions.resize(2000, record.decisions.front());
  for (Decision& decision : record.decisions) decision.purpose = text.substr(0, 200);
  // Noise compresses worst: 8 million voxels, a third of them occupied.
  OccupancyGrid grid(0.1);
  std::mt19937 random(7);
  ForEachVoxel({{0, 0, 0}, {400, 200, 100}},
               [&](const VoxelIndex& i) { grid.Set(i, random() % 3 == 0 ? 1.0F : -1.0F); });
  const std::string page = RunPage(kTemplate, record, &grid, CoverageTally());
  EXPECT_LE(page.size(), kMostPageBytes);
  const nlohmann::json data = DataOf(page);
  EXPECT_LE(data["progress"]["t_s"].size(), 2000U);
  EXPECT_LE(data["path"]["poses"], 4000);
  EXPECT_LE(data["map"]["occupied"], kMostOccupiedVoxels);
  EXPECT_GT(data["map"]["voxel_size_m"], data["map"]["true_voxel_size_m"]);
}

TEST(RunPage, AMapThatDoesNotFitBesideTheRestIsDrawnCoarser) {
  OccupancyGrid grid(0.1);
  std::mt19937 random(7);
  ForEachVoxel({{0, 0, 0}, {100, 100, 100}},
               [&](const VoxelIndex& i) { grid.Set(i, random() % 3 == 0 ? 1.0F : -1.0F); });
  const auto map_beside = [&](std::size_t others) {
    const std::string page =
        RunPage(std::string(kTemplate) + std::string(others, ' '), AShortRun(), &grid, CoverageTally());
    EXPECT_LE(page.size(), kMostPageBytes);
    return DataOf(page)["map"];
  };
  EXPECT_DOUBLE_EQ(map_beside(1'000'000)["voxel_size_m"], 0.1);
  EXPECT_DOUBLE_EQ(map_beside(4'950'000)["voxel_size_m"], 0.2);
}

}  // namespace
}  // namespace thalweg::cli
