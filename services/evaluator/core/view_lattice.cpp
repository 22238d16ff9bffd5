#include "services/evaluator/core/view_lattice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "common/voxel/for_each_voxel.h"
#include "common/voxel/ray.h"

namespace thalweg::evaluator {
namespace {

constexpr int kReach = 2;  // [steps] between linked places, along each axis

using Set = DenseGrid<std::uint8_t>;

bool Inside(const Set& set, const VoxelIndex& a, const VoxelIndex& b) {
  return TraverseVoxels(VoxelCenter(a, 1.0), VoxelCenter(b, 1.0), 1.0,
                        [&](const VoxelIndex& voxel) { return set.Get(voxel, 0) != 0; });
}

/// [voxels]
double Distance(const VoxelIndex& a, const VoxelIndex& b) {
  const VoxelIndex d = a - b;
  return std::sqrt(static_cast<double>(d.x * d.x + d.y * d.y + d.z * d.z));
}

/// Whether a place of the lattice lies between two others that are that far apart.
bool PassesAnother(const VoxelIndex& d, int step) {
  const int common = std::gcd(std::gcd(d.x, d.y), d.z);
  return common > step && common % step == 0;
}

/// Spreads places over the set and assigns a place to each of its voxels.
class Spread {
 public:
  Spread(const Set& set, int step) : set_(set), step_(step), owner_(set.box(), -1) {}

  /// @return Whether there were at most `most` places.
  bool Run(std::size_t most) {
    std::size_t first = 0;
    while (first < set_.size() && set_[first] == 0) ++first;
    if (first == set_.size()) return true;
    const VoxelIndex anchor = set_.IndexAt(first);
    const auto on_lattice = [&](const VoxelIndex& i) {
      const VoxelIndex d = i - anchor;
      return d.x % step_ == 0 && d.y % step_ == 0 && d.z % step_ == 0;
    };
    for (std::size_t k = first; k < set_.size(); ++k) {
      if (set_[k] != 0 && on_lattice(set_.IndexAt(k))) places_.push_back(set_.IndexAt(k));
    }
    if (most > 0 && places_.size() > most) return false;
    for (std::size_t n = 0; n < places_.size(); ++n) owner_[places_[n]] = static_cast<std::int32_t>(n);
    for (std::size_t n = 0; n < places_.size(); ++n) Own(n);
    for (std::size_t k = first; k < set_.size(); ++k) {
      if (set_[k] == 0 || owner_[k] >= 0) continue;
      places_.push_back(set_.IndexAt(k));
      if (most > 0 && places_.size() > most) return false;
      Own(places_.size() - 1);
    }
    return true;
  }

  std::vector<VoxelIndex>& places() { return places_; }
  const DenseGrid<std::int32_t>& owner() const { return owner_; }

 private:
  void Own(std::size_t n) {
    ForEachVoxel(CubeAround(places_[n], (step_ + 1) / 2), [&](const VoxelIndex& i) {
      if (set_.Get(i, 0) == 0 || owner_[i] >= 0 || !Inside(set_, places_[n], i)) return;
      owner_[i] = static_cast<std::int32_t>(n);
    });
  }

  const Set& set_;
  int step_;
  std::vector<VoxelIndex> places_;
  DenseGrid<std::int32_t> owner_;
};

/// Links places through neighboring voxels of theirs where no segment links them.
void LinkThroughVoxels(const Set& set, const DenseGrid<std::int32_t>& owner, ViewLattice& lattice) {
  std::map<std::pair<std::size_t, std::size_t>, double> lengths;
  for (std::size_t k = 0; k < set.size(); ++k) {
    if (set[k] == 0) continue;
    const VoxelIndex voxel = set.IndexAt(k);
    for (const VoxelIndex& neighbor :
         {voxel + VoxelIndex{1, 0, 0}, voxel + VoxelIndex{0, 1, 0}, voxel + VoxelIndex{0, 0, 1}}) {
      if (set.Get(neighbor, 0) == 0 || owner[neighbor] == owner[k]) continue;
      const auto a = static_cast<std::size_t>(owner[k]);
      const auto b = static_cast<std::size_t>(owner[neighbor]);
      const double length = Distance(lattice.places[a], voxel) + 1.0 + Distance(neighbor, lattice.places[b]);
      const auto [entry, is_new] = lengths.try_emplace(std::minmax(a, b), length);
      if (!is_new) entry->second = std::min(entry->second, length);
    }
  }
  for (const auto& [ends, length] : lengths) {
    if (!lattice.graph.Connected(ends.first, ends.second)) {
      lattice.graph.Connect(ends.first, ends.second, length * lattice.voxel_size);
    }
  }
}

/// Links place n to those with a smaller index.
void LinkBySegments(const Set& set, std::size_t n, ViewLattice& lattice) {
  for (std::size_t other = 0; other < n; ++other) {
    const VoxelIndex d = lattice.places[n] - lattice.places[other];
    const int reach = kReach * lattice.step;
    if (std::abs(d.x) > reach || std::abs(d.y) > reach || std::abs(d.z) > reach) continue;
    if (PassesAnother(d, lattice.step) || !Inside(set, lattice.places[n], lattice.places[other])) continue;
    lattice.graph.Connect(n, other, Distance(lattice.places[n], lattice.places[other]) * lattice.voxel_size);
  }
}

}  // namespace

std::size_t ViewLattice::Add(const DenseGrid<std::uint8_t>& set, const VoxelIndex& voxel) {
  const auto found = std::find(places.begin(), places.end(), voxel);
  if (found != places.end()) return static_cast<std::size_t>(found - places.begin());
  places.push_back(voxel);
  graph.links.emplace_back();
  LinkBySegments(set, places.size() - 1, *this);
  return places.size() - 1;
}

ViewLattice LatticeOn(const DenseGrid<std::uint8_t>& set, double voxel_size, int min_step, std::size_t most) {
  if (min_step < 1) throw std::invalid_argument("the lattice's step must be at least one voxel");
  for (int step = min_step;; ++step) {
    Spread spread(set, step);
    const VoxelBox& box = set.box();
    const int largest = std::max({box.size_x(), box.size_y(), box.size_z()});
    if (!spread.Run(step >= largest ? 0 : most)) continue;
    ViewLattice lattice;
    lattice.places = std::move(spread.places());
    lattice.step = step;
    lattice.voxel_size = voxel_size;
    lattice.graph.links.resize(lattice.places.size());
    for (std::size_t n = 0; n < lattice.places.size(); ++n) LinkBySegments(set, n, lattice);
    LinkThroughVoxels(set, spread.owner(), lattice);
    return lattice;
  }
}

}  // namespace thalweg::evaluator
