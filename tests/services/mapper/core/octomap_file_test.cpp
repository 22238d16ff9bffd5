#include "services/mapper/core/octomap_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <cmath>
#include <cstring>
#include <random>
#include <sstream>
#include <string>

namespace thalweg::mapper {
namespace {

using testing::HasSubstr;

constexpr std::size_t kMostBlocks = 1U << 14U;
constexpr double kVoxelSize = 0.05;

Bytes BytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string ErrorOfFile(const std::string& text) {
  const auto map = DecodeOctomap(BytesOf(text), kMostBlocks);
  return map ? "" : map.error();
}

octomap::OcTreeKey TreeKeyOf(const VoxelIndex& i) {
  const auto key = [](std::int32_t v) { return static_cast<octomap::key_type>(v + 32768); };
  return {key(i.x), key(i.y), key(i.z)};
}

/// A tree as OctoMap builds it from clouds, pruned, on both sides of the origin.
octomap::OcTree RandomTree(unsigned seed) {
  octomap::OcTree tree(kVoxelSize);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-2.0F, 2.0F);
  octomap::Pointcloud cloud;
  for (int k = 0; k < 300; ++k) cloud.push_back(coordinate(random), coordinate(random), coordinate(random));
  for (int scan = 0; scan < 6; ++scan) tree.insertPointCloud(cloud, octomap::point3d(0.02F, 0.01F, 0.03F));
  tree.prune();
  return tree;
}

/// Expects each leaf of the tree in the map, and nothing else. `log_odds` of a leaf is what the map must
/// have.
template <class LogOdds>
void ExpectSame(octomap::OcTree& tree, const OccupancyGrid& grid, const LogOdds& log_odds) {
  EXPECT_EQ(grid.voxel_size(), tree.getResolution());
  std::size_t known = 0;
  grid.ForEachKnown([&](const VoxelIndex& voxel, float value) {
    const octomap::OcTreeNode* node = tree.search(TreeKeyOf(voxel));
    ASSERT_NE(node, nullptr);
    ASSERT_EQ(value, log_odds(tree, *node));
    ++known;
  });
  tree.expand();
  EXPECT_EQ(known, tree.getNumLeafNodes());
}

class OctomapFile : public testing::TestWithParam<unsigned> {};

TEST_P(OctomapFile, HasTheLogOddsThatOctomapWrote) {
  octomap::OcTree tree = RandomTree(GetParam());
  std::stringstream file;
  ASSERT_TRUE(tree.write(file));
  const auto map = DecodeOctomap(BytesOf(file.str()), kMostBlocks);
  ASSERT_TRUE(map) << map.error();
  ExpectSame(tree, map->grid, [](const auto&, const auto& node) { return node.getLogOdds(); });
}

TEST_P(OctomapFile, HasTheLimitsForWhatOctomapWroteAsFreeOrOccupied) {
  octomap::OcTree tree = RandomTree(GetParam());
  std::stringstream file;
  ASSERT_TRUE(tree.writeBinaryConst(file));
  const auto map = DecodeOctomap(BytesOf(file.str()), kMostBlocks);
  ASSERT_TRUE(map) << map.error();
  ExpectSame(tree, map->grid, [](const auto& whole, const auto& node) {
    return whole.isNodeOccupied(node) ? kOccupiedOfBt : kFreeOfBt;
  });
}

TEST_P(OctomapFile, IsRefusedWhereverItIsCutOff) {
  octomap::OcTree tree = RandomTree(GetParam());
  std::stringstream file;
  ASSERT_TRUE(tree.write(file));
  const std::string whole = file.str();
  std::mt19937 random(GetParam());
  for (int k = 0; k < 200; ++k) {
    const std::size_t length = std::uniform_int_distribution<std::size_t>(0, whole.size() - 1)(random);
    EXPECT_NE(ErrorOfFile(whole.substr(0, length)), "") << length << " of " << whole.size();
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, OctomapFile, testing::Range(1U, 5U));

TEST(OctomapFileColors, AreThoseOfAColorOcTree) {
  octomap::ColorOcTree tree(kVoxelSize);
  tree.setNodeValue(TreeKeyOf({1, 2, 3}), 1.5F);
  tree.setNodeColor(TreeKeyOf({1, 2, 3}), 10, 20, 30);
  tree.setNodeValue(TreeKeyOf({-9, 2, 3}), 1.0F);
  tree.setNodeValue(TreeKeyOf({4, 2, 3}), -1.0F);
  std::stringstream file;
  ASSERT_TRUE(tree.write(file));
  const auto map = DecodeOctomap(BytesOf(file.str()), kMostBlocks);
  ASSERT_TRUE(map) << map.error();
  EXPECT_EQ(map->grid.LogOdds({1, 2, 3}), 1.5F);
  EXPECT_EQ(map->grid.LogOdds({-9, 2, 3}), 1.0F);
  EXPECT_EQ(map->grid.LogOdds({4, 2, 3}), -1.0F);
  EXPECT_EQ(map->colors.At({1, 2, 3}), (Rgb{10, 20, 30}));
  EXPECT_EQ(map->colors.At({-9, 2, 3}), std::nullopt);
}

TEST(OctomapFileOfAnEmptyTree, IsAnEmptyMap) {
  octomap::OcTree tree(kVoxelSize);
  std::stringstream file;
  ASSERT_TRUE(tree.write(file));
  const auto map = DecodeOctomap(BytesOf(file.str()), kMostBlocks);
  ASSERT_TRUE(map) << map.error();
  EXPECT_EQ(map->grid.block_count(), 0U);
}

std::string FileOf(const std::string& head, const std::string& data) {
  return "# Octomap OcTree file\n# a comment\n" + head + "data\n" + data;
}
const std::string kTreeHead = "id OcTree\nsize 9\nres 0.1\n";

std::string NodeOf(float log_odds, unsigned char children) {
  std::string node(5, '\0');
  std::memcpy(node.data(), &log_odds, sizeof(log_odds));
  node[4] = static_cast<char>(children);
  return node;
}

TEST(OctomapFileErrors, NameWhatIsWrongAndWhere) {
  EXPECT_THAT(ErrorOfFile(""), HasSubstr("is no file of OctoMap"));
  EXPECT_THAT(ErrorOfFile("ply\n"), HasSubstr("is no file of OctoMap"));
  EXPECT_THAT(ErrorOfFile("# Octomap OcTree file\nid OcTree\n"), HasSubstr("ends before its line \"data\""));
  EXPECT_THAT(ErrorOfFile(FileOf("size 1\nres 0.1\n", "")), HasSubstr("no line \"id\""));
  EXPECT_THAT(ErrorOfFile(FileOf("id OcTree\nsize 1\n", "")), HasSubstr("no line \"res\""));
  for (const std::string res : {"0", "-1", "nan", "inf", "x", ""}) {
    EXPECT_THAT(ErrorOfFile(FileOf("id OcTree\nsize 1\nres " + res + "\n", "")), HasSubstr("res is " + res));
  }
  EXPECT_THAT(ErrorOfFile(FileOf("id SemanticOcTree\nres 0.1\n", "")), HasSubstr("holds a SemanticOcTree"));
  EXPECT_THAT(ErrorOfFile(FileOf(kTreeHead, NodeOf(1.0F, 1))), HasSubstr("is cut off, at byte"));
  EXPECT_THAT(ErrorOfFile(FileOf(kTreeHead, NodeOf(NAN, 0))), HasSubstr("log-odds are no number"));
}

TEST(OctomapFileErrors, BoundDepthAndSize) {
  std::string chain;
  for (int k = 0; k < 40; ++k) chain += NodeOf(1.0F, 1);
  EXPECT_THAT(ErrorOfFile(FileOf(kTreeHead, chain)), HasSubstr("has nodes below its voxels"));
  EXPECT_THAT(ErrorOfFile(FileOf(kTreeHead, NodeOf(1.0F, 0))), HasSubstr("has more than 16384 blocks"));
}

}  // namespace
}  // namespace thalweg::mapper
