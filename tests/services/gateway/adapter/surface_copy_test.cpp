#include "services/gateway/adapter/surface_copy.h"

#include <gtest/gtest.h>

#include <limits>

#include "common/dds/convert.h"

namespace thalweg::gateway {
namespace {

using Update = thalweg_msgs::msg::SurfaceUpdate;

thalweg_msgs::msg::SurfaceBlock Triangle() {
  thalweg_msgs::msg::SurfaceBlock block;
  block.x(-4);
  block.points_m({0, 0, 0, 1, 0, 0, 0, 1, 0});
  block.normals(std::vector<std::uint8_t>(9, 127));
  block.colors(std::vector<std::uint8_t>(9, 5));
  block.views({0, 1, 3});
  block.faces({0, 1, 2});
  return block;
}
Update Make(std::uint64_t number, bool full = false, std::uint64_t session = 7) {
  Update update;
  update.header(dds::MakeHeader(Time{}, dds::kMapFrame));
  update.session(session);
  update.number(number);
  update.full(full);
  update.voxel_size_m(0.02);
  update.blocks().push_back(Triangle());
  return update;
}
/// What an update did: "replaces", "changes", "nothing", or the error.
std::string Apply(SurfaceCopy& copy, const Update& update) {
  const auto change = copy.Apply(update);
  if (!change) return change.error();
  if (!*change) return "nothing";
  return (*change)->replaced ? "replaces" : "changes";
}

TEST(SurfaceCopy, FollowsTheNumbersFromAFullCopyOn) {
  SurfaceCopy copy;
  EXPECT_TRUE(copy.missing());
  EXPECT_EQ(Apply(copy, Make(3)), "nothing");
  EXPECT_EQ(Apply(copy, Make(3, true)), "replaces");
  EXPECT_FALSE(copy.missing());
  EXPECT_EQ(Apply(copy, Make(4)), "changes");
  EXPECT_EQ(Apply(copy, Make(4)), "nothing") << "it comes again";
  EXPECT_EQ(Apply(copy, Make(4, true)), "nothing") << "the full copy of another reader";
  EXPECT_EQ(Apply(copy, Make(5)), "changes");
  EXPECT_FALSE(copy.missing());
}

TEST(SurfaceCopy, MissesAFullCopyAfterAGapAndAfterARestart) {
  SurfaceCopy copy;
  Apply(copy, Make(1, true));
  EXPECT_EQ(Apply(copy, Make(3)), "nothing");
  EXPECT_TRUE(copy.missing());
  EXPECT_EQ(copy.MakeRequest(Time{}, "gateway").number(), 1U);
  EXPECT_EQ(Apply(copy, Make(3, true)), "replaces");
  EXPECT_EQ(Apply(copy, Make(4, false, 8)), "nothing") << "another session";
  EXPECT_TRUE(copy.missing());
  EXPECT_EQ(Apply(copy, Make(0, true, 8)), "replaces");
  EXPECT_EQ(Apply(copy, Make(1, false, 8)), "changes");
}

TEST(SurfaceCopy, RefusesLies) {
  SurfaceCopy copy;
  const auto refused = [&](auto&& change) {
    Update update = Make(1, true);
    change(update);
    return Apply(copy, update);
  };
  const std::string block = "block (-4, 0, 0) has ";
  EXPECT_EQ(refused([](Update& u) { u.session(0); }), "session is 0");
  EXPECT_EQ(refused([](Update& u) { u.voxel_size_m(0.0); }), "voxel_size_m is 0, must be > 0");
  EXPECT_NE(refused([](Update& u) { u.header().frame_id("odom"); }), "replaces");
  EXPECT_EQ(refused([](Update& u) { u.blocks()[0].views().pop_back(); }),
            block + "points, normals, colors and views of different numbers");
  EXPECT_EQ(refused([](Update& u) { u.blocks()[0].faces()[2] = 3; }),
            block + "a triangle of vertices that it has not");
  EXPECT_EQ(refused([](Update& u) { u.blocks()[0].faces().pop_back(); }), block + "a part of a triangle");
  EXPECT_EQ(refused([](Update& u) { u.blocks()[0].points_m()[4] = std::numeric_limits<float>::quiet_NaN(); }),
            block + "a point that is not finite and within 1e6 m");
  EXPECT_TRUE(copy.missing());
}

}  // namespace
}  // namespace thalweg::gateway
