#include "services/mapper/adapter/map_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <sstream>

#include "tests/services/mapper/adapter/example_map.h"

namespace thalweg::mapper {
namespace {

using test::ExampleColors;
using test::ExampleMap;
using test::TestFolder;

const octomap::OcTreeNode* Find(const octomap::OcTree& tree, const VoxelIndex& i) {
  const auto key = [](std::int32_t v) { return static_cast<octomap::key_type>(v + 32768); };
  return tree.search(octomap::OcTreeKey(key(i.x), key(i.y), key(i.z)));
}

std::size_t KnownVoxels(const OccupancyGrid& grid) {
  std::size_t known = 0;
  grid.ForEachKnown([&known](const VoxelIndex&, float) { ++known; });
  return known;
}

/// Expects every voxel of the grid to have the same log-odds in the tree, and no other voxel to be known
/// there.
void ExpectSameLogOdds(octomap::OcTree& tree, const OccupancyGrid& grid) {
  EXPECT_EQ(tree.getResolution(), grid.voxel_size());
  std::size_t different = 0;
  grid.ForEachKnown([&](const VoxelIndex& i, float log_odds) {
    const octomap::OcTreeNode* node = Find(tree, i);
    different += node == nullptr || node->getLogOdds() != log_odds ? 1 : 0;
  });
  EXPECT_EQ(different, 0u);
  tree.expand();
  EXPECT_EQ(tree.getNumLeafNodes(), KnownVoxels(grid));
}

TEST(MapFiles, OctomapReadsTheOtBackBitByBit) {
  const TestFolder folder;
  const OccupancyMap map = ExampleMap();
  SaveMap(map.grid(), {}, folder.path());
  const std::unique_ptr<octomap::AbstractOcTree> read(
      octomap::AbstractOcTree::read((folder.path() / "map.ot").string()));
  auto* tree = dynamic_cast<octomap::OcTree*>(read.get());
  ASSERT_NE(tree, nullptr);
  ExpectSameLogOdds(*tree, map.grid());
}

TEST(MapFiles, OctomapReadsFreeAndOccupiedFromTheBt) {
  const TestFolder folder;
  const OccupancyMap map = ExampleMap();
  SaveMap(map.grid(), {}, folder.path());
  octomap::OcTree tree((folder.path() / "map.bt").string());
  EXPECT_EQ(tree.getResolution(), 0.1);
  std::size_t different = 0;
  map.grid().ForEachKnown([&](const VoxelIndex& i, float log_odds) {
    const octomap::OcTreeNode* node = Find(tree, i);
    different += node == nullptr || tree.isNodeOccupied(node) != (log_odds >= 0.0F) ? 1 : 0;
  });
  EXPECT_EQ(different, 0u);
  tree.expand();
  EXPECT_EQ(tree.getNumLeafNodes(), KnownVoxels(map.grid()));
}

TEST(MapFiles, AreWhatOctomapWritesItselfWithoutItsRemarks) {
  const OccupancyMap map = ExampleMap();
  const std::unique_ptr<octomap::OcTree> tree = ToOcTree(map.grid());
  std::ostringstream ot;
  tree->write(ot);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  EXPECT_EQ(EncodeOt(*tree), ot.str());
  const std::string bt = EncodeBt(*tree);
  EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");
  std::ostringstream its_bt;
  tree->writeBinary(its_bt);
  EXPECT_EQ(bt, its_bt.str());
}

TEST(MapFiles, AnEmptyMapIsWrittenAndReadBack) {
  const TestFolder folder;
  SaveMap(OccupancyGrid(0.1), {}, folder.path());
  octomap::OcTree tree((folder.path() / "map.bt").string());
  EXPECT_EQ(tree.size(), 0u);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "map.ot"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "map.ply"));
}

// Decodes as octomap_msgs::fullMsgToMap does.
TEST(MapFiles, TheMessageIsReadAsOctomapMsgsDoes) {
  const OccupancyMap map = ExampleMap();
  const Time stamp{FromSeconds(12.5)};
  const octomap_msgs::msg::Octomap message = ToIdl(stamp, *ToOcTree(map.grid()));
  EXPECT_EQ(message.header().frame_id(), "map");
  EXPECT_EQ(message.header().stamp().sec(), 12);
  EXPECT_EQ(message.id(), "OcTree");
  EXPECT_FALSE(message.binary());
  std::stringstream data;
  data.write(reinterpret_cast<const char*>(message.data().data()),
             static_cast<std::streamsize>(message.data().size()));
  octomap::OcTree tree(message.resolution());
  tree.readData(data);
  ExpectSameLogOdds(tree, map.grid());
}

