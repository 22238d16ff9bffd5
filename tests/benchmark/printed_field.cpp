/// Repeats on fields of our own what the source thesis reports of its solver [Shade: Choosing Where To Go,
/// DPhil thesis, Oxford 2011, Ch. 6]: how its sweeps converge beside other solvers (Fig. 6.12), how far its
/// three integrators stray (Fig. 6.14), and what Algorithm 4 finds. Prints three tables, and draws each.
#include <CLI/CLI.hpp>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/base/stopwatch.h"
#include "common/drawing/canvas.h"
#include "services/cli/report/chart.h"
#include "services/explorer/core/field/descent.h"
#include "services/explorer/core/field/isovolume.h"
#include "services/explorer/core/field/relaxation.h"
#include "services/explorer/core/field/sealed_field.h"
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

/// The largest change of the last of so many sweeps, relative to the value before it.
double LastRelativeChange(const FieldMap& map, Sweep sweep, int sweeps) {
  const auto after = [&](int n) {
    return Relax(map, {.sweep = sweep, .walls = Walls::kDropped, .largest_change = 0.0, .max_sweeps = n}).phi;
  };
  const Phi before = after(sweeps - 1);
  const Phi now = after(sweeps);
  double largest = 0.0;
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (map[k] == FieldCell::kFree && now[k] != before[k])
      largest = std::max(largest, std::abs((now[k] - before[k]) / before[k]));
  }
  return largest;
}

void WritePicture(const std::filesystem::path& file, const Canvas& canvas) {
  if (!cv::imwrite(file.string(), canvas.Picture()))
    throw std::runtime_error(file.string() + ": cannot be written");
}

