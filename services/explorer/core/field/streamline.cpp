#include "services/explorer/core/field/streamline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "common/voxel/ray.h"

namespace thalweg::explorer {
namespace {

/// After this length without a new lowest cell, the trace follows cells instead of the gradient.
constexpr double kPatienceCells = 8.0;
constexpr double kShortestStep = 1.0 / 8.0;
constexpr double kWallGap = 1e-3;
/// Largest effect of rounding on phi beside a weak sink.
constexpr float kRounding = 1e-3F;

class Tracer {
 public:
  Tracer(const DenseGrid<FieldCell>& cells, const DenseGrid<float>& phi, double cell_size, bool upward,
         const StreamlineOptions& options)
      : cells_(cells),
        phi_(phi),
        cell_size_(cell_size),
        sign_(upward ? -1.0F : 1.0F),
        upwards_(upward),
        options_(options) {}

  Streamline Trace(const Eigen::Vector3d& start_W) {
    line_.points_W.push_back(start_W);
    const VoxelIndex start = VoxelAt(start_W, cell_size_);
    if (!Open(start)) return line_;
    lowest_ = Height(start);
    for (;;) {
      const VoxelIndex here = VoxelAt(line_.points_W.back(), cell_size_);
      if (AtTarget(here)) {
        line_.end = StreamlineEnd::kArrived;
        return line_;
      }
      if (length_cells_ > options_.max_length_cells) {
        line_.end = StreamlineEnd::kTooLong;
        return line_;
      }
      const bool led_by_gradient =
          !AtOrigin(here) && since_lowest_cells_ <= kPatienceCells && (Step() || Slide());
      if (!led_by_gradient && !(AtOrigin(here) ? LeaveOrigin(here) : Descend(here))) return line_;
    }
  }

 private:
  bool Open(const VoxelIndex& i) const { return cells_.Get(i, FieldCell::kWall) != FieldCell::kWall; }
  /// phi, negated for upward traces, so that every trace leads down.
  float Height(const VoxelIndex& i) const { return sign_ * phi_[i]; }

  bool AtTarget(const VoxelIndex& i) const {
    return upwards_ ? cells_[i] == FieldCell::kSource : IsSink(cells_[i]);
  }
  bool AtOrigin(const VoxelIndex& i) const {
    return upwards_ ? IsSink(cells_[i]) : cells_[i] == FieldCell::kSource;
  }

  /// Whether a cell is lower than every cell so far. A target other than a weak sink always counts, because
  /// next to it phi may be equal to its own up to rounding; a weak sink may lie higher than the trace has
  /// come, and then does not count.
  bool IsLower(const VoxelIndex& i) const {
    if (!AtTarget(i)) return Height(i) < lowest_;
    return cells_[i] != FieldCell::kWeakSink || Height(i) < lowest_ + kRounding;
  }

  bool SegmentOpen(const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W) const {
    return TraverseVoxels(from_W, to_W, cell_size_, [this](const VoxelIndex& i) { return Open(i); });
  }

  void Append(const Eigen::Vector3d& p_W) {
    const double length = (p_W - line_.points_W.back()).norm() / cell_size_;
    line_.points_W.push_back(p_W);
    length_cells_ += length;
    since_lowest_cells_ += length;
    const float height = Height(VoxelAt(p_W, cell_size_));
    if (height < lowest_) {
      lowest_ = height;
      since_lowest_cells_ = 0.0;
    }
  }

  /// Unit vector of steepest descent of the trilinear interpolation between cell centers; empty in walls and
  /// where there is no slope. Corners behind a wall mirror the value on this side.
  std::optional<Eigen::Vector3d> Direction(const Eigen::Vector3d& p_W) const {
    const VoxelIndex here = VoxelAt(p_W, cell_size_);
    if (!Open(here)) return std::nullopt;
    const Eigen::Vector3d offset = (p_W - VoxelCenter(here, cell_size_)) / cell_size_;
    const int side[3] = {offset.x() < 0.0 ? -1 : 1, offset.y() < 0.0 ? -1 : 1, offset.z() < 0.0 ? -1 : 1};
    std::array<double, 8> value{};
    std::array<bool, 8> reached{};
    for (unsigned corner = 0; corner < 8; ++corner) {
      const VoxelIndex i = here + VoxelIndex{(corner & 1) != 0 ? side[0] : 0, (corner & 2) != 0 ? side[1] : 0,
                                             (corner & 4) != 0 ? side[2] : 0};
      double mirrored = 0.0;
      int neighbors = 0;
      bool linked = corner == 0;
      for (unsigned axis = 0; axis < 3; ++axis) {
        if ((corner >> axis & 1U) == 0) continue;
        const unsigned nearer = corner ^ (1U << axis);
        mirrored += value[nearer];
        linked |= reached[nearer];
        ++neighbors;
      }
      reached[corner] = linked && Open(i);
      value[corner] = reached[corner] ? static_cast<double>(Height(i)) : mirrored / neighbors;
    }
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (unsigned axis = 0; axis < 3; ++axis) {
      const unsigned a = (axis + 1) % 3;
      const unsigned b = (axis + 2) % 3;
      for (unsigned k = 0; k < 4; ++k) {
        const unsigned corner = (k & 1U) << a | (k >> 1) << b;
        const double weight = ((k & 1U) != 0 ? std::abs(offset[a]) : 1.0 - std::abs(offset[a])) *
                              ((k & 2U) != 0 ? std::abs(offset[b]) : 1.0 - std::abs(offset[b]));
        gradient[axis] += side[axis] * weight * (value[corner | 1U << axis] - value[corner]);
      }
    }
    const double norm = gradient.norm();
    if (!(norm > 0.0)) return std::nullopt;
    return -gradient / norm;
  }