/// The contents of one of our PLY files, read as its own header describes them.
struct Ply {
  struct Vertex {
    Eigen::Vector3f p_W;
    Rgb color;
  };
  std::vector<Vertex> vertices;
  std::vector<std::array<std::int32_t, 4>> faces;
};

Ply ReadPly(const std::string& bytes) {
  std::istringstream in(bytes);
  Ply ply;
  std::string line;
  std::size_t vertices = 0;
  std::size_t faces = 0;
  while (std::getline(in, line) && line != "end_header") {
    std::sscanf(line.c_str(), "element vertex %zu", &vertices);
    std::sscanf(line.c_str(), "element face %zu", &faces);
  }
  const auto get = [&in](auto& value) { in.read(reinterpret_cast<char*>(&value), sizeof(value)); };
  for (std::size_t i = 0; i < vertices; ++i) {
    Ply::Vertex vertex;
    for (float& value : vertex.p_W) get(value);
    get(vertex.color);
    ply.vertices.push_back(vertex);
  }
  for (std::size_t i = 0; i < faces; ++i) {
    std::uint8_t corners = 0;
    get(corners);
    EXPECT_EQ(corners, 4);
    get(ply.faces.emplace_back());
  }
  EXPECT_TRUE(in.good());
  EXPECT_EQ(in.peek(), std::istringstream::traits_type::eof());
  return ply;
}

TEST(MapFiles, PlyShowsAVoxelAsACubeInItsColor) {
  OccupancyGrid grid(0.5);
  grid.Set({-2, 0, 3}, 1.0F);
  grid.Set({4, 4, 4}, -1.0F);
  VoxelColors colors;
  colors.Add({-2, 0, 3}, {10, 200, 30});
  const std::string bytes = EncodePly(grid, colors);
  EXPECT_TRUE(bytes.starts_with("ply\nformat binary_little_endian 1.0\n"));
  const Ply ply = ReadPly(bytes);
  ASSERT_EQ(ply.faces.size(), 6u);
  const Eigen::Vector3f middle(-0.75F, 0.25F, 1.75F);
  for (const auto& face : ply.faces) {
    std::array<Eigen::Vector3f, 4> corners;
    for (std::size_t k = 0; k < 4; ++k) {
      const Ply::Vertex& vertex = ply.vertices.at(static_cast<std::size_t>(face[k]));
      corners[k] = vertex.p_W;
      EXPECT_EQ(vertex.color, (Rgb{10, 200, 30}));
      EXPECT_TRUE(((corners[k] - middle).cwiseAbs() - Eigen::Vector3f::Constant(0.25F)).isZero(1e-6F));
    }
    const Eigen::Vector3f normal = (corners[1] - corners[0]).cross(corners[2] - corners[1]);
    EXPECT_NEAR(normal.norm(), 0.25F, 1e-6F);
    EXPECT_GT(normal.dot(corners[0] - middle), 0.0F) << "faces look outward";
  }
}

TEST(MapFiles, PlyLeavesOutFacesBetweenOccupiedVoxels) {
  OccupancyGrid grid(0.1);
  grid.Set({0, 0, 0}, 1.0F);
  grid.Set({1, 0, 0}, 1.0F);
  EXPECT_EQ(ReadPly(EncodePly(grid, {})).faces.size(), 10u);
}

TEST(ColoredPoints, AreTheOccupiedVoxelsThatHaveAColor) {
  OccupancyGrid grid(0.5);
  VoxelColors colors;
  grid.Set({-2, 0, 3}, 1.0F);
  colors.Add({-2, 0, 3}, {10, 200, 30});
  grid.Set({4, 4, 4}, -1.0F);  // once hit, now free
  colors.Add({4, 4, 4}, {1, 2, 3});
  grid.Set({9, 9, 9}, 1.0F);  // hit by a cloud without colors
  const std::vector<dds::ColoredPoint> points = ColoredPoints(grid, colors);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].p_W, Eigen::Vector3f(-0.75F, 0.25F, 1.75F));
  EXPECT_EQ(points[0].color, (Rgb{10, 200, 30}));
}

}  // namespace
}  // namespace thalweg::mapper
