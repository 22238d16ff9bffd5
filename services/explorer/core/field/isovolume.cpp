#include "services/explorer/core/field/isovolume.h"

#include <algorithm>
#include <numeric>

namespace thalweg::explorer {
namespace {

/// Connected cells, merged as they are added; knows which components hold a sink.
class Components {
 public:
  explicit Components(std::size_t cells) : parent_(cells), has_sink_(cells, 0) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  bool HasSink(std::size_t k) { return has_sink_[Root(k)] != 0; }
  void SetSink(std::size_t k) { has_sink_[Root(k)] = 1; }
  void Join(std::size_t a, std::size_t b) {
    a = Root(a);
    b = Root(b);
    parent_[a] = b;
    has_sink_[b] |= has_sink_[a];
  }

 private:
  std::size_t Root(std::size_t k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }

  std::vector<std::size_t> parent_;
  std::vector<std::uint8_t> has_sink_;
};

}  // namespace

std::vector<VoxelIndex> FindIsovolume(const DenseGrid<FieldCell>& cells, const DenseGrid<double>& phi,
                                      const VoxelIndex& seed) {
  if (cells.Get(seed, FieldCell::kWall) == FieldCell::kWall) return {};
  DenseGrid<std::uint8_t> joined(cells.box(), 0);
  joined[seed] = 1;
  std::vector<VoxelIndex> isovolume = {seed};
  for (std::size_t n = 0; n < isovolume.size(); ++n) {
    const VoxelIndex i = isovolume[n];
    if (IsSink(cells[i])) return {};
    for (const VoxelIndex& step : kFaceNeighbors) {
      const VoxelIndex next = i + step;
      if (cells.Get(next, FieldCell::kWall) == FieldCell::kWall) continue;
      if (joined[next] != 0 || phi[next] > phi[seed]) continue;
      joined[next] = 1;
      isovolume.push_back(next);
    }
  }
  return isovolume;
}

DenseGrid<std::uint8_t> AllIsovolumes(const DenseGrid<FieldCell>& cells, const DenseGrid<double>& phi) {
  std::vector<std::size_t> rising;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k] != FieldCell::kWall) rising.push_back(k);
  }
  std::ranges::stable_sort(rising, {}, [&](std::size_t k) { return phi[k]; });
  DenseGrid<std::uint8_t> found(cells.box(), 0);
  DenseGrid<std::uint8_t> added(cells.box(), 0);
  Components components(cells.size());
  for (auto begin = rising.begin(); begin != rising.end();) {
    const double level = phi[*begin];
    const auto end = std::find_if(begin, rising.end(), [&](std::size_t k) { return phi[k] > level; });
    for (auto at = begin; at != end; ++at) {
      added[*at] = 1;
      if (IsSink(cells[*at])) components.SetSink(*at);
      for (const VoxelIndex& step : kFaceNeighbors) {
        const VoxelIndex next = cells.IndexAt(*at) + step;
        if (added.Get(next, 0) != 0) components.Join(*at, cells.Offset(next));
      }
    }
    for (; begin != end; ++begin) found[*begin] = components.HasSink(*begin) ? 0 : 1;
  }
  return found;
}

}  // namespace thalweg::explorer
