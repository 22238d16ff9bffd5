#include "services/explorer/core/field/sealed_field.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_set>

#include "common/voxel/for_each_voxel.h"

namespace thalweg::explorer {
namespace {

/// A cell is still when less than one of these shares of the total flux passes through each of its faces. The
/// largest share finds dead ends up to their doors. Where it merges them with a large hall, in which little
/// flux passes through any single face, a smaller share still separates them.
constexpr double kStillShares[] = {3e-3, 3e-4, 3e-5};
/// A part is opened when the estimated flux from entrance to entrance exceeds `flux_share` times this factor.
constexpr double kSlack = 2.0;
/// Share of the total flux that may enter and leave by the same entrance. A stream that passes a door reaches
/// into the room; sealing the room hardly changes the field beside the door.
constexpr double kPassingShare = 0.02;
/// As kPassingShare, for the estimate, which overestimates by a factor of twenty and more.
constexpr double kPassingEstimate = 0.5;
constexpr int kJoined = 3;  // cells

/// Calls visit(offset) for the face neighbors inside the box of cell `i` at offset `k`.
template <class Grid, class Visitor>
void ForEachNeighbor(const Grid& grid, const VoxelIndex& i, std::size_t k, Visitor&& visit) {
  const VoxelBox& box = grid.box();
  const auto dy = static_cast<std::size_t>(grid.stride_y());
  const auto dz = static_cast<std::size_t>(grid.stride_z());
  if (i.x > box.min.x) visit(k - 1);
  if (i.x + 1 < box.max.x) visit(k + 1);
  if (i.y > box.min.y) visit(k - dy);
  if (i.y + 1 < box.max.y) visit(k + dy);
  if (i.z > box.min.z) visit(k - dz);
  if (i.z + 1 < box.max.z) visit(k + dz);
}

/// The largest difference over a face. Walls are NaN, which compares greater than nothing.
float DropAt(const DenseGrid<float>& phi, const VoxelIndex& i, std::size_t k) {
  float drop = 0.0F;
  ForEachNeighbor(phi, i, k, [&](std::size_t n) {
    const float difference = std::abs(phi[k] - phi[n]);
    if (difference > drop) drop = difference;
  });
  return drop;
}

}  // namespace

const DenseGrid<float>& SealedField::Solve(DenseGrid<FieldCell>& cells, const HarmonicField::Options& options,
                                           std::span<const VoxelIndex> paths) {
  Follow(cells.box());
  OpenWhatChanged(cells, paths);
  before_ = cells;
  Seal(cells);
  field_.Solve(cells, options);
  statistics_ = field_.statistics();
  if (OpenWhatIsInTheWay(Flux(cells))) {
    cells = before_;
    Seal(cells);
    field_.Solve(cells, options, phi());
    const FieldStatistics& again = field_.statistics();
    statistics_.unknowns = again.unknowns;
    statistics_.relative_residual = again.relative_residual;
    statistics_.iterations += again.iterations;
    statistics_.setup_ms += again.setup_ms;
    statistics_.solve_ms += again.solve_ms;
    statistics_.bytes_swept += again.bytes_swept;
  }
  if (options_.least_cells <= statistics_.unknowns) FindDeadEnds(cells, Flux(cells));
  return phi();
}

/// Total flux that leaves the sources.
double SealedField::Flux(const DenseGrid<FieldCell>& cells) const {
  const DenseGrid<float>& phi = field_.phi();
  double flux = 0.0;
  ForEachOpenRow(cells, [&](const VoxelIndex& begin, std::size_t first, std::size_t last) {
    VoxelIndex i = begin;
    for (std::size_t k = first; k < last; ++k, ++i.x) {
      if (cells[k] != FieldCell::kSource) continue;
      ForEachNeighbor(cells, i, k, [&](std::size_t n) {
        if (cells[n] == FieldCell::kFree) flux += 1.0 - static_cast<double>(phi[n]);
      });
    }
  });
  return flux;
}

/// Makes the grids cover `box`. Forgets what lay outside it; treats new cells as former walls.
void SealedField::Follow(const VoxelBox& box) {
  if (part_of_.box() == box) return;
  std::vector<bool> open(parts_.size(), false);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const auto inside = [&](const VoxelIndex& i) { return box.Contains(i); };
    const auto run_inside = [&](const Run& run) {
      return inside(run.first) && inside(run.first + VoxelIndex{run.length - 1, 0, 0});
    };
    open[p] = !std::all_of(parts_[p].runs.begin(), parts_[p].runs.end(), run_inside);
    for (const std::vector<VoxelIndex>& entrance : parts_[p].entrances) {
      open[p] = open[p] || !std::all_of(entrance.begin(), entrance.end(), inside);
    }
  }
  Open(open);
  DenseGrid<FieldCell> before(box, FieldCell::kWall);
  for (std::size_t k = 0; k < before.size(); ++k) {
    before[k] = before_.Get(before.IndexAt(k), FieldCell::kWall);
  }
  before_ = std::move(before);
  part_of_ = DenseGrid<std::int32_t>(box, kOpen);
  for (std::size_t p = 0; p < parts_.size(); ++p) Mark(parts_[p], static_cast<std::int32_t>(p));
}

