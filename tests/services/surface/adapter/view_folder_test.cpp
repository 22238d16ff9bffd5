#include "services/surface/adapter/view_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "common/surface_graph/surface.h"

namespace thalweg::surface {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A folder with a depth view "a" and a disparity view "b" of 8 x 6 pixels.
class ViewFolderFiles : public testing::Test {
 protected:
  ViewFolderFiles() {
    fs::create_directories(folder_);
    Write("camera-intrinsics.txt", "100 0 3.5\n0 110 2.5\n0 0 1\n");
    Write("baseline.txt", "0.2\n");
    Write("a.pose.txt", "1 0 0 0.5\n0 1 0 0\n0 0 1 -2\n0 0 0 1\n");
    Write("b.pose.txt", "0 -1 0 0\n1 0 0 0\n0 0 1 0\n0 0 0 1\n");
    cv::Mat_<std::uint16_t> depth(6, 8, std::uint16_t{2500});
    depth(1, 2) = 0;
    depth(3, 4) = 65535;
    cv::imwrite(File("a.depth.png"), depth);
    cv::Mat_<float> disparity(6, 8, 4.0F);
    disparity(1, 2) = std::numeric_limits<float>::infinity();
    disparity(5, 7) = 8.0F;
    cv::imwrite(File("b.disparity.pfm"), disparity);
    cv::Mat_<cv::Vec3b> colors(6, 8, cv::Vec3b(1, 2, 3));
    cv::imwrite(File("b.color.png"), colors);
  }
  ~ViewFolderFiles() override { fs::remove_all(folder_); }

  std::string File(const std::string& name) const { return (folder_ / name).string(); }
  void Write(const std::string& name, const std::string& text) const { std::ofstream(File(name)) << text; }

