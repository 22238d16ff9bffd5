#include "common/files/tum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <numbers>
#include <sstream>

namespace thalweg {
namespace {

TEST(TumText, HasOnePoseALineWithTheQuaternionLast) {
  const RigidTransform T = MakeTransform(RotationFromYawPitch(std::numbers::pi / 2, 0.0), {1.0, -2.0, 0.25});
  std::istringstream in(TumText({{Time{FromSeconds(1.5)}, T}}));
  std::string comment;
  std::getline(in, comment);
  EXPECT_EQ(comment, "# stamp_s tx ty tz qx qy qz qw");
  const std::vector<double> values{std::istream_iterator<double>(in), {}};
  ASSERT_EQ(values.size(), 8U);
  const double half = std::sqrt(0.5);
  const std::vector<double> expected{1.5, 1.0, -2.0, 0.25, 0.0, 0.0, half, half};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(values[i], expected[i], 1e-12) << i;
}

TEST(TumText, KeepsEveryBitOfAPositionAndEveryNanosecondOfAStamp) {
  const Eigen::Vector3d p(1.0 / 3.0, -1e-9 / 7.0, 123456.789012345678);
  const std::string text =
      TumText({{Time{Duration(1'403'715'273'000'000'007)}, MakeTransform(Eigen::Matrix3d::Identity(), p)}});
  EXPECT_NE(text.find("\n1403715273.000000007 "), std::string::npos) << text;
  std::istringstream in(text.substr(text.find(' ', text.find('\n'))));
  for (int axis = 0; axis < 3; ++axis) {
    double value = 0.0;
    in >> value;
    EXPECT_EQ(value, p[axis]) << axis;
  }
}

}  // namespace
}  // namespace thalweg
