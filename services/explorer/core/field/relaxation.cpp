#include "services/explorer/core/field/relaxation.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace thalweg::explorer {
namespace {

/// A free cell, and the cells whose mean it becomes: one may occur twice.
struct Row {
  std::uint32_t cell = 0;
  std::uint32_t count = 0;
  /// The one before it in the grid is the last, so that a sweep waits for its new value as late as possible.
  std::array<std::uint32_t, 6> neighbors{};
};

std::vector<Row> RowsOf(const DenseGrid<FieldCell>& cells, RelaxationOptions::Walls walls) {
  std::vector<Row> rows;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k] != FieldCell::kFree) continue;
    const VoxelIndex i = cells.IndexAt(k);
    Row row{.cell = static_cast<std::uint32_t>(k)};
    for (const std::size_t axis : {2U, 1U, 0U}) {
      const VoxelIndex up = i + kFaceNeighbors[2 * axis];
      const VoxelIndex down = i + kFaceNeighbors[2 * axis + 1];
      const bool up_open = cells.Get(up, FieldCell::kWall) != FieldCell::kWall;
      const bool down_open = cells.Get(down, FieldCell::kWall) != FieldCell::kWall;
      const auto add = [&](const VoxelIndex& neighbor) {
        row.neighbors[row.count++] = static_cast<std::uint32_t>(cells.Offset(neighbor));
      };
      const bool mirrored = walls == RelaxationOptions::Walls::kMirrored && up_open != down_open;
      if (up_open || (mirrored && down_open)) add(up_open ? up : down);
      if (down_open || (mirrored && up_open)) add(down_open ? down : up);
    }
    if (row.count > 0) rows.push_back(row);
  }
  return rows;
}

constexpr std::array<double, 7> kShare = {0.0, 1.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0, 1.0 / 5.0, 1.0 / 6.0};

double MeanOf(const Row& row, const double* phi) {
  const auto& at = row.neighbors;
  if (row.count == 6) {
    return (phi[at[0]] + phi[at[1]] + phi[at[2]] + phi[at[3]] + phi[at[4]] + phi[at[5]]) * kShare[6];
  }
  double sum = 0.0;
  for (std::uint32_t n = 0; n < row.count; ++n) sum += phi[at[n]];
  return sum * kShare[row.count];
}

/// Whether a value counts as changed. @param change  NaN never occurs.
bool Changed(double old_value, double new_value, const RelaxationOptions& options) {
  const double change = std::abs(new_value - old_value);
  const double beside = options.beside == RelaxationOptions::Beside::kOldValue ? std::abs(old_value) : 1.0;
  return change > 0.0 && change >= options.largest_change * beside;
}

}  // namespace

Relaxation Relax(const DenseGrid<FieldCell>& cells, const RelaxationOptions& options) {
  THALWEG_CHECK(cells.size() < std::numeric_limits<std::uint32_t>::max());
  Relaxation result{.phi = DenseGrid<double>(cells.box(), std::numeric_limits<double>::quiet_NaN())};
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k] == FieldCell::kWall) continue;
    result.phi[k] = cells[k] == FieldCell::kSource ? 1.0 : IsSink(cells[k]) ? -1.0 : 0.0;
  }
  const std::vector<Row> rows = RowsOf(cells, options.walls);
  DenseGrid<double> before;
  const bool jacobi = options.sweep == RelaxationOptions::Sweep::kJacobi;
  if (jacobi) before = result.phi;
  while (!result.stopped && result.sweeps < options.max_sweeps) {
    ++result.sweeps;
    if (jacobi) std::swap(before, result.phi);
    const double* const from = jacobi ? before.data() : result.phi.data();
    double* const to = result.phi.data();
    bool changed = false;
    for (const Row& row : rows) {
      const double old_value = from[row.cell];
      const double new_value = MeanOf(row, from);
      to[row.cell] = new_value;
      changed |= Changed(old_value, new_value, options);
    }
    result.stopped = !changed;
  }
  return result;
}

}  // namespace thalweg::explorer
