/// Repeats on fields of our own what the source thesis reports of its solver [Shade: Choosing Where To Go,
/// DPhil thesis, Oxford 2011, Ch. 6]: how its sweeps converge beside other solvers (Fig. 6.12), how far its
/// three integrators stray (Fig. 6.14), and what Algorithm 4 finds. Prints three tables.
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "services/explorer/core/field/descent.h"
#include "services/explorer/core/field/isovolume.h"
#include "services/explorer/core/field/relaxation.h"
#include "tests/support/random_maps.h"

namespace thalweg::explorer {
namespace {

using testing::FieldMap;
using Sweep = RelaxationOptions::Sweep;
using Walls = RelaxationOptions::Walls;
using Phi = DenseGrid<double>;

/// A plan of 100 x 100 cells: three rooms in a row, the robot in the first, a frontier along the last wall.
FieldMap ThreeRooms() {
  FieldMap map({{0, 0, 0}, {100, 100, 1}}, FieldCell::kFree);
  testing::FillBox(map, {{33, 0, 0}, {35, 80, 1}}, FieldCell::kWall);
  testing::FillBox(map, {{66, 20, 0}, {68, 100, 1}}, FieldCell::kWall);
  map[{15, 15, 0}] = FieldCell::kSource;
  testing::FillBox(map, {{99, 70, 0}, {100, 90, 1}}, FieldCell::kSink);
  return map;
}

/// Calls visit(free cell, its open neighbors' offsets) for each free cell.
void ForEachRow(const FieldMap& map,
                const std::function<void(std::size_t, const std::vector<std::size_t>&)>& visit) {
  std::vector<std::size_t> neighbors;
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (map[k] != FieldCell::kFree) continue;
    neighbors.clear();
    for (const VoxelIndex& step : kFaceNeighbors) {
      const VoxelIndex next = map.IndexAt(k) + step;
      if (map.Get(next, FieldCell::kWall) != FieldCell::kWall) neighbors.push_back(map.Offset(next));
    }
    visit(k, neighbors);
  }
}

/// |b - A phi| / |b| of the equations with no flux through walls.
double RelativeResidual(const FieldMap& map, const Phi& phi) {
  double of_phi = 0.0;
  double of_zero = 0.0;
  ForEachRow(map, [&](std::size_t k, const std::vector<std::size_t>& neighbors) {
    double rest = -phi[k] * static_cast<double>(neighbors.size());
    double given = 0.0;
    for (const std::size_t n : neighbors) {
      rest += phi[n];
      if (map[n] != FieldCell::kFree) given += phi[n];
    }
    of_phi += rest * rest;
    of_zero += given * given;
  });
  return std::sqrt(of_phi / of_zero);
}

Phi StartOf(const FieldMap& map) {
  return Relax(map, {.max_sweeps = 0}).phi;
}

/// Successive over-relaxation with the factor that is best for a square of `n` cells [Young 1954].
void SweepOverRelaxed(const FieldMap& map, int n, Phi& phi) {
  const double factor = 2.0 / (1.0 + std::sin(std::numbers::pi / n));
  ForEachRow(map, [&](std::size_t k, const std::vector<std::size_t>& neighbors) {
    double sum = 0.0;
    for (const std::size_t at : neighbors) sum += phi[at];
    if (!neighbors.empty()) phi[k] += factor * (sum / static_cast<double>(neighbors.size()) - phi[k]);
  });
}

double ConjugateGradients(const FieldMap& map, int iterations) {
  DenseGrid<int> number(map.box(), -1);
  int count = 0;
  ForEachRow(map, [&](std::size_t k, const std::vector<std::size_t>&) { number[k] = count++; });
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd b = Eigen::VectorXd::Zero(count);
  ForEachRow(map, [&](std::size_t k, const std::vector<std::size_t>& neighbors) {
    entries.emplace_back(number[k], number[k], static_cast<double>(neighbors.size()));
    for (const std::size_t n : neighbors) {
      if (map[n] == FieldCell::kFree) entries.emplace_back(number[k], number[n], -1.0);
      if (map[n] == FieldCell::kSource) b[number[k]] += 1.0;
      if (IsSink(map[n])) b[number[k]] -= 1.0;
    }
  });
  Eigen::SparseMatrix<double> a(count, count);
  a.setFromTriplets(entries.begin(), entries.end());
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver(a);
  solver.setMaxIterations(iterations);
  solver.setTolerance(1e-14);
  const Eigen::VectorXd x = solver.solve(b);
  return (b - a * x).norm() / b.norm();
}

double Ours(const FieldMap& map, int iterations) {
  HarmonicField field;
  field.Solve(map, {.relative_residual = 1e-14, .max_iterations = iterations});
  Phi phi = StartOf(map);
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (map[k] == FieldCell::kFree) phi[k] = field.phi()[k];
  }
  return RelativeResidual(map, phi);
}

