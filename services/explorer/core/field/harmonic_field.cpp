#include "services/explorer/core/field/harmonic_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "common/base/check.h"
#include "common/base/stopwatch.h"
#include "services/explorer/core/field/device/device_solver.h"
#include "services/explorer/core/field/fine_problem.h"
#include "services/explorer/core/field/multigrid.h"
#include "services/explorer/core/field/multigrid_constants.h"
#include "services/explorer/core/field/team.h"

namespace thalweg::explorer {
namespace {

using field::kFold;
using field::Team;

/// k^2
float ScreeningOf(const HarmonicField::Options& options) {
  const double k = options.screening_length_cells > 0.0 ? 1.0 / options.screening_length_cells : 0.0;
  return static_cast<float>(k * k);
}

}  // namespace

struct HarmonicField::State {
  field::FineProblem problem;
  field::Multigrid multigrid;
  const field::Kernels& kernels = field::BestKernels();
  /// phi = high + low: two floats hold more digits than one, so that the residual can fall below float's own
  /// precision.
  field::Buffer<float> high, low;
  field::Buffer<float> r, p, q;
  /// One term per plane, so that sums do not depend on the number of threads.
  std::vector<double> r_r, p_q, r_z;
  DenseGrid<float> phi;
  VoxelBox phi_box;  ///< phi is NaN everywhere outside it.
  FieldStatistics statistics;
  std::unique_ptr<field::device::DeviceSolver> gpu;
  std::string no_gpu;  ///< Why there is none, once that is known.

  bool SolveOnGpu(const DenseGrid<FieldCell>& cells, const Options& options);
  void Prepare(const DenseGrid<FieldCell>& cells, const Options& options, Team& team);
  void Guess(const DenseGrid<FieldCell>& cells, const DenseGrid<float>& warm);
  void Iterate(const DenseGrid<FieldCell>& cells, const Options& options, const DenseGrid<float>& warm,
               const Team::Member& member);
  enum class Low : std::uint8_t { kZero, kAny };
  double TrueResidual(Low low_is, const Team::Member& member);
  void FoldLow(const Team::Member& member);
  void Descend(float alpha, const Team::Member& member);
  double Turn(float alpha, float beta, const Team::Member& member);
  void WritePhi(const DenseGrid<FieldCell>& cells, Team& team);