  /// What is said about the folder, or about one of its views.
  std::string Complaint() const {
    try {
      ViewFolder folder = ViewFolder::Open(folder_);
      for (std::size_t i = 0; i < folder.size(); ++i) folder.Load(i);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "none";
  }

  fs::path folder_ = fs::temp_directory_path() / ("view_folder_" + std::to_string(getpid()));
};

TEST_F(ViewFolderFiles, DepthsAndDisparitiesBecomeViews) {
  ViewFolder folder = ViewFolder::Open(folder_);
  ASSERT_EQ(folder.size(), 2U);
  EXPECT_EQ(folder.NameOf(0), "a");
  const View a = folder.Load(0);
  EXPECT_EQ(a.width_px(), 8);
  EXPECT_EQ(a.height_px(), 6);
  EXPECT_EQ(a.rig.camera.fy, 110.0);
  EXPECT_EQ(a.T_WC.translation(), Eigen::Vector3d(0.5, 0, -2));
  EXPECT_NEAR(a.DepthAt(0), 2.5, 1e-6);
  EXPECT_FALSE(a.IsValid(a.PixelAt(2, 1)));
  EXPECT_FALSE(a.IsValid(a.PixelAt(4, 3)));
  EXPECT_TRUE(a.colors.empty());
  const View b = folder.Load(1);
  EXPECT_NEAR(b.DepthAt(0), 100.0 * 0.2 / 4.0, 1e-6);
  EXPECT_NEAR(b.DepthAt(b.PixelAt(7, 5)), 100.0 * 0.2 / 8.0, 1e-6) << "rows run from the top";
  EXPECT_FALSE(b.IsValid(b.PixelAt(2, 1)));
  EXPECT_EQ(b.colors.at(5), (Rgb{3, 2, 1}));
  EXPECT_NEAR((b.T_WC * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0, 1, 0)).norm(), 0.0, 1e-12);
}

TEST_F(ViewFolderFiles, WhatIsWrongIsSaidWithTheFile) {
  EXPECT_EQ(Complaint(), "none");
  const auto complaint_with = [&](const std::string& name, const std::string& text) {
    fs::rename(File(name), File("kept"));
    Write(name, text);
    const std::string complaint = Complaint();
    fs::rename(File("kept"), File(name));
    return complaint;
  };
  EXPECT_THAT(complaint_with("camera-intrinsics.txt", "100 0 3.5 0 110"),
              HasSubstr("camera-intrinsics.txt: has 5 numbers, must have 9"));
  EXPECT_THAT(complaint_with("camera-intrinsics.txt", "100 1 3 0 110 2 0 0 1"), HasSubstr("must be fx 0 cx"));
  EXPECT_THAT(complaint_with("a.pose.txt", "1 0 0 x"), HasSubstr("a.pose.txt: \"x\" is not a number"));
  EXPECT_THAT(complaint_with("a.pose.txt", "1 0 0 0 0 1 0 0 0 0 2 0 0 0 0 1"),
              HasSubstr("a.pose.txt: is not a rotation"));
  EXPECT_THAT(complaint_with("a.pose.txt", "1 0 0 nan 0 1 0 0 0 0 1 0 0 0 0 1"), HasSubstr("not a number"));
  EXPECT_THAT(complaint_with("a.pose.txt", "1 0 0 1e300 0 1 0 0 0 0 1 0 0 0 0 1"),
              HasSubstr("a.pose.txt: is farther than 10 km"));
  EXPECT_THAT(complaint_with("a.pose.txt", "1 0 0 20000 0 1 0 0 0 0 1 0 0 0 0 1"),
              HasSubstr("farther than 10 km"));
  EXPECT_THAT(
      complaint_with("camera-intrinsics.txt", "100 0 320 0 100 240 0 0 1"),
      HasSubstr("the principal point (320, 240) is far from the middle of images of 8 x 6; are these of"));
  for (const char* const of_another_size :
       {"100 0 7.5 0 100 5.5 0 0 1", "100 0 8 0 100 6 0 0 1", "100 0 1.5 0 100 1 0 0 1"})
    EXPECT_THAT(complaint_with("camera-intrinsics.txt", of_another_size), HasSubstr("the principal point"));
  EXPECT_THAT(
      complaint_with("camera-intrinsics.txt", "0.1 0 3 0 0.1 2 0 0 1"),
      HasSubstr("camera-intrinsics.txt: the focal lengths 0.1, 0.1 px are too short for images of 8 x 6"));
  EXPECT_THAT(complaint_with("camera-intrinsics.txt", "1e300 0 3 0 110 2 0 0 1"),
              HasSubstr("camera-intrinsics.txt: the focal length"));
  EXPECT_THAT(complaint_with("camera-intrinsics.txt", "100 0 3 0 110 -1e300 0 0 1"),
              HasSubstr("camera-intrinsics.txt: the principal point"));
  EXPECT_THAT(complaint_with("baseline.txt", "-0.1"), HasSubstr("baseline.txt: must be above 0"));
  EXPECT_THAT(complaint_with("baseline.txt", "1e300"),
              HasSubstr("baseline.txt: must be above 0 and at most"));
  EXPECT_THAT(complaint_with("b.disparity.pfm", "nonsense"),
              HasSubstr("b.disparity.pfm: is not a readable image"));
  EXPECT_EQ(Complaint(), "none");
}

TEST_F(ViewFolderFiles, ImagesOfAnotherSizeOrKindAreRefused) {
  cv::imwrite(File("b.color.png"), cv::Mat_<cv::Vec3b>(6, 9, cv::Vec3b(1, 2, 3)));
  EXPECT_THAT(Complaint(), HasSubstr("b.color.png: is 9 x 6, the images before are 8 x 6"));
  cv::imwrite(File("a.depth.png"), cv::Mat_<std::uint8_t>(6, 8, std::uint8_t{1}));
  EXPECT_THAT(Complaint(), HasSubstr("a.depth.png: must be 16-bit gray"));
  fs::remove(File("a.depth.png"));
  EXPECT_THAT(Complaint(), HasSubstr("a.pose.txt: has neither a.depth.png nor a.disparity.pfm"));
}

TEST_F(ViewFolderFiles, AViewOfTwoKindsIsRefused) {
  fs::copy(File("a.depth.png"), File("b.depth.png"));
  EXPECT_THAT(Complaint(), HasSubstr("b.pose.txt: has both b.depth.png and b.disparity.pfm beside it"));
}

TEST_F(ViewFolderFiles, AnImageWithoutAPoseIsRefused) {
  fs::remove(File("a.pose.txt"));
  EXPECT_THAT(Complaint(), HasSubstr("a.depth.png: has no a.pose.txt beside it"));
  fs::remove(File("a.depth.png"));
  EXPECT_EQ(Complaint(), "none");
  fs::remove(File("b.pose.txt"));
  EXPECT_THAT(Complaint(), HasSubstr("b.disparity.pfm: has no b.pose.txt beside it"));
}

TEST_F(ViewFolderFiles, AFolderWithoutViewsIsRefused) {
  fs::remove(File("a.depth.png"));
  fs::remove(File("b.disparity.pfm"));
  fs::remove(File("a.pose.txt"));
  fs::remove(File("b.pose.txt"));
  EXPECT_THAT(Complaint(), HasSubstr("no file NAME.pose.txt"));
  EXPECT_THROW(ViewFolder::Open(folder_ / "none"), std::runtime_error);
}

// Depth images of a real room, the first and the last of fifty, 0.25 m apart.
TEST(ViewFolderOnRealData, TwoViewsOfARoomMergeAndShowMoreThanOne) {
  const char* const data = std::getenv("THALWEG_DATA");
  const fs::path room = fs::path(data == nullptr ? "" : data) / "scans" / "rgbd_room_50";
  if (!fs::is_directory(room)) GTEST_SKIP() << "THALWEG_DATA does not name the folder of real data";
  ViewFolder folder = ViewFolder::Open(room);
  ASSERT_EQ(folder.size(), 50U);
  Surface surface({});
  const Addition first = surface.Add(folder.Load(0));
  const double area = surface.Area();
  EXPECT_GT(first.points, 250'000U) << "90 % of 640 x 480";
  EXPECT_GT(area, 1.0);
  const Addition second = surface.Add(folder.Load(49));
  EXPECT_GT(second.dropped, 0U);
  EXPECT_EQ(surface.vertex_count(), first.points + second.points - second.dropped);
  EXPECT_GT(surface.Area(), area);
}

}  // namespace
}  // namespace thalweg::surface
