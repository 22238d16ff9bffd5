#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "services/explorer/core/field/harmonic_field.h"

namespace thalweg::explorer {

/// Solves the field without those parts of explored space that it has shown to be dead ends, so that the cost
/// of a solve depends on the unexplored part of the map and not on its total size: the aim of the source
/// thesis's Algorithm 4 (isovolume.h), by a rule that holds for a converged field, too.
///
/// Where nothing flows, phi is constant. A connected part of such cells is sealed when it contains neither
/// source nor sink and the flux through its rim is at most `flux_share` of all that leaves the source. Sealed
/// cells are walls to the solver. A part is opened for good when anything in it changes, when a wall beside
/// it disappears, or when one of the given paths leads through it. It is also opened when, after a solve, phi
/// differs so much along its rim that more than `flux_share` would flow through it; the field is then solved
/// once more.
/// Threading: one thread owns it.
class SealedField {
 public:
  struct Options {
    double flux_share = 0.01;
    std::size_t least_cells = 1000;  ///< Smaller parts are not worth sealing.

    static Options Never() { return {.least_cells = std::numeric_limits<std::size_t>::max()}; }
  };

  SealedField() : SealedField(Options{}) {}
  explicit SealedField(const Options& options) : options_(options) {}

  /// @param cells  Sealed cells are turned into walls.
  /// @param paths  Cells that must be open, e.g. the shortest paths to the targets from which the field is to
  /// choose.
  /// @return phi for every cell; NaN in walls.
  const DenseGrid<float>& Solve(DenseGrid<FieldCell>& cells, const HarmonicField::Options& options,
                                std::span<const VoxelIndex> paths = {});

  const DenseGrid<float>& phi() const { return field_.phi(); }
  /// What the solve took, or both solves when parts had to be opened.
  const FieldStatistics& statistics() const { return statistics_; }
  std::size_t sealed_cells() const { return sealed_cells_; }
  std::size_t parts() const { return parts_.size(); }
  /// Every cell that is sealed now, that is, from the next solve on.
  std::vector<VoxelIndex> sealed() const;

 private:
  static constexpr std::int32_t kOpen = -1;
  /// Consecutive cells along x.
  struct Run {
    VoxelIndex first;
    int length;
  };
  /// A dead end. Stored as indices rather than offsets, because the box may grow.
  struct Part {
    std::vector<Run> runs;
    std::size_t cells = 0;
    std::vector<std::vector<VoxelIndex>> entrances;  ///< Open cells beside it, in connected pieces.
  };
  /// A candidate for a part during the search, stored as offsets.
  struct Pocket {
    std::vector<std::size_t> cells, rim;
    double rim_flux = 0.0;
  };

  double Flux(const DenseGrid<FieldCell>& cells) const;
  void Follow(const VoxelBox& box);
  void OpenWhatChanged(const DenseGrid<FieldCell>& cells, std::span<const VoxelIndex> paths);
  bool OpenWhatIsInTheWay(double flux);
  void Open(const std::vector<bool>& open);
  void Seal(DenseGrid<FieldCell>& cells) const;
  void FindDeadEnds(const DenseGrid<FieldCell>& cells, double flux);
  void FindDeadEnds(const DenseGrid<FieldCell>& cells, double flux, float still);
  void Consider(const DenseGrid<FieldCell>& cells, const Pocket& pocket, double flux);
  bool IsStill(const DenseGrid<FieldCell>& cells, std::size_t k, float still) const {
    return cells[k] == FieldCell::kFree && part_of_[k] == kOpen && drop_[k] <= still;
  }
  /// Calls visit(first cell, its offset, offset after the last) for each row that the field spans.
  template <class Visitor>
  void ForEachOpenRow(const DenseGrid<FieldCell>& cells, Visitor&& visit) const {
    const VoxelBox& box = field_.open_box();
    for (VoxelIndex begin = box.min; begin.z < box.max.z; ++begin.z) {
      for (begin.y = box.min.y; begin.y < box.max.y; ++begin.y) {
        const std::size_t first = cells.Offset(begin);
        visit(begin, first, first + static_cast<std::size_t>(box.size_x()));
      }
    }
  }
  void BeginLook(const VoxelBox& box);
  void Mark(const Part& part, std::int32_t number);
  Pocket Grow(const DenseGrid<FieldCell>& cells, std::size_t seed, float still);
  Part PartOf(const DenseGrid<FieldCell>& cells, const Pocket& pocket) const;
  bool IsInTheWay(const Part& part, double flux) const;

  Options options_;
  HarmonicField field_;
  FieldStatistics statistics_;
  std::vector<Part> parts_;
  std::size_t sealed_cells_ = 0;
  DenseGrid<std::int32_t> part_of_;    ///< Index into parts_; -1 = open.
  DenseGrid<FieldCell> before_;        ///< As given to the last Solve.
  DenseGrid<std::uint8_t> looked_at_;  ///< Equal to look_ if visited in this pass.
  std::uint8_t look_ = 0;
  DenseGrid<float> drop_;  ///< Largest difference of phi over a face of a free cell.
};

}  // namespace thalweg::explorer
