#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "common/voxel/dense_grid.h"

namespace thalweg::explorer {

/// The number of a shadow, or this for cells in sight and walls.
inline constexpr int kNoShadow = -1;

/// The gap navigation tree of a robot that knows a plane by its cells and looks at it now and then, where
/// that of GapTree is given one event after the other. A gap is known by its shadow, the cells that it hides.
///
/// Every hidden cell carries the name of the leaf that hides it. How the names lie in the shadows of the next
/// look is what happened to the gaps, as many events as there may have been meanwhile. A leaf is in the
/// shadow that holds most of its cells.
/// - A shadow without a name: appear.
/// - A name in no shadow any more: disappear, for a leaf within merged gaps as well.
/// - A shadow in which no leaf is, but cells of some are: the one with most cells there has split, into a
///   leaf for each of its shadows. Cells that went over to the shadow of another leaf only change their name.
/// - The parts of a merged gap in several shadows: it splits into its parts, and so do those above it.
/// - Several gaps in one shadow: merge, into a gap that has all of them as its parts.
/// After a single event this is the tree that GapTree has. No look is impossible, whatever the map did.
///
/// A shadow that has a single leaf gives its name to all cells that have none. In that of a merged gap, a
/// cell gets the name nearest to it, in steps through the shadow.
///
/// Whether a leaf is primitive, because all that it hides was seen before, is for the caller to say: the map
/// knows it.
/// Threading: one thread owns a tracker.
class GapTracker {
 public:
  using Node = std::size_t;  ///< The name of a gap. Names are given in the order of first sight, each once.

  /// Takes what is hidden now.
  /// @param shadows  For each cell of the plane, a box of height 1 at z = 0, the shadow that it lies in.
  ///                 Numbers from 0 on, without one left out. O(cells).
  void Update(const DenseGrid<int>& shadows);

  /// The gaps in sight, by the numbers of their shadows.
  const std::vector<Node>& in_sight() const { return in_sight_; }
  bool Contains(Node node) const { return gaps_.contains(node); }
  const std::vector<Node>& Children(Node node) const { return gaps_.at(node).children; }
  std::vector<Node> Leaves() const;
  std::size_t Level(Node node) const;  ///< How many gaps lie above it: 0 for one in sight.
  /// The leaf that hides a cell; nothing for one that is not hidden.
  std::optional<Node> LeafAt(const VoxelIndex& cell) const;

 private:
  struct Entry {
    std::optional<Node> parent;
    std::vector<Node> children;
  };
  /// A gap all of whose leaves lie in one shadow.
  struct Piece {
    Node node;
    int shadow;
  };
  /// The shadows that a leaf is in, more than one if it has split, and its name there.
  using Parts = std::map<int, Node>;

  /// Which leaves are in which shadows. Leaves that have split get a new name in each.
  std::map<Node, Parts> PartsOfLeaves(const DenseGrid<int>& shadows);
  /// Breaks a gap into the largest pieces that lie in one shadow each.
  std::vector<Piece> Break(Node node, const std::map<Node, Parts>& parts);
  Node Join(const std::vector<Node>& nodes);
  void NameCells(const DenseGrid<int>& shadows, const std::map<Node, Parts>& parts);
  Node Add();
  void AddLeavesBelow(Node node, std::vector<Node>& leaves) const;

  std::map<Node, Entry> gaps_;
  std::vector<Node> in_sight_;
  DenseGrid<std::optional<Node>> names_;  ///< The leaf that hides each cell.
  Node next_ = 0;
};

}  // namespace thalweg::explorer
