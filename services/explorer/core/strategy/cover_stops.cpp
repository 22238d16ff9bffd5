#include "services/explorer/core/strategy/cover_stops.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "common/base/bit_table.h"
#include "common/base/check.h"

namespace thalweg::explorer {
namespace {

constexpr double kSpacing = 0.4;       // [m] Edge of the lattice's cells.
constexpr double kMostSamples = 4.0;   // Per cluster,
constexpr double kManyItems = 1500.0;  // fewer where there are more clusters than would fit in here.
constexpr double kZone = 2.0;          // [m]
constexpr int kMostSeers = 4;          // Stops kept per item among those that show most,
constexpr int kNearSeers = 2;          // and among those nearest to the robot.

/// Cubic cells of `edge` voxels that fill a box; each has an offset, which is the sum over the axes of a
/// value that the tables give for the distance from the box's corner.
struct CellOffsets {
  CellOffsets(const VoxelBox& box, int edge) {
    const auto fill = [edge](std::vector<std::size_t>& of, int voxels, std::size_t stride) {
      for (int n = 0; n < voxels; ++n) of.push_back(static_cast<std::size_t>(n / edge) * stride);
      return stride * static_cast<std::size_t>((voxels + edge - 1) / edge);
    };
    count = fill(z, box.size_z(), fill(y, box.size_y(), fill(x, box.size_x(), 1)));
  }
  std::size_t Of(const VoxelIndex& at) const {
    return x[static_cast<std::size_t>(at.x)] + y[static_cast<std::size_t>(at.y)] +
           z[static_cast<std::size_t>(at.z)];
  }

