#include "services/explorer/core/field/fine_problem.h"

#include <numeric>

namespace thalweg::explorer::field {
namespace {

constexpr auto kFreeCode = static_cast<std::uint8_t>(FieldCell::kFree);
constexpr auto kSourceCode = static_cast<std::uint8_t>(FieldCell::kSource);
constexpr auto kSinkCode = static_cast<std::uint8_t>(FieldCell::kSink);

/// 1 for cells of given phi.
std::uint8_t Given(std::uint8_t code) {
  return code >= kSourceCode ? 1 : 0;
}
std::uint8_t Open(std::uint8_t code) {
  return code != 0 ? 1 : 0;
}

}  // namespace

void FineProblem::Build(const DenseGrid<FieldCell>& cells, float screening) {
  const VoxelBox& box = cells.box();
  layout_ = Layout(box.size_x(), box.size_y(), box.size_z());
  screening_ = screening;
  codes_.Reset(layout_.total);
  degree_.Reset(layout_.total);
  ForEachRow([&](std::size_t here, std::size_t in_grid, std::size_t length) {
    std::memcpy(codes_.data() + here, cells.data() + in_grid, length);
  });
  FindRuns();
  JoinRuns();

  std::vector<std::uint8_t> reached(runs_.size(), 0);
  for (std::size_t k = 0; k < runs_.size(); ++k) {
    if (!reached[Root(k)] && TouchesGiven(runs_[k])) reached[Root(k)] = 1;
  }
  unknowns_ = 0;
  for (std::size_t k = 0; k < runs_.size(); ++k) {
    if (!reached[Root(k)]) continue;
    unknowns_ += runs_[k].length;
    CountFaces(runs_[k]);
  }
  segments_.list.clear();
  segments_.plane_begin.clear();
  AppendSegments(
      layout_, 0, layout_.nz, [this](std::size_t i) { return degree_[i] > 0; }, segments_);
  segments_.plane_begin.push_back(segments_.list.size());
  degrees_.Reset(layout_.total / kChunk);
  for (const Segment& s : segments_.list) {
    for (std::size_t i = s.begin; i < s.begin + s.length; ++i) {
      degrees_[i / kChunk] |= static_cast<std::uint32_t>(degree_[i]) << (i % kChunk * 4);
    }
  }
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

float FineProblem::Slack(std::size_t i) const {
  if (degree_[i] == 0) return 0.0F;
  const std::size_t dy = layout_.stride_y;
  const std::size_t dz = layout_.stride_z;
  return static_cast<float>(Given(codes_[i - 1]) + Given(codes_[i + 1]) + Given(codes_[i - dy]) +
                            Given(codes_[i + dy]) + Given(codes_[i - dz]) + Given(codes_[i + dz]));
}

void FineProblem::WriteGiven(float* phi) const {
  for (std::size_t i = 0; i < layout_.total; ++i) {
    phi[i] = codes_[i] == kSourceCode ? 1.0F : codes_[i] == kSinkCode ? -1.0F : 0.0F;
  }
}

void FineProblem::FindRuns() {
  runs_.clear();
  row_begin_.clear();
  ForEachRow([&](std::size_t here, std::size_t, std::size_t length) {
    row_begin_.push_back(runs_.size());
    const std::uint8_t* row = codes_.data() + here;
    for (std::size_t x = 0; x < length;) {
      while (x < length && row[x] != kFreeCode) ++x;
      const std::size_t begin = x;
      while (x < length && row[x] == kFreeCode) ++x;
      if (x > begin) runs_.push_back({here + begin, x - begin});
    }
  });
  row_begin_.push_back(runs_.size());
  parent_.resize(runs_.size());
  std::iota(parent_.begin(), parent_.end(), std::size_t{0});
}

void FineProblem::JoinRuns() {
  const auto rows_a_plane = static_cast<std::size_t>(layout_.ny);
  for (std::size_t row = 0; row + 1 < row_begin_.size(); ++row) {
    const std::size_t first = row_begin_[row];
    const std::size_t last = row_begin_[row + 1];
    if (row % rows_a_plane != 0) Join(row_begin_[row - 1], first, first, last, layout_.stride_y);
    if (row >= rows_a_plane) {
      const std::size_t below = row - rows_a_plane;
      Join(row_begin_[below], row_begin_[below + 1], first, last, layout_.stride_z);
    }
  }
}

/// Joins the runs a with the runs b, `stride` further, that lie beside them.
void FineProblem::Join(std::size_t first_a, std::size_t last_a, std::size_t first_b, std::size_t last_b,
                       std::size_t stride) {
  std::size_t a = first_a;
  std::size_t b = first_b;
  while (a < last_a && b < last_b) {
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

bool FineProblem::TouchesGiven(const Run& run) const {
  const std::uint8_t* c = codes_.data() + run.begin;
  const auto dy = static_cast<std::ptrdiff_t>(layout_.stride_y);
  const auto dz = static_cast<std::ptrdiff_t>(layout_.stride_z);
  const auto length = static_cast<std::ptrdiff_t>(run.length);
  std::uint8_t any = c[-1] | c[length];
  for (std::ptrdiff_t i = 0; i < length; ++i) any |= c[i - dy] | c[i + dy] | c[i - dz] | c[i + dz];
  return (any & (kSourceCode & kSinkCode)) != 0;  // the bit that both have and free cells have not
}

void FineProblem::CountFaces(const Run& run) {
  const std::uint8_t* c = codes_.data() + run.begin;
  std::uint8_t* degree = degree_.data() + run.begin;
  const auto dy = static_cast<std::ptrdiff_t>(layout_.stride_y);
  const auto dz = static_cast<std::ptrdiff_t>(layout_.stride_z);
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(run.length); ++i) {
    degree[i] = static_cast<std::uint8_t>(Open(c[i - 1]) + Open(c[i + 1]) + Open(c[i - dy]) +
                                          Open(c[i + dy]) + Open(c[i - dz]) + Open(c[i + dz]));
  }
}

}  // namespace thalweg::explorer::field
