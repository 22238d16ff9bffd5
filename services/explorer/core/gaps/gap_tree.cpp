#include "services/explorer/core/gaps/gap_tree.h"

#include <algorithm>

#include "common/base/check.h"

namespace thalweg::explorer {

GapTree::GapTree(std::size_t gaps) {
  for (std::size_t k = 0; k < gaps; ++k) in_sight_.push_back(Add(false));
}

void GapTree::Apply(const GapEvent& event) {
  const auto at = in_sight_.begin() + static_cast<std::ptrdiff_t>(event.slot);
  if (event.kind == GapEvent::Kind::kAppear) {
    THALWEG_CHECK(event.slot <= in_sight_.size());
    in_sight_.insert(at, Add(true));
    return;
  }
  THALWEG_CHECK(event.slot < in_sight_.size());
  const Node node = *at;
  switch (event.kind) {
    case GapEvent::Kind::kAppear:
      break;
    case GapEvent::Kind::kDisappear: {
      THALWEG_CHECK(IsLeaf(node));
      in_sight_.erase(at);
      gaps_.erase(node);
      break;
    }
    case GapEvent::Kind::kSplit: {
      THALWEG_CHECK(!IsPrimitive(node));
      std::vector<Node> parts = Children(node);
      if (parts.empty()) {
        parts.push_back(Add(false));
        parts.push_back(Add(false));
      }
      for (const Node part : parts) gaps_.at(part).parent.reset();
      *at = parts[0];
      in_sight_.insert(at + 1, parts[1]);
      gaps_.erase(node);
      break;
    }
    case GapEvent::Kind::kMerge: {
      THALWEG_CHECK(in_sight_.size() > 1);
      const auto next = at + 1 == in_sight_.end() ? in_sight_.begin() : at + 1;
      const Node merged = Add(false);
      gaps_.at(merged).children = {node, *next};
      for (const Node part : Children(merged)) gaps_.at(part).parent = merged;
      *at = merged;
      in_sight_.erase(next);
      break;
    }
  }
}

std::vector<GapTree::Node> GapTree::Leaves() const {
  std::vector<Node> leaves;
  for (const Node node : in_sight_) AddLeavesBelow(node, leaves);
  return leaves;
}

bool GapTree::IsComplete() const {
  return std::ranges::all_of(gaps_, [](const auto& gap) {
    const Entry& entry = gap.second;
    return entry.primitive || !entry.children.empty();
  });
}

std::size_t GapTree::Level(Node node) const {
  std::size_t level = 0;
  for (auto parent = gaps_.at(node).parent; parent; parent = gaps_.at(*parent).parent) ++level;
  return level;
}

std::size_t GapTree::SlotOf(Node node) const {
  Node top = node;
  while (gaps_.at(top).parent) top = *gaps_.at(top).parent;
  const auto at = std::ranges::find(in_sight_, top);
  THALWEG_CHECK(at != in_sight_.end());
  return static_cast<std::size_t>(at - in_sight_.begin());
}

GapTree::Node GapTree::Add(bool primitive) {
  gaps_[next_].primitive = primitive;
  return next_++;
}

void GapTree::AddLeavesBelow(Node node, std::vector<Node>& leaves) const {
  if (IsLeaf(node)) leaves.push_back(node);
  for (const Node child : Children(node)) AddLeavesBelow(child, leaves);
}

}  // namespace thalweg::explorer
