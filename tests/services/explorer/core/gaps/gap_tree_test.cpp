#include "services/explorer/core/gaps/gap_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace thalweg::explorer {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Kind = GapEvent::Kind;

/// "0 (1 2!)": gap 0 is in sight, and so is one that 1 and 2 merged into; 2 is primitive.
std::string TextOf(const GapTree& tree, const std::vector<GapTree::Node>& nodes) {
  std::string text;
  for (const GapTree::Node node : nodes) {
    if (!text.empty()) text += ' ';
    text += tree.IsLeaf(node) ? std::to_string(node) + (tree.IsPrimitive(node) ? "!" : "")
                              : '(' + TextOf(tree, tree.Children(node)) + ')';
  }
  return text;
}

std::string TextOf(const GapTree& tree) {
  return TextOf(tree, tree.in_sight());
}

TEST(GapTree, BeginsWithGapsThatAreNotPrimitive) {
  EXPECT_EQ(TextOf(GapTree(3)), "0 1 2");
  EXPECT_FALSE(GapTree(3).IsComplete());
  EXPECT_TRUE(GapTree(0).IsComplete());
}

TEST(GapTree, AGapThatAppearsIsAPrimitiveChildOfTheRoot) {
  GapTree tree(2);
  tree.Apply({Kind::kAppear, 1});
  EXPECT_EQ(TextOf(tree), "0 2! 1");
  tree.Apply({Kind::kAppear, 3});
  EXPECT_EQ(TextOf(tree), "0 2! 1 3!");
  tree.Apply({Kind::kAppear, 0});
  EXPECT_EQ(TextOf(tree), "4! 0 2! 1 3!");
}

TEST(GapTree, AGapThatDisappearsIsDeleted) {
  GapTree tree(3);
  tree.Apply({Kind::kDisappear, 1});
  EXPECT_EQ(TextOf(tree), "0 2");
  EXPECT_FALSE(tree.Contains(1));
}

TEST(GapTree, ALeafSplitsIntoTwoThatAreNotPrimitive) {
  GapTree tree(2);
  tree.Apply({Kind::kSplit, 0});
  EXPECT_EQ(TextOf(tree), "2 3 1");
}

TEST(GapTree, GapsThatMergeBecomeChildrenAndComeBackAsTheyWere) {
  GapTree tree(2);
  tree.Apply({Kind::kAppear, 1});
  tree.Apply({Kind::kMerge, 0});
  EXPECT_EQ(TextOf(tree), "(0 2!) 1");
  tree.Apply({Kind::kMerge, 0});
  EXPECT_EQ(TextOf(tree), "((0 2!) 1)");
  EXPECT_THAT(tree.Leaves(), ElementsAre(0, 2, 1));
  EXPECT_EQ(tree.Level(2), 2U);
  EXPECT_EQ(tree.Level(1), 1U);
  EXPECT_EQ(tree.SlotOf(2), 0U);
  tree.Apply({Kind::kSplit, 0});
  tree.Apply({Kind::kSplit, 0});
  EXPECT_EQ(TextOf(tree), "0 2! 1");
}

TEST(GapTree, TheLastGapMergesWithTheFirst) {
  GapTree tree(3);
  tree.Apply({Kind::kMerge, 2});
  EXPECT_EQ(TextOf(tree), "1 (2 0)");
  tree.Apply({Kind::kSplit, 1});
  EXPECT_EQ(TextOf(tree), "1 2 0");
}

TEST(GapTree, IsCompleteWhenAllLeavesArePrimitive) {
  GapTree tree(1);
  tree.Apply({Kind::kAppear, 0});
  tree.Apply({Kind::kAppear, 0});
  tree.Apply({Kind::kMerge, 0});
  EXPECT_EQ(TextOf(tree), "(2! 1!) 0");
  EXPECT_FALSE(tree.IsComplete());
  tree.Apply({Kind::kDisappear, 1});
  EXPECT_TRUE(tree.IsComplete());
  EXPECT_THAT(GapTree(0).Leaves(), IsEmpty());
}

TEST(GapTreeDeathTest, ImpossibleEventsAbort) {
  GapTree tree(1);
  tree.Apply({Kind::kAppear, 0});
  EXPECT_DEATH(tree.Apply({Kind::kSplit, 0}), "IsPrimitive");
  tree.Apply({Kind::kMerge, 0});
  EXPECT_DEATH(tree.Apply({Kind::kDisappear, 0}), "IsLeaf");
  EXPECT_DEATH(tree.Apply({Kind::kMerge, 0}), "in_sight");
}

}  // namespace
}  // namespace thalweg::explorer
