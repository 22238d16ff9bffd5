#include "services/explorer/core/gaps/shadows.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace thalweg::explorer {
namespace {

/// A plane drawn with its first row at y = 0: # wall, . free, ? unseen, R the robot.
struct Drawn {
  explicit Drawn(const std::vector<std::string>& rows)
      : plane({{0, 0, 0}, {static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), 1}},
              PlaneCell::kWall) {
    for (std::size_t k = 0; k < plane.size(); ++k) {
      const VoxelIndex i = plane.IndexAt(k);
      const char cell = rows[static_cast<std::size_t>(i.y)][static_cast<std::size_t>(i.x)];
      if (cell == '.' || cell == 'R') plane[k] = PlaneCell::kFree;
      if (cell == '?') plane[k] = PlaneCell::kUnseen;
      if (cell == 'R') robot = i;
    }
  }
  /// The numbers of the shadows, a dot for none.
  std::vector<std::string> Shadows(std::size_t least = 1) const {
    const DenseGrid<int> shadows = FindShadows(plane, robot, least);
    std::vector<std::string> rows(static_cast<std::size_t>(plane.box().size_y()));
    for (std::size_t k = 0; k < shadows.size(); ++k) {
      rows[static_cast<std::size_t>(shadows.IndexAt(k).y)] +=
          shadows[k] == kNoShadow ? '.' : static_cast<char>('0' + shadows[k]);
    }
    return rows;
  }

  DenseGrid<PlaneCell> plane;
  VoxelIndex robot;
};

using Rows = std::vector<std::string>;

TEST(FindShadows, AConvexRoomHasNone) {
  EXPECT_EQ(Drawn({"#####",   //
                   "#R..#",   //
                   "#...#",   //
                   "#####"})  //
                .Shadows(),
            (Rows{".....", ".....", ".....", "....."}));
}

TEST(FindShadows, TwoSideRoomsAreTwo) {
  EXPECT_EQ(Drawn({"#########",  //
                   "#.#.R.#.#",  //
                   "#.#...#.#",  //
                   "#.......#",  //
                   "#########"})
                .Shadows(),
            (Rows{".........", ".0.....1.", ".0.....1.", ".0.....1.", "........."}));
}

TEST(FindShadows, WhatIsUnseenEndsALineOfSightButIsInSightItself) {
  EXPECT_EQ(Drawn({"R..?..."}).Shadows(), Rows{"....000"});
}

TEST(FindShadows, AWallHidesAllThatIsBehindIt) {
  EXPECT_EQ(Drawn({"R..#..?"}).Shadows(), Rows{"....000"});
}

TEST(FindShadows, UnseenCellsAreConnectedAcrossCornersAndFreeOnesAreNot) {
  // The wall between hides the last columns from the robot.
  const auto last_columns = [](const Rows& rows) {
    Rows columns;
    for (const std::string& row : rows) columns.push_back(row.substr(2));
    return columns;
  };
  EXPECT_EQ(last_columns(Drawn({"R#?#", ".##?"}).Shadows()), (Rows{"0.", ".0"}));
  EXPECT_EQ(last_columns(Drawn({"R#.#", ".##."}).Shadows()), (Rows{"0.", ".1"}));
}

TEST(FindShadows, SmallOnesAreLeftOutUnlessThereIsSomethingToSee) {
  EXPECT_EQ(Drawn({"R#..#..."}).Shadows(3), Rows{".....000"});
  EXPECT_EQ(Drawn({"R#?.#..."}).Shadows(3), Rows{"..00.111"});
}

}  // namespace
}  // namespace thalweg::explorer
