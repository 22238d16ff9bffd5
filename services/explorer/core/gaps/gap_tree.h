#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace thalweg::explorer {

/// A critical event: what happens to the gaps in sight, given by their places in the cyclic order.
struct GapEvent {
  enum class Kind : std::uint8_t {
    kAppear,     ///< A gap appears; from now on it is number `slot`.
    kDisappear,  ///< Gap `slot` disappears.
    kSplit,      ///< Gap `slot` becomes two, numbers `slot` and `slot` + 1.
    kMerge,  ///< Gap `slot` and the next become one in the place of the first; the last one's next is gap 0.
  };
  Kind kind = Kind::kAppear;
  std::size_t slot = 0;  ///< Counterclockwise; where the numbers begin is arbitrary, and no event changes it.

  bool operator==(const GapEvent&) const = default;
};

/// The gap navigation tree: what a robot remembers that senses gaps and nothing metric [Tovar, Murrieta-Cid,
/// LaValle: Distance-optimal navigation in an unknown environment without sensing distances, T-RO 23(3),
/// 2007; the source thesis has it as its Algorithm 1].
///
/// The root is the robot. Its children are the gaps in sight, in cyclic order; the children of a gap are the
/// two that merged into it. A leaf is primitive where all that it hides was seen before. The rules:
/// - appear: a primitive child of the root.
/// - disappear: the leaf is deleted.
/// - split: a leaf is replaced with two that are not primitive; a merged gap with its children, as they were.
/// - merge: the two become the children of a gap that takes their place.
/// Departure: a split gap is deleted, while the text of the algorithm could be read as keeping it as the
/// parent of its parts. It is no longer in sight then, and the children of the root are those in sight.
class GapTree {
 public:
  using Node = std::size_t;  ///< The name of a gap. Names are given in the order of first sight, each once.

  explicit GapTree(std::size_t gaps);  ///< As many are in sight at the start; none of them is primitive.

  /// Aborts where the event is impossible: a primitive leaf cannot split, a merged gap cannot disappear.
  void Apply(const GapEvent& event);

  const std::vector<Node>& in_sight() const { return in_sight_; }  ///< The root's children, by slot.
  bool Contains(Node node) const { return gaps_.contains(node); }
  bool IsLeaf(Node node) const { return gaps_.at(node).children.empty(); }
  bool IsPrimitive(Node node) const { return gaps_.at(node).primitive; }
  const std::vector<Node>& Children(Node node) const { return gaps_.at(node).children; }
  std::vector<Node> Leaves() const;  ///< In the cyclic order in which they would be seen.
  bool IsComplete() const;           ///< All leaves are primitive.

  std::size_t Level(Node node) const;   ///< How many gaps lie above it: 0 for one in sight.
  std::size_t SlotOf(Node node) const;  ///< Which gap in sight it is, or lies within.

 private:
  struct Entry {
    bool primitive = false;
    std::optional<Node> parent;
    std::vector<Node> children;
  };

  Node Add(bool primitive);
  void AddLeavesBelow(Node node, std::vector<Node>& leaves) const;

  std::map<Node, Entry> gaps_;
  std::vector<Node> in_sight_;
  Node next_ = 0;
};

}  // namespace thalweg::explorer