  std::size_t count = 0;
  std::vector<std::size_t> x = {};
  std::vector<std::size_t> y = {};
  std::vector<std::size_t> z = {};
};

/// @param zone  Items, those with the shortest path first.
/// @return      Empty when no view shows any of them.
std::optional<CoverStop> StopOfZone(const Situation& situation, const std::vector<CoverItem>& items,
                                    const std::vector<std::size_t>& zone) {
  for (const std::size_t n : zone) {
    CoverStop stop{.place = situation.candidates[items[n].candidate].goals.front(), .items = {n}};
    if (situation.time) {
      const std::vector<CoverStop> views = ViewsFrom(stop, situation, items);
      if (views.empty()) continue;
      stop.R_WB = views.front().R_WB;
    }
    stop.items = zone;
    stop.is_zone = true;
    return stop;
  }
  return std::nullopt;
}

}  // namespace

std::vector<CoverItem> SampleItems(const Situation& situation, double far) {
  const auto is_far = [far](const Candidate& candidate) { return candidate.length > far; };
  const auto near = std::ssize(situation.candidates) - std::ranges::count_if(situation.candidates, is_far);
  const double fit = kManyItems / static_cast<double>(near);
  const auto most = static_cast<std::size_t>(std::clamp(fit, 1.0, kMostSamples));
  std::vector<CoverItem> items;
  for (std::size_t n = 0; n < situation.candidates.size(); ++n) {
    const Candidate& candidate = situation.candidates[n];
    const bool its_far = is_far(candidate);
    const std::vector<VoxelIndex> sample = SpreadSample(candidate.cluster.unknowns, its_far ? 1 : most);
    for (const VoxelIndex& i : sample)
      items.push_back({i, n, 1.0 / static_cast<double>(sample.size()), its_far});
  }
  return items;
}

std::vector<CoverStop> StopsSeeing(const Situation& situation, const std::vector<CoverItem>& items,
                                   const std::vector<std::vector<RayStep>>& rays) {
  const PlanningMap& map = situation.map;
  const DenseGrid<VoxelState>& states = map.states();
  const DenseGrid<std::uint32_t>& costs = situation.search.costs();
  const VoxelBox& box = map.box();
  THALWEG_CHECK(costs.box() == box);
  const CellOffsets cells(box, std::max(1, static_cast<int>(std::lround(kSpacing / map.voxel_size()))));
  constexpr std::int32_t kNone = -1;
  std::vector<std::int32_t> stop_in(cells.count, kNone);
  DenseGrid<std::uint16_t> crossings(box, 0);
  std::vector<CoverStop> stops;
  std::vector<std::uint16_t> most_crossings;  // for each stop, those of its place
  for (std::size_t item = 0; item < items.size(); ++item) {
    if (items[item].is_far) continue;
    for (const std::vector<RayStep>& ray : rays) {
      for (const RayStep& step : ray) {
        const VoxelIndex eye = items[item].voxel + step.offset;
        if (!box.Contains(eye)) break;
        const VoxelState state = states[eye];
        if (state == VoxelState::kUnknown && step.distance <= kPocket) continue;
        if (state != VoxelState::kFree) break;
        const VoxelIndex body = map.BodyOf(eye);
        // Every other voxel, as on a chessboard, is enough to choose from.
        if (((body.x + body.y + body.z) & 1) != 0 || !box.Contains(body)) continue;
        const std::size_t offset = costs.Offset(body);
        if (costs[offset] == PathSearch::kUnreached) continue;
        std::int32_t& number = stop_in[cells.Of(body - box.min)];
        if (number == kNone) {
          number = static_cast<std::int32_t>(stops.size());
          stops.push_back({.place = body});
          most_crossings.push_back(0);
        }
        const auto n = static_cast<std::size_t>(number);
        std::uint16_t& count = crossings[offset];
        if (count < std::numeric_limits<std::uint16_t>::max()) ++count;
        if (count > most_crossings[n]) {
          most_crossings[n] = count;
          stops[n].place = body;
        }
        std::vector<std::size_t>& its = stops[n].items;
        if (its.empty() || its.back() != item) its.push_back(item);
      }
    }
  }
  return stops;
}

Eigen::Vector3d PositionOf(const CoverStop& stop, const Situation& situation) {
  return stop.is_here ? situation.robot_W : situation.map.CenterOf(stop.place);
}

std::vector<CoverStop> ViewsFrom(const CoverStop& stop, const Situation& situation,
                                 const std::vector<CoverItem>& items) {
  const PlanningMap& map = situation.map;
  const Eigen::Vector3d eye_W = map.EyeAt(PositionOf(stop, situation));
  std::vector<Eigen::Vector3d> offsets_W;
  std::vector<Eigen::Vector3d> directions_W;
  for (const std::size_t item : stop.items) {
    offsets_W.emplace_back(map.CenterOf(items[item].voxel) - eye_W);
    directions_W.emplace_back(offsets_W.back().normalized());
  }
  const BitTable shown = situation.views.ShownBySparse(offsets_W);
  const Bits nothing(shown.words(), 0);
  struct Rated {
    std::size_t view;   ///< Among the planner's sparse ones.
    std::size_t count;  ///< How many items it shows.
    double off_middle;  ///< How far these are from the middle of its image, as a negative cosine.
  };
  std::vector<Rated> rated;
  for (std::size_t k = 0; k < shown.rows(); ++k) {
    const std::size_t count = CountNew(nothing, shown.Of(k));
    if (count == 0) continue;
    Eigen::Vector3d sum_W = Eigen::Vector3d::Zero();
    ForEachNew(nothing, shown.Of(k), [&](std::size_t n) { sum_W += directions_W[n]; });
    const double off_middle = -sum_W.normalized().dot(situation.views.AxisAt(situation.views.sparse()[k]));
    rated.push_back({k, count, off_middle});
  }
  std::ranges::stable_sort(rated, [](const Rated& a, const Rated& b) {
    return a.count != b.count ? a.count > b.count : a.off_middle < b.off_middle;
  });
  std::vector<CoverStop> views;
  std::vector<Bits> kept;
  for (const Rated& its : rated) {
    const std::uint64_t* const items_shown = shown.Of(its.view);
    if (std::ranges::any_of(kept, [&](const Bits& other) { return CountNew(other, items_shown) == 0; }))
      continue;
    kept.emplace_back(items_shown, items_shown + shown.words());
    CoverStop& view = views.emplace_back(
        CoverStop{.place = stop.place, .R_WB = situation.views.sparse()[its.view], .is_here = stop.is_here});
    ForEachNew(nothing, items_shown, [&](std::size_t n) { view.items.push_back(stop.items[n]); });
  }
  return views;
}

std::vector<CoverStop> ZoneStops(const Situation& situation, const std::vector<CoverItem>& items) {
  const auto candidate_of = [&](std::size_t item) -> const Candidate& {
    return situation.candidates[items[item].candidate];
  };
  const auto length = [&](std::size_t item) { return candidate_of(item).length; };
  std::map<std::array<int, 3>, std::vector<std::size_t>> cells;  // of items
  for (std::size_t n = 0; n < items.size(); ++n) {
    if (!items[n].is_far) continue;
    const Eigen::Vector3d at = situation.map.CenterOf(candidate_of(n).goals.front()) / kZone;
    const auto number = [](double x) { return static_cast<int>(std::floor(x)); };
    cells[{number(at.x()), number(at.y()), number(at.z())}].push_back(n);
  }
  std::vector<CoverStop> stops;
  for (auto& [cell, its] : cells) {
    std::ranges::stable_sort(its, {}, length);
    // A wall between two of them makes one of the paths longer.
    for (auto begin = its.begin(); begin != its.end();) {
      const auto end =
          std::find_if(begin, its.end(), [&](std::size_t n) { return length(n) > length(*begin) + kZone; });
      if (std::optional<CoverStop> stop = StopOfZone(situation, items, {begin, end})) {
        std::ranges::sort(stop->items);
        stops.push_back(*std::move(stop));
      }
      begin = end;
    }
  }
  return stops;
}

void KeepFew(const Situation& situation, std::size_t items, std::vector<CoverStop>& stops) {
  std::vector<bool> kept(stops.size(), false);
  std::vector<std::size_t> order(stops.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto keep = [&](int most) {
    std::vector<int> seers(items, 0);
    for (const std::size_t n : order) {
      const std::vector<std::size_t>& its = stops[n].items;
      if (std::ranges::all_of(its, [&](std::size_t item) { return seers[item] >= most; })) continue;
      kept[n] = true;
      for (const std::size_t item : its) ++seers[item];
    }
  };
  std::ranges::stable_sort(order, std::greater<>{}, [&](std::size_t n) { return stops[n].items.size(); });
  keep(kMostSeers);
  std::vector<std::uint32_t> costs;
  for (const CoverStop& stop : stops) costs.push_back(situation.search.Cost(stop.place));
  std::ranges::stable_sort(order, {}, [&](std::size_t n) { return costs[n]; });
  keep(kNearSeers);
  std::vector<CoverStop> few;
  for (std::size_t n = 0; n < stops.size(); ++n) {
    if (kept[n]) few.push_back(std::move(stops[n]));
  }
  stops = std::move(few);
}

}  // namespace thalweg::explorer
