#include "services/explorer/core/gaps/gap_tracker.h"

#include <algorithm>
#include <set>

#include "common/base/check.h"
#include "common/voxel/for_each_voxel.h"

namespace thalweg::explorer {

void GapTracker::Update(const DenseGrid<int>& shadows) {
  int count = 0;
  for (std::size_t k = 0; k < shadows.size(); ++k) count = std::max(count, shadows[k] + 1);
  const std::map<Node, Parts> parts = PartsOfLeaves(shadows);
  std::vector<std::vector<Node>> pieces(static_cast<std::size_t>(count));
  for (const Node node : std::exchange(in_sight_, {})) {
    for (const Piece& piece : Break(node, parts)) {
      pieces[static_cast<std::size_t>(piece.shadow)].push_back(piece.node);
    }
  }
  for (const std::vector<Node>& nodes : pieces) in_sight_.push_back(Join(nodes));
  NameCells(shadows, parts);
}

std::map<GapTracker::Node, GapTracker::Parts> GapTracker::PartsOfLeaves(const DenseGrid<int>& shadows) {
  std::map<Node, std::map<int, std::size_t>> cells;  // by leaf and shadow
  for (std::size_t k = 0; k < shadows.size(); ++k) {
    if (shadows[k] == kNoShadow) continue;
    if (const auto name = LeafAt(shadows.IndexAt(k))) ++cells[*name][shadows[k]];
  }
  std::map<Node, Parts> parts;
  std::map<int, Node> most;  // of the leaves with cells in a shadow
  std::set<int> taken;
  for (const auto& [leaf, its] : cells) {
    const int main = std::ranges::max_element(its, {}, [](const auto& in) { return in.second; })->first;
    parts[leaf] = {{main, leaf}};
    taken.insert(main);
    for (const auto& [shadow, count] : its) {
      const auto [known, is_first] = most.emplace(shadow, leaf);
      if (!is_first && count > cells[known->second][shadow]) known->second = leaf;
    }
  }
  for (const auto& [shadow, leaf] : most) {
    if (!taken.contains(shadow)) parts[leaf].emplace(shadow, leaf);
  }
  for (auto& [leaf, its] : parts) {
    if (its.size() == 1) continue;
    for (auto& [shadow, name] : its) name = Add();
  }
  return parts;
}

std::vector<GapTracker::Piece> GapTracker::Break(Node node, const std::map<Node, Parts>& parts) {
  const std::vector<Node> children = Children(node);
  std::vector<Piece> pieces;
  if (children.empty()) {
    const auto found = parts.find(node);
    if (found != parts.end()) {
      for (const auto& [shadow, name] : found->second) pieces.push_back({name, shadow});
    }
    if (pieces.size() != 1) gaps_.erase(node);
    return pieces;
  }
  for (const Node child : children) {
    const std::vector<Piece> broken = Break(child, parts);
    pieces.insert(pieces.end(), broken.begin(), broken.end());
  }
  const bool whole = pieces.size() > 1 && std::ranges::all_of(pieces, [&](const Piece& piece) {
                       return piece.shadow == pieces.front().shadow;
                     });
  Entry& entry = gaps_.at(node);
  entry.children.clear();
  for (const Piece& piece : pieces) {
    if (whole) entry.children.push_back(piece.node);
    gaps_.at(piece.node).parent = whole ? std::optional(node) : std::nullopt;
  }
  if (whole) return {{node, pieces.front().shadow}};
  gaps_.erase(node);
  return pieces;
}

GapTracker::Node GapTracker::Join(const std::vector<Node>& nodes) {
  if (nodes.size() == 1) return nodes.front();
  const Node joined = Add();
  gaps_.at(joined).children = nodes;
  for (const Node node : nodes) gaps_.at(node).parent = joined;
  return joined;
}

void GapTracker::NameCells(const DenseGrid<int>& shadows, const std::map<Node, Parts>& parts) {
  DenseGrid<std::optional<Node>> names(shadows.box(), std::nullopt);
  std::vector<VoxelIndex> named;
  for (std::size_t k = 0; k < shadows.size(); ++k) {
    if (shadows[k] == kNoShadow) continue;
    const VoxelIndex i = shadows.IndexAt(k);
    const Node node = in_sight_[static_cast<std::size_t>(shadows[k])];
    if (Children(node).empty()) {
      names[k] = node;
    } else if (const std::optional<Node> before = LeafAt(i)) {
      const auto part = parts.at(*before).find(shadows[k]);
      if (part != parts.at(*before).end()) names[k] = part->second;
    }
    if (names[k]) named.push_back(i);
  }
  for (std::size_t n = 0; n < named.size(); ++n) {
    const VoxelIndex at = named[n];
    ForEachVoxel({{at.x - 1, at.y - 1, 0}, {at.x + 2, at.y + 2, 1}}, [&](const VoxelIndex& i) {
      if (!names.Contains(i) || names[i] || shadows[i] != shadows[at]) return;
      names[i] = names[at];
      named.push_back(i);
    });
  }
  names_ = std::move(names);
}

std::vector<GapTracker::Node> GapTracker::Leaves() const {
  std::vector<Node> leaves;
  for (const Node node : in_sight_) AddLeavesBelow(node, leaves);
  return leaves;
}

std::size_t GapTracker::Level(Node node) const {
  std::size_t level = 0;
  for (auto parent = gaps_.at(node).parent; parent; parent = gaps_.at(*parent).parent) ++level;
  return level;
}

std::optional<GapTracker::Node> GapTracker::LeafAt(const VoxelIndex& cell) const {
  return names_.Get(cell, std::nullopt);
}

GapTracker::Node GapTracker::Add() {
  gaps_[next_] = {};
  return next_++;
}

void GapTracker::AddLeavesBelow(Node node, std::vector<Node>& leaves) const {
  if (Children(node).empty()) leaves.push_back(node);
  for (const Node child : Children(node)) AddLeavesBelow(child, leaves);
}

}  // namespace thalweg::explorer