  /// Makes a Runge-Kutta step, shortened where the full step would leave free space.
  bool Step() {
    const Eigen::Vector3d& p_W = line_.points_W.back();
    for (double share = 1.0; share >= kShortestStep; share /= 2.0) {
      const double step = share * options_.step_cells * cell_size_;
      const auto k1 = Direction(p_W);
      if (!k1) return false;
      const auto k2 = Direction(p_W + 0.5 * step * *k1);
      const auto k3 = k2 ? Direction(p_W + 0.5 * step * *k2) : std::nullopt;
      const auto k4 = k3 ? Direction(p_W + step * *k3) : std::nullopt;
      if (!k4) continue;
      const Eigen::Vector3d next_W = p_W + step / 6.0 * (*k1 + 2.0 * *k2 + 2.0 * *k3 + *k4);
      if ((next_W - p_W).norm() < 0.1 * step) return false;  // turns back on itself: a valley floor
      if (!SegmentOpen(p_W, next_W)) continue;
      Append(next_W);
      return true;
    }
    return false;
  }

  /// Makes a straight step whose components toward walls end in front of them.
  bool Slide() {
    const Eigen::Vector3d& p_W = line_.points_W.back();
    const auto direction = Direction(p_W);
    if (!direction) return false;
    const VoxelIndex here = VoxelAt(p_W, cell_size_);
    const int index[3] = {here.x, here.y, here.z};
    Eigen::Vector3d next_W = p_W + options_.step_cells * cell_size_ * *direction;
    for (int axis = 0; axis < 3; ++axis) {
      VoxelIndex beyond = here;
      (axis == 0 ? beyond.x : axis == 1 ? beyond.y : beyond.z) += (*direction)[axis] < 0.0 ? -1 : 1;
      if (Open(beyond)) continue;
      next_W[axis] = std::clamp(next_W[axis], (index[axis] + kWallGap) * cell_size_,
                                (index[axis] + 1 - kWallGap) * cell_size_);
    }
    const double shortest = kShortestStep * options_.step_cells * cell_size_;
    if ((next_W - p_W).norm() < shortest || !SegmentOpen(p_W, next_W)) return false;
    Append(next_W);
    return true;
  }

  /// For each cell found, the cell from which it was found.
  using Search = std::unordered_map<VoxelIndex, VoxelIndex, VoxelIndexHash>;

  /// Moves from cell to cell to the nearest one lower than all before. In a harmonic field, a free cell that
  /// is not higher than any neighbor lies on a plateau; this finds its far side.
  bool Descend(const VoxelIndex& here) {
    Search from{{here, here}};
    std::vector<VoxelIndex> queue{here};
    for (std::size_t k = 0; k < queue.size(); ++k) {
      std::optional<VoxelIndex> best;
      for (const VoxelIndex& d : kFaceNeighbors) {
        const VoxelIndex next = queue[k] + d;
        if (!Open(next) || !from.emplace(next, queue[k]).second) continue;
        queue.push_back(next);
        if (IsLower(next) && (!best || Height(next) < Height(*best))) best = next;
      }
      if (best) return Walk(from, *best);
    }
    return false;
  }

  /// Leaves the source (upward: the sink) through the face with the steepest slope.
  bool LeaveOrigin(const VoxelIndex& here) {
    Search from{{here, here}};
    std::vector<VoxelIndex> queue{here};
    std::optional<VoxelIndex> best;
    for (std::size_t k = 0; k < queue.size(); ++k) {
      for (const VoxelIndex& d : kFaceNeighbors) {
        const VoxelIndex next = queue[k] + d;
        if (!Open(next) || !from.emplace(next, queue[k]).second) continue;
        if (AtOrigin(next)) {
          queue.push_back(next);
        } else if (IsLower(next) && (!best || Height(next) < Height(*best))) {
          best = next;
        }
      }
    }
    return best ? Walk(from, *best) : Descend(here);
  }

  bool Walk(const Search& from, const VoxelIndex& goal) {
    std::vector<VoxelIndex> path{goal};
    while (!(from.at(path.back()) == path.back())) path.push_back(from.at(path.back()));
    for (auto it = path.rbegin(); it != path.rend(); ++it) {
      const Eigen::Vector3d center_W = VoxelCenter(*it, cell_size_);
      if (center_W != line_.points_W.back()) Append(center_W);
      if (AtTarget(*it)) break;
    }
    return true;
  }

  const DenseGrid<FieldCell>& cells_;
  const DenseGrid<float>& phi_;
  double cell_size_;
  float sign_;
  bool upwards_;
  StreamlineOptions options_;
  Streamline line_;
  float lowest_ = 0.0F;  ///< Lowest cell so far. Every detour ends below it, so the trace terminates.
  double length_cells_ = 0.0;
  double since_lowest_cells_ = 0.0;
};

}  // namespace

Streamline TraceStreamline(const DenseGrid<FieldCell>& cells, const DenseGrid<float>& phi, double cell_size,
                           const Eigen::Vector3d& start_W, bool upward, const StreamlineOptions& options) {
  return Tracer(cells, phi, cell_size, upward, options).Trace(start_W);
}

}  // namespace thalweg::explorer