void SealedField::OpenWhatChanged(const DenseGrid<FieldCell>& cells, std::span<const VoxelIndex> paths) {
  if (parts_.empty()) return;
  std::vector<bool> open(parts_.size(), false);
  const auto open_part_at = [&](const VoxelIndex& i) {
    const std::int32_t part = part_of_.Get(i, kOpen);
    if (part != kOpen) open[static_cast<std::size_t>(part)] = true;
  };
  const auto row = static_cast<std::size_t>(cells.box().size_x());
  for (std::size_t begin = 0; begin < cells.size(); begin += row) {
    if (std::memcmp(cells.data() + begin, before_.data() + begin, row * sizeof(FieldCell)) == 0) continue;
    for (std::size_t k = begin; k < begin + row; ++k) {
      if (cells[k] == before_[k]) continue;
      const VoxelIndex i = cells.IndexAt(k);
      open_part_at(i);
      if (before_[k] != FieldCell::kWall) continue;
      for (const VoxelIndex& d : kFaceNeighbors) open_part_at(i + d);
    }
  }
  for (const VoxelIndex& i : paths) open_part_at(i);
  Open(open);
}

/// @return Whether any part was opened.
bool SealedField::OpenWhatIsInTheWay(double flux) {
  std::vector<bool> open(parts_.size(), false);
  for (std::size_t p = 0; p < parts_.size(); ++p) open[p] = IsInTheWay(parts_[p], flux);
  Open(open);
  return std::find(open.begin(), open.end(), true) != open.end();
}

void SealedField::Seal(DenseGrid<FieldCell>& cells) const {
  for (const Part& part : parts_) {
    for (const Run& run : part.runs) {
      std::fill_n(cells.data() + cells.Offset(run.first), run.length, FieldCell::kWall);
    }
  }
}

std::vector<VoxelIndex> SealedField::sealed() const {
  std::vector<VoxelIndex> cells;
  cells.reserve(sealed_cells_);
  for (const Part& part : parts_) {
    for (const Run& run : part.runs) {
      for (int k = 0; k < run.length; ++k) cells.push_back(run.first + VoxelIndex{k, 0, 0});
    }
  }
  return cells;
}

void SealedField::Open(const std::vector<bool>& open) {
  if (std::find(open.begin(), open.end(), true) == open.end()) return;
  std::vector<Part> kept;
  sealed_cells_ = 0;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const std::int32_t now = open[p] ? kOpen : static_cast<std::int32_t>(kept.size());
    if (open[p] || now != static_cast<std::int32_t>(p)) Mark(parts_[p], now);
    if (open[p]) continue;
    sealed_cells_ += parts_[p].cells;
    kept.push_back(std::move(parts_[p]));
  }
  parts_ = std::move(kept);
}

void SealedField::FindDeadEnds(const DenseGrid<FieldCell>& cells, double flux) {
  if (!(flux > 0.0)) return;
  if (drop_.box() != cells.box()) drop_ = DenseGrid<float>(cells.box(), 0.0F);
  const DenseGrid<float>& phi = field_.phi();
  ForEachOpenRow(cells, [&](const VoxelIndex& begin, std::size_t first, std::size_t last) {
    VoxelIndex i = begin;
    for (std::size_t k = first; k < last; ++k, ++i.x) {
      if (cells[k] == FieldCell::kFree) drop_[k] = DropAt(phi, i, k);
    }
  });
  for (const double share : kStillShares) FindDeadEnds(cells, flux, static_cast<float>(share * flux));
}

void SealedField::FindDeadEnds(const DenseGrid<FieldCell>& cells, double flux, float still) {
  BeginLook(cells.box());
  ForEachOpenRow(cells, [&](const VoxelIndex&, std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      if (!IsStill(cells, k, still) || looked_at_[k] == look_) continue;
      Consider(cells, Grow(cells, k, still), flux);
    }
  });
}

void SealedField::Consider(const DenseGrid<FieldCell>& cells, const Pocket& pocket, double flux) {
  if (pocket.cells.size() < options_.least_cells || pocket.rim.empty()) return;
  if (pocket.rim_flux > kPassingShare * flux) return;
  Part part = PartOf(cells, pocket);
  if (part.entrances.size() > 1 && pocket.rim_flux > options_.flux_share * flux) return;
  if (IsInTheWay(part, flux)) return;
  Mark(part, static_cast<std::int32_t>(parts_.size()));
  sealed_cells_ += part.cells;
  parts_.push_back(std::move(part));
}