void CompareConvergence(const FieldMap& map) {
  std::printf("Relative residual after so many sweeps or iterations, %d x %d cells\n", map.box().size_x(),
              map.box().size_y());
  std::printf("%8s %12s %12s %12s %12s %12s\n", "", "Jacobi", "Gauss-Seidel", "SOR", "CG", "ours");
  Phi over_relaxed = StartOf(map);
  int swept = 0;
  for (const int n : {3, 10, 30, 100, 230, 1000, 3000, 10000}) {
    for (; swept < n; ++swept) SweepOverRelaxed(map, 100, over_relaxed);
    const auto relaxed = [&](Sweep sweep) {
      return RelativeResidual(
          map,
          Relax(map, {.sweep = sweep, .walls = Walls::kDropped, .largest_change = 0.0, .max_sweeps = n}).phi);
    };
    std::printf("%8d %12.1e %12.1e %12.1e %12.1e %12.1e\n", n, relaxed(Sweep::kJacobi),
                relaxed(Sweep::kGaussSeidel), RelativeResidual(map, over_relaxed), ConjugateGradients(map, n),
                Ours(map, n));
  }
  for (const Sweep sweep : {Sweep::kJacobi, Sweep::kGaussSeidel}) {
    for (const double change : {1e-4, 1e-5}) {
      const Relaxation its = Relax(map, {.sweep = sweep, .walls = Walls::kDropped, .largest_change = change});
      std::printf("%s stops at a largest relative change of %.0e after %d sweeps, residual %.1e\n",
                  sweep == Sweep::kJacobi ? "Jacobi" : "Gauss-Seidel", change, its.sweeps,
                  RelativeResidual(map, its.phi));
    }
  }
}

/// [cells] From a point to the nearest one on a polyline.
double DistanceTo(const std::vector<Eigen::Vector3d>& line, const Eigen::Vector3d& p) {
  double least = (p - line.front()).norm();
  for (std::size_t n = 0; n + 1 < line.size(); ++n) {
    const Eigen::Vector3d along = line[n + 1] - line[n];
    const double square = along.squaredNorm();
    const double share = square > 0.0 ? std::clamp((p - line[n]).dot(along) / square, 0.0, 1.0) : 0.0;
    least = std::min(least, (line[n] + share * along - p).norm());
  }
  return least;
}

void CompareIntegrators(const FieldMap& map) {
  const Phi phi = Relax(map, {.largest_change = 1e-12}).phi;
  const auto follow = [&](Integrator integrator, double step) {
    return FollowDescent(map, phi, 1.0, {15, 15, 0}, {.integrator = integrator, .step_cells = step});
  };
  const Streamline reference = follow(Integrator::kRungeKutta4, 0.01);
  std::printf(
      "\nLargest distance [cells] from the line of Runge-Kutta 4 with steps of 0.01 cells, which %s\n",
      reference.end == StreamlineEnd::kArrived ? "arrives" : "does not arrive");
  std::printf("%8s %14s %16s %16s\n", "step", "Euler", "improved Euler", "Runge-Kutta 4");
  for (const double step : {2.0, 1.0, 0.5, 0.25, 0.125}) {
    std::printf("%8.3f", step);
    for (const Integrator integrator :
         {Integrator::kEuler, Integrator::kImprovedEuler, Integrator::kRungeKutta4}) {
      Streamline line = follow(integrator, step);
      if (line.end == StreamlineEnd::kArrived) line.points_W.pop_back();  // lies anywhere in the frontier
      double farthest = 0.0;
      for (const Eigen::Vector3d& p : line.points_W)
        farthest = std::max(farthest, DistanceTo(reference.points_W, p));
      std::printf(" %9.4f %s", farthest, line.end == StreamlineEnd::kArrived ? "      " : "stuck ");
    }
    std::printf("\n");
  }
}

/// What leaves the source, in a field that is solved to 1e-9.
double Flux(const FieldMap& map) {
  const DenseGrid<float> phi = HarmonicField().Solve(map, {.relative_residual = 1e-9});
  double flux = 0.0;
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (map[k] != FieldCell::kSource) continue;
    for (const VoxelIndex& step : kFaceNeighbors) {
      const VoxelIndex next = map.IndexAt(k) + step;
      if (map.Get(next, FieldCell::kWall) == FieldCell::kFree) flux += 1.0 - static_cast<double>(phi[next]);
    }
  }
  return flux;
}

/// Twenty explored rooms along a corridor, the robot and the last frontier in one of them. Not to the printed
/// stop, which takes more than a hundred thousand sweeps here.
void SealByIsovolumes() {
  const FieldMap map = testing::Comb::Explored(20);
  std::size_t free = 0;
  for (std::size_t k = 0; k < map.size(); ++k) free += map[k] == FieldCell::kFree ? 1 : 0;
  const double flux = Flux(map);
  std::printf("\nAlgorithm 4 in a comb of 20 explored rooms, %zu free cells\n", free);
  std::printf("%24s %14s %10s\n", "phi after", "in isovolumes", "flux kept");
  const auto report = [&](const std::string& after, const Phi& phi) {
    const DenseGrid<std::uint8_t> found = AllIsovolumes(map, phi);
    FieldMap sealed = map;
    std::size_t count = 0;
    for (std::size_t k = 0; k < map.size(); ++k) {
      if (found[k] == 0 || map[k] != FieldCell::kFree) continue;
      sealed[k] = FieldCell::kWall;
      ++count;
    }
    std::printf("%24s %12.1f %% %8.1f %%\n", after.c_str(),
                100.0 * static_cast<double>(count) / static_cast<double>(free), 100.0 * Flux(sealed) / flux);
  };
  for (const int n : {1, 10, 100, 1000, 10'000})
    report(std::to_string(n) + " sweeps", Relax(map, {.max_sweeps = n}).phi);
  const DenseGrid<float> solved = HarmonicField().Solve(map, {.relative_residual = 1e-9});
  Phi rounded = StartOf(map);
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (map[k] == FieldCell::kFree) rounded[k] = std::round(1e5 * static_cast<double>(solved[k])) / 1e5;
  }
  report("solved, to five digits", rounded);
}

}  // namespace
}  // namespace thalweg::explorer

int main() {
  using namespace thalweg::explorer;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // a table takes minutes
  const auto map = ThreeRooms();
  CompareConvergence(map);
  CompareIntegrators(map);
  SealByIsovolumes();
}