  template <class PerPlane>
  void ForPlanes(const Team::Member& member, PerPlane&& work) {
    const auto [begin, end] = multigrid.PlanesOf(member);
    const field::Segments& s = problem.segments();
    for (auto plane = static_cast<std::size_t>(begin); plane < static_cast<std::size_t>(end); ++plane) {
      work(plane, s.list.data() + s.plane_begin[plane], s.list.data() + s.plane_begin[plane + 1]);
    }
  }
  static double Sum(const std::vector<double>& terms) {
    return std::accumulate(terms.begin(), terms.end(), 0.0);
  }
};

HarmonicField::HarmonicField() : state_(std::make_unique<State>()) {}
HarmonicField::HarmonicField(HarmonicField&&) noexcept = default;
HarmonicField& HarmonicField::operator=(HarmonicField&&) noexcept = default;
HarmonicField::~HarmonicField() = default;
const DenseGrid<float>& HarmonicField::phi() const {
  return state_->phi;
}
const VoxelBox& HarmonicField::open_box() const {
  return state_->phi_box;
}
const FieldStatistics& HarmonicField::statistics() const {
  return state_->statistics;
}

const DenseGrid<float>& HarmonicField::Solve(const DenseGrid<FieldCell>& cells, const Options& options,
                                             const DenseGrid<float>& warm) {
  THALWEG_CHECK(options.weak_sink > 0.0 && options.weak_sink <= 1.0);
  State& s = *state_;
  s.statistics = {};
  const bool automatic = options.solver == Solver::kAutomatic && cells.size() >= kCellsForGpu;
  if ((automatic || options.solver == Solver::kGpu) && s.SolveOnGpu(cells, options)) return s.phi;
  if (options.solver == Solver::kGpu) throw std::runtime_error(s.no_gpu);
  const Stopwatch preparing;
  Team team(options.threads);
  s.Prepare(cells, options, team);
  s.statistics.setup_ms = preparing.Milliseconds();

  const Stopwatch solving;
  if (s.problem.unknowns() > 0) {
    team.Run([&](const Team::Member& member) { s.Iterate(cells, options, warm, member); });
  }
  s.WritePhi(cells, team);
  s.statistics.solve_ms = solving.Milliseconds();
  return s.phi;
}

void HarmonicField::RequireGpu() {
  std::string why;
  if (!field::device::OpenDeviceSolver(why)) throw std::invalid_argument("solver GPU: " + why);
}

/// @return false if there is no GPU; `no_gpu` then says why. One that has failed is not tried again.
bool HarmonicField::State::SolveOnGpu(const DenseGrid<FieldCell>& cells, const Options& options) {
  if (!gpu && no_gpu.empty()) gpu = field::device::OpenDeviceSolver(no_gpu);
  if (!gpu) return false;
  const Stopwatch solving;
  if (phi.box() != cells.box()) phi = DenseGrid<float>(cells.box(), 0.0F);
  const VoxelBox& box = cells.box();
  const int size[3] = {box.size_x(), box.size_y(), box.size_z()};
  try {
    const auto outcome = gpu->Solve(reinterpret_cast<const std::uint8_t*>(cells.data()), size,
                                    {.relative_residual = options.relative_residual,
                                     .max_iterations = options.max_iterations,
                                     .screening = ScreeningOf(options),
                                     .weak_sink = static_cast<float>(-options.weak_sink)},
                                    phi.data());
    statistics.unknowns = outcome.unknowns;
    statistics.iterations = outcome.iterations;
    statistics.relative_residual = outcome.relative_residual;
  } catch (const std::length_error& too_large) {
    statistics.gpu_failure = too_large.what();
  } catch (const std::runtime_error& failed) {
    statistics.gpu_failure = no_gpu = failed.what();
    gpu.reset();
  }
  if (!statistics.gpu_failure.empty()) {
    phi = {};  // which part of it was written is not known
    if (options.solver == Solver::kGpu) throw std::runtime_error(statistics.gpu_failure);
    return false;
  }
  phi_box = field::OpenBox(cells);
  statistics.on_gpu = true;
  statistics.solve_ms = solving.Milliseconds();
  return true;
}

void HarmonicField::State::Prepare(const DenseGrid<FieldCell>& cells, const Options& options, Team& team) {
  problem.Build(cells, ScreeningOf(options), static_cast<float>(-options.weak_sink), team);
  statistics.unknowns = problem.unknowns();
  const std::size_t total = problem.layout().total;
  for (field::Buffer<float>* b : {&high, &low, &r, &p, &q}) b->Reset(total, team);
  for (std::vector<double>* v : {&r_r, &p_q, &r_z}) {
    v->assign(static_cast<std::size_t>(problem.layout().nz), 0.0);
  }
  team.ForParts(problem.layout().nz, total,
                [&](int begin, int end, int) { problem.WriteGiven(begin, end, high.data()); });
  if (problem.unknowns() > 0) multigrid.Build(problem, team);
}

/// Initializes with the former solution where there is one, otherwise with the value of the nearest cell that
/// has one.
void HarmonicField::State::Guess(const DenseGrid<FieldCell>& cells, const DenseGrid<float>& warm) {
  constexpr float kOpen = std::numeric_limits<float>::infinity();
  std::vector<std::size_t> open;
  problem.ForEachRow(0, problem.layout().nz, [&](std::size_t here, std::size_t in_grid, std::size_t length) {
    VoxelIndex i = cells.IndexAt(in_grid);
    for (std::size_t k = here; k < here + length; ++k, ++i.x) {
      if (!problem.Active(k)) continue;
      high[k] = warm.Get(i, kOpen);
      if (std::isfinite(high[k])) continue;
      high[k] = kOpen;
      open.push_back(k);
    }
  });
  const std::size_t strides[] = {1, problem.layout().stride_y, problem.layout().stride_z};
  std::vector<std::pair<std::size_t, float>> filled;
  do {
    filled.clear();
    std::erase_if(open, [&](std::size_t k) {
      for (const std::size_t stride : strides) {
        for (const std::size_t neighbor : {k + stride, k - stride}) {
          const bool valued = problem.Active(neighbor) ? high[neighbor] != kOpen : high[neighbor] != 0.0F;
          if (!valued) continue;
          filled.emplace_back(k, high[neighbor]);
          return true;
        }
      }
      return false;
    });
    for (const auto& [k, value] : filled) high[k] = value;
  } while (!filled.empty());
  for (const std::size_t k : open) high[k] = 0.0F;
}

/// r = b - A (high + low): A high in double precision, A low in single. @return r . r
double HarmonicField::State::TrueResidual(Low low_is, const Team::Member& member) {
  member.Wait();
  const float* const second = low_is == Low::kAny ? low.data() : nullptr;
  ForPlanes(member, [&](std::size_t plane, const field::Segment* first, const field::Segment* last) {
    r_r[plane] = kernels.true_residual(problem.Operator(), first, last, high.data(), second, r.data());
  });
  member.Wait();
  const double square = Sum(r_r);
  member.Wait();  // before another thread overwrites the terms
  return square;
}

/// high += low; low = 0. The next residual includes the rounding of that sum, so it does no harm.
void HarmonicField::State::FoldLow(const Team::Member& member) {
  member.Wait();
  ForPlanes(member, [&](std::size_t, const field::Segment* first, const field::Segment* last) {
    kernels.add(first, last, 1.0F, low.data(), high.data());
    for (const field::Segment* s = first; s != last; ++s) std::fill_n(low.data() + s->begin, s->length, 0.0F);
  });
}

/// low += alpha p
void HarmonicField::State::Descend(float alpha, const Team::Member& member) {
  if (alpha == 0.0F) return;
  ForPlanes(member, [&](std::size_t, const field::Segment* first, const field::Segment* last) {
    kernels.add(first, last, alpha, p.data(), low.data());
  });
}

/// low += alpha p; p = q + beta p; q = A p, in one sweep: a plane's product follows the directions of the
/// planes around it while they are in the cache. @return p . q
double HarmonicField::State::Turn(float alpha, float beta, const Team::Member& member) {
  const auto [begin, end] = multigrid.PlanesOf(member);
  const field::Segments& s = problem.segments();
  const auto first = [&s](int plane) {
    return s.list.data() + s.plane_begin[static_cast<std::size_t>(plane)];
  };
  Team::Pipeline(
      member, begin, end,
      [&](int plane) {
        kernels.direction(first(plane), first(plane + 1), alpha, beta, q.data(), low.data(), p.data());
      },
      [&](int plane) {
        p_q[static_cast<std::size_t>(plane)] =
            kernels.apply(problem.Operator(), first(plane), first(plane + 1), p.data(), q.data());
      });
  member.Wait();
  return Sum(p_q);
}

/// Preconditioned conjugate gradients for the correction `low` to `high`. The recursive residual is replaced
/// by the true one whenever it has dropped by kFold, and before the end, so that the reported residual is the
/// true one.
void HarmonicField::State::Iterate(const DenseGrid<FieldCell>& cells, const Options& options,
                                   const DenseGrid<float>& warm, const Team::Member& member) {
  const double b_b = TrueResidual(Low::kZero, member);
  double square = b_b;
  if (warm.size() > 0) {
    if (member.leads()) Guess(cells, warm);
    square = TrueResidual(Low::kZero, member);
  }
  const double goal = options.relative_residual * options.relative_residual * b_b;
  double fold_at = kFold * kFold * square;
  double r_z_before = 0.0;
  float alpha = 0.0F;    // of the step that r is still to make; 0 at the start
  float pending = 0.0F;  // of the step that low is still to make
  int iteration = 0;
  bool reached = square <= goal;
  while (!reached) {
    multigrid.Advance(member, alpha, q.data(), r.data(), r_r.data());
    square = Sum(r_r);
    if (square <= goal || square <= fold_at) {
      Descend(pending, member);
      pending = 0.0F;
      if (square <= goal) square = TrueResidual(Low::kAny, member);
      reached = square <= goal;
      if (reached) break;
      FoldLow(member);
      square = TrueResidual(Low::kZero, member);
      fold_at = kFold * kFold * square;
      multigrid.Advance(member, 0.0F, q.data(), r.data(), r_r.data());
    }
    if (iteration >= options.max_iterations) break;
    ++iteration;
    multigrid.Precondition(member, r.data(), q.data(), r_z.data());
    member.Wait();
    const double r_z_now = Sum(r_z);
    const double beta = iteration > 1 ? r_z_now / r_z_before : 0.0;
    r_z_before = r_z_now;
    const double p_q_now = Turn(pending, static_cast<float>(beta), member);
    pending = 0.0F;
    if (!(p_q_now > 0.0)) break;  // r is 0, or only rounding is left
    alpha = pending = static_cast<float>(r_z_now / p_q_now);
  }
  Descend(pending, member);
  if (!reached) square = TrueResidual(Low::kAny, member);
  if (member.leads()) {
    statistics.iterations = iteration;
    statistics.relative_residual = b_b > 0.0 ? std::sqrt(square / b_b) : 0.0;
    statistics.bytes_swept = iteration * multigrid.BytesAnIteration();
  }
}

/// Outside the problem's box all cells are walls, so values of a former solution there are cleared.
void HarmonicField::State::WritePhi(const DenseGrid<FieldCell>& cells, Team& team) {
  constexpr float kWallPhi = std::numeric_limits<float>::quiet_NaN();
  if (phi.box() != cells.box()) {
    phi = DenseGrid<float>(cells.box(), kWallPhi);
  } else if (phi_box != problem.box()) {
    for (int z = phi_box.min.z; z < phi_box.max.z; ++z) {
      for (int y = phi_box.min.y; y < phi_box.max.y; ++y) {
        std::fill_n(phi.data() + phi.Offset({phi_box.min.x, y, z}), phi_box.size_x(), kWallPhi);
      }
    }
  }
  phi_box = problem.box();
  team.ForParts(problem.layout().nz, problem.layout().total, [&](int begin, int end, int) {
    problem.ForEachRow(begin, end, [&](std::size_t here, std::size_t in_grid, std::size_t length) {
      const FieldCell* cell = cells.data() + in_grid;
      float* out = phi.data() + in_grid;
      for (std::size_t k = 0; k < length; ++k) {
        const float value = high[here + k] + low[here + k];
        out[k] = cell[k] == FieldCell::kWall ? kWallPhi : value;
      }
    });
  });
}

std::vector<double> HarmonicField::InflowOf(const DenseGrid<FieldCell>& cells, const DenseGrid<float>& phi,
                                            const DenseGrid<std::int32_t>& group, std::size_t count) {
  std::vector<double> inflow(count, 0.0);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (!IsSink(cells[k])) continue;
    const VoxelIndex i = cells.IndexAt(k);
    const std::int32_t g = group.Get(i, -1);
    if (g < 0 || static_cast<std::size_t>(g) >= count) continue;
    for (const VoxelIndex& d : kFaceNeighbors) {
      const FieldCell neighbor = cells.Get(i + d, FieldCell::kWall);
      if (neighbor != FieldCell::kFree && neighbor != FieldCell::kSource) continue;
      inflow[static_cast<std::size_t>(g)] += static_cast<double>(phi[i + d]) - static_cast<double>(phi[k]);
    }
  }
  return inflow;
}

}  // namespace thalweg::explorer