/// @param pictures  Where to draw them; empty: nowhere.
void CompareConvergence(const FieldMap& map, const std::filesystem::path& pictures) {
  constexpr double kMostDigits = 8.0;
  std::printf("Relative residual after so many sweeps or iterations, %d x %d cells\n", map.box().size_x(),
              map.box().size_y());
  std::printf("%8s %12s %12s %12s %12s %12s\n", "", "Jacobi", "Gauss-Seidel", "SOR", "CG", "ours");
  std::vector<cli::Chart::Series> series{{"Jacobi", colors::kBad, {}},
                                         {"Gauss-Seidel", colors::kInk, {}},
                                         {"over-relaxed", colors::kMuted, {}},
                                         {"conjugate gradients", colors::kAccent, {}},
                                         {"ours", colors::kGood, {}}};
  Phi over_relaxed = StartOf(map);
  int swept = 0;
  for (const int n : {1, 2, 3, 5, 10, 20, 30, 50, 100, 230, 500, 1000, 2000, 3000, 5000, 10000}) {
    for (; swept < n; ++swept) SweepOverRelaxed(map, 100, over_relaxed);
    const auto relaxed = [&](Sweep sweep) {
      return RelativeResidual(
          map,
          Relax(map, {.sweep = sweep, .walls = Walls::kDropped, .largest_change = 0.0, .max_sweeps = n}).phi);
    };
    const std::vector<double> residuals{relaxed(Sweep::kJacobi), relaxed(Sweep::kGaussSeidel),
                                        RelativeResidual(map, over_relaxed), ConjugateGradients(map, n),
                                        Ours(map, n)};
    std::printf("%8d", n);
    for (std::size_t column = 0; column < residuals.size(); ++column) {
      std::printf(" %12.1e", residuals[column]);
      series[column].points.emplace_back(std::log10(n),
                                         std::clamp(-std::log10(residuals[column]), 0.0, kMostDigits));
    }
    std::printf("\n");
  }
  for (const Sweep sweep : {Sweep::kJacobi, Sweep::kGaussSeidel}) {
    const char* const name = sweep == Sweep::kJacobi ? "Jacobi" : "Gauss-Seidel";
    std::printf("%s: the largest relative change of sweep 230 is %.1e\n", name,
                LastRelativeChange(map, sweep, 230));
    for (const double change : {1e-4, 1e-5}) {
      const Relaxation its = Relax(map, {.sweep = sweep, .walls = Walls::kDropped, .largest_change = change});
      std::printf("%s stops at a largest relative change of %.0e after %d sweeps, residual %.1e\n", name,
                  change, its.sweeps, RelativeResidual(map, its.phi));
    }
  }
  if (pictures.empty()) return;
  Canvas canvas(900, 560);
  cli::DrawChart(canvas, {.x = 20, .y = 20, .width = 860, .height = 520},
                 {.title = "How solvers converge in a plan of 100 x 100 cells with three rooms",
                  .x_label = "sweeps or iterations, log10",
                  .y_label = "-log10 of the relative residual, drawn up to 8",
                  .y_max = kMostDigits,
                  .x_max = 4.0,
                  .series = std::move(series)});
  WritePicture(pictures / "convergence.png", canvas);
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

/// The plan with phi as shade and the lines of all integrators with steps of one cell.
void DrawIntegrators(const FieldMap& map, const Phi& phi, const std::filesystem::path& file) {
  constexpr double kCell = 6.0;     // [px]
  constexpr double kMargin = 20.0;  // [px]
  constexpr double kStep = 1.0;     // [cells]
  const int size = map.box().size_x();
  const double edge = kCell * size;
  Canvas canvas(static_cast<int>(edge + 2.0 * kMargin), static_cast<int>(edge + 2.0 * kMargin) + 40);
  cv::Mat plan(size, size, CV_8UC3);
  for (std::size_t k = 0; k < map.size(); ++k) {
    const VoxelIndex i = map.IndexAt(k);
    const auto shade = static_cast<std::uint8_t>(map[k] == FieldCell::kWall ? 60 : 205 + 45 * phi[k]);
    plan.at<cv::Vec3b>(size - 1 - i.y, i.x) =
        IsSink(map[k]) ? cv::Vec3b(90, 200, 90) : cv::Vec3b(shade, shade, shade);
  }
  canvas.Image({.x = kMargin, .y = kMargin, .width = edge, .height = edge}, plan);
  double legend = kMargin;
  const auto draw = [&](const char* name, const cv::Scalar& color, double thickness, Integrator integrator) {
    std::vector<cv::Point2d> points;
    const Streamline line =
        FollowDescent(map, phi, 1.0, {15, 15, 0}, {.integrator = integrator, .step_cells = kStep});
    for (const Eigen::Vector3d& p : line.points_W)
      points.emplace_back(kMargin + kCell * p.x(), kMargin + edge - kCell * p.y());
    canvas.Polyline(points, color, thickness);
    legend = canvas.Swatch({legend, 2.0 * kMargin + edge + 10.0}, color, name);
  };
  draw("Euler", colors::kBad, 2.0, Integrator::kEuler);
  draw("improved Euler", colors::kAccent, 4.0, Integrator::kImprovedEuler);
  draw("Runge-Kutta 4", colors::kGood, 1.5, Integrator::kRungeKutta4);
  canvas.Text("steps of one cell; frontier in green", {kMargin + edge, 2.0 * kMargin + edge + 14.0}, 8.0,
              colors::kMuted, Align::kRight);
  WritePicture(file, canvas);
}

void CompareIntegrators(const FieldMap& map, const std::filesystem::path& pictures) {
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
  if (!pictures.empty()) DrawIntegrators(map, phi, pictures / "integrators.png");
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

using Found = DenseGrid<std::uint8_t>;  // nonzero = sealed

/// What our own rule seals of the same map.
Found SealedByFlux(const FieldMap& map) {
  SealedField field;
  FieldMap cells = map;
  field.Solve(cells, {});
  Found found(map.box(), 0);
  for (const VoxelIndex& cell : field.sealed()) found[cell] = 1;
  return found;
}

/// The map from above, once for each way to seal. A column of cells is sealed if most of what is free in it
/// is.
void DrawSealed(const FieldMap& map, const std::vector<std::pair<std::string, Found>>& ways,
                const std::filesystem::path& file) {
  constexpr double kCell = 2.0;     // [px]
  constexpr double kMargin = 20.0;  // [px]
  constexpr double kTitle = 22.0;   // [px]
  const VoxelBox& box = map.box();
  const double width = kCell * box.size_x();
  const double height = kCell * box.size_y();
  const double pitch = height + kTitle + kMargin;
  Canvas canvas(static_cast<int>(width + 2.0 * kMargin),
                static_cast<int>(kMargin + pitch * static_cast<double>(ways.size()) + 24.0));
  double top = kMargin;
  for (const auto& [name, found] : ways) {
    canvas.Text(name, {kMargin, top + 12.0}, 9.0, colors::kInk);
    cv::Mat plan(box.size_y(), box.size_x(), CV_8UC3);
    for (int y = 0; y < box.size_y(); ++y) {
      for (int x = 0; x < box.size_x(); ++x) {
        int free = 0;
        int sealed = 0;
        bool is_source = false;
        bool is_sink = false;
        for (int z = 0; z < box.size_z(); ++z) {
          const VoxelIndex cell = box.min + VoxelIndex{x, y, z};
          is_source = is_source || map[cell] == FieldCell::kSource;
          is_sink = is_sink || IsSink(map[cell]);
          if (map[cell] != FieldCell::kFree) continue;
          ++free;
          sealed += found[cell] != 0 ? 1 : 0;
        }
        const cv::Scalar& color = is_source           ? colors::kBad
                                  : is_sink           ? colors::kAccent
                                  : free == 0         ? colors::kMuted
                                  : 2 * sealed > free ? colors::kGood
                                                      : colors::kPanel;
        plan.at<cv::Vec3b>(box.size_y() - 1 - y, x) =
            cv::Vec3b(static_cast<std::uint8_t>(color[0]), static_cast<std::uint8_t>(color[1]),
                      static_cast<std::uint8_t>(color[2]));
      }
    }
    canvas.Image({.x = kMargin, .y = top + kTitle, .width = width, .height = height}, plan);
    top += pitch;
  }
  double legend = kMargin;
  legend = canvas.Swatch({legend, top + 6.0}, colors::kGood, "sealed");
  legend = canvas.Swatch({legend, top + 6.0}, colors::kBad, "robot");
  canvas.Swatch({legend, top + 6.0}, colors::kAccent, "frontier");
  WritePicture(file, canvas);
}

/// Twenty explored rooms along a corridor, the robot and the last frontier in one of them. Not to the printed
/// stop, which takes more than a hundred thousand sweeps here.
void SealByIsovolumes(const std::filesystem::path& pictures) {
  const FieldMap map = testing::Comb::Explored(20);
  std::size_t free = 0;
  for (std::size_t k = 0; k < map.size(); ++k) free += map[k] == FieldCell::kFree ? 1 : 0;
  const double flux = Flux(map);
  std::printf("\nAlgorithm 4 in a comb of 20 explored rooms, %zu free cells\n", free);
  std::printf("%24s %14s %10s %18s\n", "phi after", "in isovolumes", "flux kept", "ms to find them");
  const auto report = [&](const std::string& after, const Phi& phi) {
    const Stopwatch watch;
    const Found found = AllIsovolumes(map, phi);
    const double ms = watch.Milliseconds();
    FieldMap sealed = map;
    std::size_t count = 0;
    for (std::size_t k = 0; k < map.size(); ++k) {
      if (found[k] == 0 || map[k] != FieldCell::kFree) continue;
      sealed[k] = FieldCell::kWall;
      ++count;
    }
    std::printf("%24s %12.1f %% %8.1f %% %18.1f\n", after.c_str(),
                100.0 * static_cast<double>(count) / static_cast<double>(free), 100.0 * Flux(sealed) / flux,
                ms);
    return found;
  };
  Found unfinished(map.box(), 0);
  for (const int n : {1, 10, 100, 1000, 10'000})
    unfinished = report(std::to_string(n) + " sweeps", Relax(map, {.max_sweeps = n}).phi);
  const DenseGrid<float> solved = HarmonicField().Solve(map, {.relative_residual = 1e-9});
  Phi rounded = StartOf(map);
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (map[k] == FieldCell::kFree) rounded[k] = std::round(1e5 * static_cast<double>(solved[k])) / 1e5;
  }
  const Found finished = report("solved, to five digits", rounded);
  if (pictures.empty()) return;
  DrawSealed(map,
             {{"Algorithm 4, phi after 10 000 sweeps", unfinished},
              {"Algorithm 4, phi solved", finished},
              {"by the flux through the rim, phi solved", SealedByFlux(map)}},
             pictures / "sealed.png");
}

}  // namespace
}  // namespace thalweg::explorer

int main(int argc, char** argv) {
  using namespace thalweg::explorer;
  CLI::App app("What the source thesis reports of its solver, on fields of our own");
  std::filesystem::path pictures;
  app.add_option("--pictures", pictures, "Folder for convergence.png, integrators.png and sealed.png")
      ->check(CLI::ExistingDirectory);
  CLI11_PARSE(app, argc, argv);
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // a table takes minutes
  try {
    const auto map = ThreeRooms();
    CompareConvergence(map, pictures);
    CompareIntegrators(map, pictures);
    SealByIsovolumes(pictures);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
