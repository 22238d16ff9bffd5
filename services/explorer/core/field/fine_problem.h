#pragma once

#include <cstdint>
#include <vector>

#include "services/explorer/core/field/harmonic_field.h"
#include "services/explorer/core/field/kernels.h"
#include "services/explorer/core/field/layout.h"
#include "services/explorer/core/field/team.h"

namespace thalweg::explorer::field {

/// The smallest box that contains all cells other than walls; empty when there are none.
VoxelBox OpenBox(const DenseGrid<FieldCell>& cells);

/// The discrete problem on the voxel grid: which cells are unknowns, and what lies beyond their faces.
class FineProblem {
 public:
  /// Finds the unknowns: free cells that a path of free cells connects to a source or a sink. The problem
  /// spans the smallest box that contains all cells other than walls.
  /// @param weak_sink  phi of weak sinks.
  void Build(const DenseGrid<FieldCell>& cells, float screening, float weak_sink, Team& team);

  const Layout& layout() const { return layout_; }
  const VoxelBox& box() const { return box_; }
  const Segments& segments() const { return segments_; }
  std::size_t unknowns() const { return unknowns_; }
  FineOperator Operator() const;

  bool Active(std::size_t i) const { return degree_[i] > 0; }
  float Diagonal(std::size_t i) const {
    return degree_[i] > 0 ? static_cast<float>(degree_[i]) + screening_ : 0.0F;
  }
  /// Weight of the face toward the neighbor `stride` farther on.
  float Weight(int /*axis*/, std::size_t i, std::size_t stride) const {
    return degree_[i] > 0 && degree_[i + stride] > 0 ? 1.0F : 0.0F;
  }
  /// Number of faces to cells with given phi.
  float Slack(std::size_t i) const { return static_cast<float>(given_[i]); }
  float Mass(std::size_t i) const { return degree_[i] > 0 ? screening_ : 0.0F; }

  /// Writes phi of sources and sinks, and 0 elsewhere, for planes [begin, end).
  void WriteGiven(int begin, int end, float* phi) const;
  /// Calls visit(offset here, offset in the grid, length) for each row of planes [begin, end).
  template <class Visitor>
  void ForEachRow(int begin, int end, Visitor&& visit) const {
    for (int z = begin; z < end; ++z) {
      std::size_t in_grid = grid_begin_ + static_cast<std::size_t>(z) * grid_stride_z_;
      for (int y = 0; y < layout_.ny; ++y, in_grid += grid_stride_y_) {
        visit(layout_.Row(y, z), in_grid, static_cast<std::size_t>(layout_.nx));
      }
    }
  }

 private:
  /// Consecutive free cells of one row.
  struct Run {
    std::size_t begin;
    std::size_t length;
  };
  void FindRuns(const DenseGrid<FieldCell>& cells, Team& team);
  void JoinRuns(Team& team);
  void JoinPlanes(int plane);
  void Join(std::size_t row_a, std::size_t row_b, std::size_t stride);
  std::size_t Root(std::size_t run);
  bool CountFaces(const Run& run);
  void FindSegments(Team& team);
  /// Index of the first run of plane z; for the plane after the last one, the number of runs.
  std::size_t FirstRunOf(int z) const { return row_begin_[static_cast<std::size_t>(z * layout_.ny)]; }

  VoxelBox box_;
  std::size_t grid_begin_ = 0, grid_stride_y_ = 0, grid_stride_z_ = 0;  ///< Layout of box_ in the grid.
  Layout layout_;
  float screening_ = 0.0F;
  float weak_sink_ = 0.0F;
  Buffer<std::uint8_t> codes_;  ///< FieldCell; the margin consists of walls.
  Buffer<std::uint8_t> degree_;
  Buffer<std::uint8_t> given_;     ///< How many of the faces counted in degree_ lead to sources and sinks.
  Buffer<std::uint32_t> degrees_;  ///< degree_, packed for the sweeps.
  std::vector<Run> runs_;
  std::vector<std::size_t> row_begin_;  ///< First run of each row of each plane, plus one entry at the end.
  std::vector<std::size_t> parent_;     ///< Union-find over runs.
  Segments segments_;
  std::size_t unknowns_ = 0;
};

/// Appends the segments that cover all cells of planes [begin, end) for which active(offset) holds.
template <class Active>
void AppendSegments(const Layout& layout, int begin, int end, Active&& active, Segments& out) {
  const Layout halved = layout.Halved();
  for (int z = begin; z < end; ++z) {
    out.plane_begin.push_back(out.list.size());
    for (int y = 0; y < layout.ny; ++y) {
      const std::size_t row = layout.Row(y, z);
      const std::size_t coarse = halved.Row(y / 2, z / 2);
      bool open = false;
      for (std::size_t x = 0; x < static_cast<std::size_t>(layout.nx); x += kChunk) {
        bool any = false;
        for (std::size_t k = 0; k < kChunk; ++k) any |= active(row + x + k);
        if (any && open) out.list.back().length += kChunk;
        if (any && !open) out.list.push_back({row + x, coarse + x / 2, kChunk});
        open = any;
      }
    }
  }
}

/// Joins the lists found by the threads in the order of the planes.
inline Segments Concatenate(const std::vector<Segments>& parts) {
  Segments all;
  for (const Segments& part : parts) {
    for (const std::size_t begin : part.plane_begin) all.plane_begin.push_back(begin + all.list.size());
    all.list.insert(all.list.end(), part.list.begin(), part.list.end());
  }
  all.plane_begin.push_back(all.list.size());
  return all;
}

}  // namespace thalweg::explorer::field
