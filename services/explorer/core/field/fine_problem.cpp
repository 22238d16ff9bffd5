#include "services/explorer/core/field/fine_problem.h"

#include <algorithm>
#include <numeric>

namespace thalweg::explorer::field {
namespace {

constexpr auto kFreeCode = static_cast<std::uint8_t>(FieldCell::kFree);
constexpr auto kSourceCode = static_cast<std::uint8_t>(FieldCell::kSource);
constexpr auto kSinkCode = static_cast<std::uint8_t>(FieldCell::kSink);
constexpr auto kWeakSinkCode = static_cast<std::uint8_t>(FieldCell::kWeakSink);

/// 1 for cells with given phi.
std::uint8_t Given(std::uint8_t code) {
  return code >= kSourceCode ? 1 : 0;
}
std::uint8_t Open(std::uint8_t code) {
  return code != 0 ? 1 : 0;
}

bool HoldsAny(const FieldCell* begin, std::size_t count) {
  unsigned any = 0;
  for (std::size_t x = 0; x < count; ++x) any |= static_cast<unsigned>(begin[x]);
  return any != static_cast<unsigned>(FieldCell::kWall);
}

}  // namespace

VoxelBox OpenBox(const DenseGrid<FieldCell>& cells) {
  const VoxelBox& box = cells.box();
  const auto row = static_cast<std::size_t>(box.size_x());
  VoxelBox open{box.max, box.min};
  std::size_t begin = 0;
  for (int z = box.min.z; z < box.max.z; ++z) {
    for (int y = box.min.y; y < box.max.y; ++y, begin += row) {
      const FieldCell* cell = cells.data() + begin;
      if (!HoldsAny(cell, row)) continue;
      open.min.y = std::min(open.min.y, y);
      open.max.y = std::max(open.max.y, y + 1);
      open.min.z = std::min(open.min.z, z);
      open.max.z = std::max(open.max.z, z + 1);
      const auto before = static_cast<std::size_t>(open.min.x - box.min.x);
      const auto after = static_cast<std::size_t>(open.max.x - box.min.x);
      for (std::size_t x = 0; x < std::min(before, row); ++x) {
        if (cell[x] != FieldCell::kWall) open.min.x = box.min.x + static_cast<int>(x);
        if (cell[x] != FieldCell::kWall) break;
      }
      for (std::size_t x = row; x > after; --x) {
        if (cell[x - 1] != FieldCell::kWall) open.max.x = box.min.x + static_cast<int>(x);
        if (cell[x - 1] != FieldCell::kWall) break;
      }
    }
  }
  if (open.min.y >= open.max.y) return {box.min, box.min};
  return open;
}

void FineProblem::Build(const DenseGrid<FieldCell>& cells, float screening, float weak_sink, Team& team) {
  box_ = OpenBox(cells);
  layout_ = Layout(box_.size_x(), box_.size_y(), box_.size_z());
  grid_begin_ = cells.Offset(box_.min);
  grid_stride_y_ = static_cast<std::size_t>(cells.stride_y());
  grid_stride_z_ = static_cast<std::size_t>(cells.stride_z());
  screening_ = screening;
  weak_sink_ = weak_sink;
  codes_.Reset(layout_.total, team);
  degree_.Reset(layout_.total, team);
  given_.Reset(layout_.total, team);
  degrees_.Reset(layout_.total / kChunk + 1, team);
  FindRuns(cells, team);
  JoinRuns(team);

  std::vector<std::uint8_t> touches(runs_.size(), 0);
  team.ForParts(layout_.nz, layout_.total, [&](int begin, int end, int) {
    for (std::size_t k = FirstRunOf(begin); k < FirstRunOf(end); ++k)
      touches[k] = CountFaces(runs_[k]) ? 1 : 0;
  });
  std::vector<std::uint8_t> reached(runs_.size(), 0);
  for (std::size_t k = 0; k < runs_.size(); ++k) {
    if (touches[k] != 0) reached[Root(k)] = 1;
  }
  unknowns_ = 0;
  for (std::size_t k = 0; k < runs_.size(); ++k) {
    if (reached[Root(k)] != 0) {
      unknowns_ += runs_[k].length;
    } else {
      std::memset(degree_.data() + runs_[k].begin, 0, runs_[k].length);
    }
  }
  FindSegments(team);
}

FineOperator FineProblem::Operator() const {
  FineOperator a{degrees_.data(),
                 static_cast<std::ptrdiff_t>(layout_.stride_y),
                 static_cast<std::ptrdiff_t>(layout_.stride_z),
                 {},
                 {}};
  for (int degree = 1; degree <= 6; ++degree) {
    a.diagonal[degree] = static_cast<float>(degree) + screening_;
    a.step[degree] = kRelaxation / a.diagonal[degree];
  }
  return a;
}

void FineProblem::WriteGiven(int begin, int end, float* phi) const {
  float given[kWeakSinkCode + 1] = {};
  given[kSourceCode] = 1.0F;
  given[kSinkCode] = -1.0F;
  given[kWeakSinkCode] = weak_sink_;
  ForEachRow(begin, end, [&](std::size_t here, std::size_t, std::size_t length) {
    for (std::size_t i = here; i < here + length; ++i) phi[i] = given[codes_[i]];
  });
}

/// Copies the cells and lists the runs of free ones.
void FineProblem::FindRuns(const DenseGrid<FieldCell>& cells, Team& team) {
  struct Part {
    std::vector<Run> runs;
    std::vector<std::size_t> row_begin;
  };
  std::vector<Part> parts(static_cast<std::size_t>(team.count()));
  team.ForParts(layout_.nz, layout_.total, [&](int begin, int end, int k) {
    Part& part = parts[static_cast<std::size_t>(k)];
    ForEachRow(begin, end, [&](std::size_t here, std::size_t in_grid, std::size_t length) {
      std::memcpy(codes_.data() + here, cells.data() + in_grid, length);
      part.row_begin.push_back(part.runs.size());
      const std::uint8_t* row = codes_.data() + here;
      for (std::size_t x = 0; x < length;) {
        while (x < length && row[x] != kFreeCode) ++x;
        const std::size_t first = x;
        while (x < length && row[x] == kFreeCode) ++x;
        if (x > first) part.runs.push_back({here + first, x - first});
      }
    });
  });
  runs_.clear();
  row_begin_.clear();
  for (const Part& part : parts) {
    for (const std::size_t first : part.row_begin) row_begin_.push_back(first + runs_.size());
    runs_.insert(runs_.end(), part.runs.begin(), part.runs.end());
  }
  row_begin_.push_back(runs_.size());
}

void FineProblem::JoinRuns(Team& team) {
  parent_.resize(runs_.size());
  std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  // Each part only joins its own runs; the parts are joined afterwards.
  std::vector<int> part_begin(static_cast<std::size_t>(team.count()), 0);
  team.ForParts(layout_.nz, layout_.total, [&](int begin, int end, int k) {
    part_begin[static_cast<std::size_t>(k)] = begin;
    const auto rows = static_cast<std::size_t>(layout_.ny);
    for (int z = begin; z < end; ++z) {
      const std::size_t row = static_cast<std::size_t>(z) * rows;
      for (std::size_t y = 1; y < rows; ++y) Join(row + y - 1, row + y, layout_.stride_y);
      if (z > begin) JoinPlanes(z);
    }
  });
  for (const int z : part_begin) {
    if (z > 0 && z < layout_.nz) JoinPlanes(z);
  }
}

/// Joins the runs of a plane with those of the plane below.
void FineProblem::JoinPlanes(int plane) {
  const auto rows = static_cast<std::size_t>(layout_.ny);
  for (std::size_t row = static_cast<std::size_t>(plane) * rows;
       row < static_cast<std::size_t>(plane + 1) * rows; ++row) {
    Join(row - rows, row, layout_.stride_z);
  }
}

/// Joins the runs of row a with adjacent runs of row b, which lies `stride` farther on.
void FineProblem::Join(std::size_t row_a, std::size_t row_b, std::size_t stride) {
  std::size_t a = row_begin_[row_a];
  std::size_t b = row_begin_[row_b];
  while (a < row_begin_[row_a + 1] && b < row_begin_[row_b + 1]) {
    const std::size_t begin_a = runs_[a].begin + stride;
    const std::size_t end_a = begin_a + runs_[a].length;
    const std::size_t begin_b = runs_[b].begin;
    const std::size_t end_b = begin_b + runs_[b].length;
    if (begin_a < end_b && begin_b < end_a) {
      const std::size_t root_a = Root(a);
      const std::size_t root_b = Root(b);
      if (root_a != root_b) parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
    }
    if (end_a < end_b) {
      ++a;
    } else {
      ++b;
    }
  }
}

std::size_t FineProblem::Root(std::size_t run) {
  while (parent_[run] != run) run = parent_[run] = parent_[parent_[run]];
  return run;
}

/// @return Whether any cell of the run has a neighbor with given phi.
bool FineProblem::CountFaces(const Run& run) {
  const std::uint8_t* c = codes_.data() + run.begin;
  std::uint8_t* degree = degree_.data() + run.begin;
  std::uint8_t* given = given_.data() + run.begin;
  const auto dy = static_cast<std::ptrdiff_t>(layout_.stride_y);
  const auto dz = static_cast<std::ptrdiff_t>(layout_.stride_z);
  std::uint8_t any = 0;
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(run.length); ++i) {
    degree[i] = static_cast<std::uint8_t>(Open(c[i - 1]) + Open(c[i + 1]) + Open(c[i - dy]) +
                                          Open(c[i + dy]) + Open(c[i - dz]) + Open(c[i + dz]));
    given[i] = static_cast<std::uint8_t>(Given(c[i - 1]) + Given(c[i + 1]) + Given(c[i - dy]) +
                                         Given(c[i + dy]) + Given(c[i - dz]) + Given(c[i + dz]));
    any |= given[i];
  }
  return any != 0;
}

void FineProblem::FindSegments(Team& team) {
  std::vector<Segments> parts(static_cast<std::size_t>(team.count()));
  team.ForParts(layout_.nz, layout_.total, [&](int begin, int end, int k) {
    Segments& part = parts[static_cast<std::size_t>(k)];
    AppendSegments(
        layout_, begin, end, [this](std::size_t i) { return degree_[i] > 0; }, part);
    for (const Segment& s : part.list) {
      for (std::size_t i = s.begin; i < s.begin + s.length; i += kChunk) {
        std::uint32_t word = 0;
        for (std::size_t n = 0; n < kChunk; ++n)
          word |= static_cast<std::uint32_t>(degree_[i + n]) << (4 * n);
        degrees_[i / kChunk] = word;
      }
    }
  });
  segments_ = Concatenate(parts);
}

}  // namespace thalweg::explorer::field