/// Starts a pass of the search: marks of the previous pass become invalid.
void SealedField::BeginLook(const VoxelBox& box) {
  if (looked_at_.box() != box) looked_at_ = DenseGrid<std::uint8_t>(box, 0);
  if (++look_ != 0) return;
  looked_at_.Fill(0);
  look_ = 1;
}

void SealedField::Mark(const Part& part, std::int32_t number) {
  for (const Run& run : part.runs) {
    std::fill_n(part_of_.data() + part_of_.Offset(run.first), run.length, number);
  }
}

/// All still cells connected to `seed`.
SealedField::Pocket SealedField::Grow(const DenseGrid<FieldCell>& cells, std::size_t seed, float still) {
  const DenseGrid<float>& phi = field_.phi();
  Pocket pocket;
  pocket.cells.push_back(seed);
  looked_at_[seed] = look_;
  for (std::size_t next = 0; next < pocket.cells.size(); ++next) {
    const std::size_t k = pocket.cells[next];
    ForEachNeighbor(cells, cells.IndexAt(k), k, [&](std::size_t n) {
      if (cells[n] == FieldCell::kWall || part_of_[n] != kOpen || looked_at_[n] == look_) return;
      if (IsStill(cells, n, still)) {
        looked_at_[n] = look_;
        pocket.cells.push_back(n);
      } else {
        pocket.rim.push_back(n);
        pocket.rim_flux += std::abs(static_cast<double>(phi[k]) - static_cast<double>(phi[n]));
      }
    });
  }
  std::sort(pocket.rim.begin(), pocket.rim.end());
  pocket.rim.erase(std::unique(pocket.rim.begin(), pocket.rim.end()), pocket.rim.end());
  return pocket;
}

/// Converts a pocket to a part. An entrance's rim may have gaps, so pieces nearer to each other than kJoined
/// are one.
SealedField::Part SealedField::PartOf(const DenseGrid<FieldCell>& cells, const Pocket& pocket) const {
  Part part;
  part.cells = pocket.cells.size();
  std::vector<std::size_t> sorted = pocket.cells;
  std::sort(sorted.begin(), sorted.end());
  const auto row = static_cast<std::size_t>(cells.box().size_x());
  std::size_t end = 0;  // of the last run
  for (const std::size_t n : sorted) {
    if (n == end && n % row != 0 && !part.runs.empty()) {
      ++part.runs.back().length;
    } else {
      part.runs.push_back({cells.IndexAt(n), 1});
    }
    end = n + 1;
  }
  std::unordered_set<std::size_t> left(pocket.rim.begin(), pocket.rim.end());
  for (const std::size_t first : pocket.rim) {
    if (left.erase(first) == 0) continue;
    std::vector<VoxelIndex> entrance{cells.IndexAt(first)};
    for (std::size_t next = 0; next < entrance.size(); ++next) {
      ForEachVoxel(CubeAround(entrance[next], kJoined), [&](const VoxelIndex& j) {
        if (cells.Contains(j) && left.erase(cells.Offset(j)) == 1) entrance.push_back(j);
      });
    }
    part.entrances.push_back(std::move(entrance));
  }
  return part;
}

/// Estimates the flux through a part, with half of its rim as inlet and half as outlet, and a body at least
/// as wide as it is long.
bool SealedField::IsInTheWay(const Part& part, double flux) const {
  double least_mean = 1.0;
  double greatest_mean = -1.0;
  double drop_within = 0.0;
  double rim = 0.0;
  for (const std::vector<VoxelIndex>& entrance : part.entrances) {
    double least = 1.0;
    double greatest = -1.0;
    double sum = 0.0;
    int count = 0;
    for (const VoxelIndex& i : entrance) {
      const double value = phi()[i];
      if (std::isnan(value)) continue;  // sealed or a wall by now
      least = std::min(least, value);
      greatest = std::max(greatest, value);
      sum += value;
      ++count;
    }
    if (count == 0) continue;
    rim += count;
    least_mean = std::min(least_mean, sum / count);
    greatest_mean = std::max(greatest_mean, sum / count);
    drop_within = std::max(drop_within, greatest - least);
  }
  const double drop_between = std::max(0.0, greatest_mean - least_mean);
  const double width = std::sqrt(rim / 2.0);
  const double conductance = std::max(width, rim * rim / (4.0 * static_cast<double>(part.cells)));
  return drop_between * conductance > kSlack * options_.flux_share * flux ||
         drop_within * width > kPassingEstimate * flux;
}

}  // namespace thalweg::explorer
