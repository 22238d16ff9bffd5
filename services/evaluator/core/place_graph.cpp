#include "services/evaluator/core/place_graph.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

namespace thalweg::evaluator {

void PlaceGraph::Connect(std::size_t a, std::size_t b, double length) {
  links[a].push_back({static_cast<std::uint32_t>(b), static_cast<float>(length)});
  links[b].push_back({static_cast<std::uint32_t>(a), static_cast<float>(length)});
}

bool PlaceGraph::Connected(std::size_t a, std::size_t b) const {
  return std::any_of(links[a].begin(), links[a].end(), [b](const Link& link) { return link.to == b; });
}

void ShortestPaths::Flood(std::size_t from) {
  Row& row = rows_[from];
  row.length.assign(graph_.size(), std::numeric_limits<float>::infinity());
  row.before.assign(graph_.size(), kNone);
  using Entry = std::pair<float, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  row.length[from] = 0.0F;
  open.emplace(0.0F, static_cast<std::uint32_t>(from));
  while (!open.empty()) {
    const auto [length, at] = open.top();
    open.pop();
    if (length > row.length[at]) continue;
    for (const PlaceGraph::Link& link : graph_.links[at]) {
      const float by = length + link.length;
      if (by >= row.length[link.to]) continue;
      row.length[link.to] = by;
      row.before[link.to] = at;
      open.emplace(by, link.to);
    }
  }
}

}  // namespace thalweg::evaluator
