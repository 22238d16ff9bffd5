#include "services/surface/adapter/rift_message.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/services/surface/core/fused/volumes.h"

namespace thalweg::surface {
namespace {

/// Two sheets of 2.3 m x 2.3 m, one at z = 0.95 m, which faces upward, one at z = -0.25 m, which faces
/// downward.
class TwoSheets {
 public:
  TwoSheets() { Find(); }
  const MeshRifts& Find() {
    rifts_.Update(mesh_, mesh_.Update(volume_, test::AllBlocks(volume_)));
    rifts_.Find(mesh_, Eigen::Vector3d(0.4, 0.4, 0.95));
    return rifts_;
  }
  /// Nothing is known any more of the sheet at the top.
  void ForgetTheUpperOne() { test::SetKnown(volume_, {-8, -8, 8}, {15, 15, 11}, false); }
  const MeshRifts& rifts() const { return rifts_; }

 private:
  TruncatedVolume volume_ =
      test::VolumeOf(0.1, [](int, int, int z) { return 0.1 * std::max(-3.0 - z, z - 9.0); });
  SurfaceMesh mesh_{InspectionLimits{}};
  MeshRifts rifts_{0.1, {}};
};

TEST(RiftMessage, StatesTheOpenOnesAndThenThoseThatEnded) {
  TwoSheets sheets;
  const auto message = ToIdl(sheets.rifts());
  EXPECT_EQ(message.open(), 2U);
  ASSERT_EQ(message.rifts().size(), 2U);
  const MeshRift& heaviest = sheets.rifts().open()[0];
  const auto& first = message.rifts()[0];
  EXPECT_EQ(first.number(), heaviest.number);
  EXPECT_EQ(first.fate(), thalweg_msgs::msg::RIFT_OPEN);
  EXPECT_EQ(first.merged_into(), 0U);
  EXPECT_NEAR(first.center().z(), 0.95, 1e-5);
  EXPECT_EQ(first.nearest().x(), static_cast<double>(heaviest.nearest_W.x()));
  EXPECT_NEAR(first.normal().z(), 1.0, 1e-5);
  EXPECT_EQ(first.length_m(), heaviest.length);
  EXPECT_EQ(first.edges(), 4U * 23U);
  EXPECT_EQ(first.distance_m(), heaviest.distance);
  EXPECT_EQ(first.weight(), heaviest.weight);
  EXPECT_EQ(message.rifts()[1].distance_m(), std::numeric_limits<double>::infinity());
  EXPECT_EQ(ToIdl(sheets.Find()), message) << "the same again, infinities included";

  sheets.ForgetTheUpperOne();
  const auto later = ToIdl(sheets.Find());
  EXPECT_EQ(later.open(), 1U);
  ASSERT_EQ(later.rifts().size(), 2U);
  EXPECT_EQ(later.rifts()[0].number(), message.rifts()[1].number());
  EXPECT_EQ(later.rifts()[1].number(), first.number());
  EXPECT_EQ(later.rifts()[1].fate(), thalweg_msgs::msg::RIFT_CLOSED);
}

TEST(RiftMarkers, ShowTheLineTheNormalAndTheNumberOfEach) {
  TwoSheets sheets;
  std_msgs::msg::Header header;
  header.frame_id("map");
  const auto markers = MarkersOf(sheets.rifts(), header).markers();
  ASSERT_EQ(markers.size(), 7U);
  EXPECT_EQ(markers[0].action(), 3) << "those before are deleted first";
  for (std::size_t k = 1; k < 7; ++k) {
    EXPECT_EQ(markers[k].header().frame_id(), "map");
    EXPECT_EQ(markers[k].action(), 0);
    EXPECT_GT(markers[k].color().a(), 0.0F) << "else it is invisible";
  }
  EXPECT_EQ(markers[1].type(), 5) << "list of lines";
  EXPECT_EQ(markers[1].points().size(), 2U * 92U);
  EXPECT_GT(markers[1].scale().x(), 0.0);
  EXPECT_EQ(markers[1].pose().orientation().w(), 1.0) << "points are in map";
  EXPECT_GT(markers[1].color().r(), markers[4].color().r()) << "red, since it is the heaviest";
  EXPECT_EQ(markers[2].type(), 0) << "arrow";
  const auto& q = markers[5].pose().orientation();
  const Eigen::Vector3d along = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()) * Eigen::Vector3d::UnitX();
  EXPECT_LT((along + Eigen::Vector3d::UnitZ()).norm(), 1e-4) << "the lower sheet faces downward";
  EXPECT_EQ(markers[3].type(), 9) << "text";
  EXPECT_EQ(markers[3].text(), std::to_string(sheets.rifts().open()[0].number));
}

TEST(RiftMarkers, OfNoRiftDeleteThoseBefore) {
  const auto markers = MarkersOf(MeshRifts(0.1, {}), {}).markers();
  ASSERT_EQ(markers.size(), 1U);
  EXPECT_EQ(markers[0].action(), 3);
}

}  // namespace
}  // namespace thalweg::surface
