/// Compares the field solver with Eigen's conjugate gradients, with Gauss-Seidel and with the machine's
/// memory bandwidth, on furnished buildings of growing size. Prints one table per size.
///
///   bench_field [--rounds N] [--sizes 100k,770k,8m]
///
/// Rounds are interleaved and medians reported, so that other load on the machine affects all alike. "cpu" is
/// the process's own time, which on a shared machine is the better measure of cost.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "common/base/median.h"
#include "services/explorer/core/field/harmonic_field.h"
#include "services/explorer/core/field/sealed_field.h"
#include "tests/support/random_maps.h"

namespace thalweg::explorer {
namespace {

using testing::FieldMap;

struct Time {
  double wall_ms = 0.0;
  double cpu_ms = 0.0;
};

double CpuMilliseconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto ms = [](const timeval& t) {
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
  };
  return ms(usage.ru_utime) + ms(usage.ru_stime);
}

Time Measure(const std::function<void()>& work) {
  const double cpu = CpuMilliseconds();
  const auto begin = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - begin;
  return {wall.count(), CpuMilliseconds() - cpu};
}

/// a = b + s c on arrays far larger than the caches; counts three transfers per element, like STREAM.
double TriadGigabytesPerSecond(int threads) {
  constexpr std::size_t kSize = 24'000'000;
  static std::vector<float> a(kSize, 0.0F), b(kSize, 1.0F), c(kSize, 2.0F);
  double best = 0.0;
  for (int round = 0; round < 5; ++round) {
    const Time time = Measure([&] {
      std::vector<std::jthread> team;
      for (int t = 0; t < threads; ++t) {
        team.emplace_back([t, threads] {
          const std::size_t end = kSize * static_cast<std::size_t>(t + 1) / static_cast<std::size_t>(threads);
          for (std::size_t i = kSize * static_cast<std::size_t>(t) / static_cast<std::size_t>(threads);
               i < end; ++i) {
            a[i] = b[i] + 3.0F * c[i];
          }
        });
      }
    });
    best = std::max(best, 3.0 * sizeof(float) * kSize / (1e6 * time.wall_ms));
  }
  return best;
}

struct Row {
  std::vector<double> setup_ms, solve_ms, wall_ms, cpu_ms;
  int iterations = 0;
  double residual = 0.0;
  double bytes = 0.0;
  std::size_t unknowns = 0;
};

HarmonicField::Options WithThreads(int threads) {
  return {.threads = threads, .solver = HarmonicField::Solver::kCpu};
}

/// @param kept  A solver that has solved such a problem before, as in a run; nullptr: a new one, whose memory
///              is part of the cost.
void RunOurs(const FieldMap& map, int threads, HarmonicField* kept, Row& row) {
  FieldStatistics statistics;
  const Time time = Measure([&] {
    if (kept != nullptr) {
      kept->Solve(map, WithThreads(threads));
      statistics = kept->statistics();
      return;
    }
    HarmonicField field;
    field.Solve(map, WithThreads(threads));
    statistics = field.statistics();
  });
  row.setup_ms.push_back(statistics.setup_ms);
  row.solve_ms.push_back(statistics.solve_ms);
  row.wall_ms.push_back(time.wall_ms);
  row.cpu_ms.push_back(time.cpu_ms);
  row.iterations = statistics.iterations;
  row.residual = statistics.relative_residual;
  row.unknowns = statistics.unknowns;
  row.bytes = statistics.bytes_swept;
}

/// The cells that are unknowns of the linear system: those for which the field is solved.
struct Unknowns {
  DenseGrid<int> number;
  std::vector<std::size_t> cells;

  explicit Unknowns(const FieldMap& map) : number(map.box(), -1) {
    std::vector<VoxelIndex> queue;
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (map[i] == FieldCell::kSource || map[i] == FieldCell::kSink) queue.push_back(map.IndexAt(i));
    }
    for (std::size_t k = 0; k < queue.size(); ++k) {
      for (const VoxelIndex& d : kFaceNeighbors) {
        const VoxelIndex next = queue[k] + d;
        if (map.Get(next, FieldCell::kWall) != FieldCell::kFree || number[next] >= 0) continue;
        number[next] = 0;
        queue.push_back(next);
      }
    }
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (number[i] < 0) continue;
      number[i] = static_cast<int>(cells.size());
      cells.push_back(i);
    }
  }
};

using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

void Assemble(const FieldMap& map, const Unknowns& unknowns, Matrix& a, Eigen::VectorXd& b) {
  const auto count = static_cast<Eigen::Index>(unknowns.cells.size());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(7 * unknowns.cells.size());
  b = Eigen::VectorXd::Zero(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const VoxelIndex i = map.IndexAt(unknowns.cells[static_cast<std::size_t>(k)]);
    double faces = 0.0;
    for (const VoxelIndex& d : kFaceNeighbors) {
      const FieldCell cell = map.Get(i + d, FieldCell::kWall);
      if (cell == FieldCell::kWall) continue;
      faces += 1.0;
      if (cell == FieldCell::kSource) b[k] += 1.0;
      if (cell == FieldCell::kSink) b[k] -= 1.0;
      if (cell == FieldCell::kFree) entries.emplace_back(k, unknowns.number[i + d], -1.0);
    }
    entries.emplace_back(k, k, faces);
  }
  a.resize(count, count);
  a.setFromTriplets(entries.begin(), entries.end());
}

/// Stores and uses both triangles, which is the faster of Eigen's two variants.
void RunEigen(const Matrix& a, const Eigen::VectorXd& b, double assembly_ms, Row& row) {
  Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper> solver;
  solver.setTolerance(1e-6);
  Eigen::VectorXd x;
  const Time time = Measure([&] {
    solver.compute(a);
    x = solver.solve(b);
  });
  row.setup_ms.push_back(assembly_ms);
  row.solve_ms.push_back(time.wall_ms);
  row.wall_ms.push_back(time.wall_ms);
  row.cpu_ms.push_back(time.cpu_ms);
  row.iterations = static_cast<int>(solver.iterations());
  row.residual = (b - a * x).norm() / b.norm();
  row.unknowns = static_cast<std::size_t>(b.size());
}

/// Sweeps until no value changes by more than 1e-4 of the largest.
/// @return The largest error.
double RunGaussSeidel(const Matrix& a, const Eigen::VectorXd& b, Row& row) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
  int sweeps = 0;
  const Time time = Measure([&] {
    for (double change = 1.0; change > 1e-4; ++sweeps) {
      change = 0.0;
      for (Eigen::Index i = 0; i < b.size(); ++i) {
        double sum = b[i];
        double diagonal = 1.0;
        for (Matrix::InnerIterator it(a, i); it; ++it) {
          if (it.col() == i) {
            diagonal = it.value();
          } else {
            sum -= it.value() * x[it.col()];
          }
        }
        change = std::max(change, std::abs(sum / diagonal - x[i]));
        x[i] = sum / diagonal;
      }
    }
  });
  Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper> exact;
  exact.setTolerance(1e-12);
  const Eigen::VectorXd reference = exact.compute(a).solve(b);
  row.solve_ms.push_back(time.wall_ms);
  row.wall_ms.push_back(time.wall_ms);
  row.cpu_ms.push_back(time.cpu_ms);
  row.iterations = sweeps;
  row.residual = (b - a * x).norm() / b.norm();
  row.unknowns = static_cast<std::size_t>(b.size());
  return (x - reference).cwiseAbs().maxCoeff();
}

void Print(const char* name, const Row& row, const Row& ours) {
  const double wall = Median(row.wall_ms);
  const double cpu = Median(row.cpu_ms);
  std::printf("  %-22s %9zu %6d %9.1e %9.1f %10.1f %10.1f %10.1f %8.0f %8.2f %8.2f\n", name, row.unknowns,
              row.iterations, row.residual, Median(row.setup_ms), Median(row.solve_ms), wall, cpu,
              1e6 * cpu / static_cast<double>(row.unknowns), wall / Median(ours.wall_ms),
              cpu / Median(ours.cpu_ms));
}

/// A comb of explored rooms with the robot and the last frontier in one of them: the cost of the other rooms.
void RunSealing(int rounds) {
  std::map<int, std::vector<double>> plain_ms, sealed_ms;
  std::map<int, std::size_t> plain_unknowns, sealed_unknowns;
  for (int round = 0; round < 3 * rounds; ++round) {
    for (const int rooms : {1, 20}) {
      const FieldMap map = testing::Comb::Explored(rooms);
      HarmonicField plain;
      plain.Solve(map, {});  // memory already allocated, as in a run
      plain_ms[rooms].push_back(Measure([&] { plain.Solve(map, {}); }).cpu_ms);
      plain_unknowns[rooms] = plain.statistics().unknowns;
      SealedField sealed;
      FieldMap cells = map;
      sealed.Solve(cells, {});
      cells = map;
      sealed_ms[rooms].push_back(Measure([&] { sealed.Solve(cells, {}); }).cpu_ms);
      sealed_unknowns[rooms] = sealed.statistics().unknowns;
    }
  }
  std::printf("\ncomb of explored rooms, 1 thread\n  %5s %18s %10s %18s %10s\n", "rooms", "unknowns",
              "cpu ms", "unsealed unknowns", "cpu ms");
  for (const int rooms : {1, 20}) {
    std::printf("  %5d %18zu %10.2f %18zu %10.2f\n", rooms, plain_unknowns[rooms], Median(plain_ms[rooms]),
                sealed_unknowns[rooms], Median(sealed_ms[rooms]));
  }
  std::printf("  twenty rooms, sealed / one room: %.2f\n", Median(sealed_ms[20]) / Median(plain_ms[1]));
}

/// The map before the last scan, which revealed the cells within `radius` of a frontier: these were unknown,
/// and the frontier lay before them.
FieldMap BeforeScan(const FieldMap& map, const VoxelIndex& at, double radius) {
  FieldMap before = map;
  const auto within = [&](const VoxelIndex& i) {
    return Eigen::Vector3d(i.x - at.x, i.y - at.y, i.z - at.z).norm() <= radius;
  };
  for (std::size_t k = 0; k < map.size(); ++k) {
    const VoxelIndex i = map.IndexAt(k);
    if (map[k] == FieldCell::kWall || map[k] == FieldCell::kSource) continue;
    if (within(i)) {
      before[k] = FieldCell::kWall;
      continue;
    }
    for (const VoxelIndex& d : kFaceNeighbors) {
      if (within(i + d)) before[k] = FieldCell::kSink;
    }
  }
  return before;
}

/// Compares a solve that starts from the field before the last scan with one from scratch.
void RunWarm(const VoxelIndex& cells, int rounds) {
  constexpr double kScanRadius = 12.0;  // in cells: 1.2 m at 0.1 m
  const FieldMap map = testing::ExplorationScene(cells, 1);
  std::vector<VoxelIndex> frontiers;
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (map[k] == FieldCell::kSink) frontiers.push_back(map.IndexAt(k));
  }
  std::vector<double> cold_ms, warm_ms, cold_iterations, warm_iterations;
  for (int round = 0; round < 3 * rounds; ++round) {
    const auto pick =
        frontiers.size() * static_cast<std::size_t>(round) / static_cast<std::size_t>(3 * rounds);
    const VoxelIndex& at = frontiers[pick];
    HarmonicField field;
    field.Solve(map, WithThreads(1));  // memory already allocated, as in a run
    cold_ms.push_back(Measure([&] { field.Solve(map, WithThreads(1)); }).cpu_ms);
    cold_iterations.push_back(field.statistics().iterations);
    const DenseGrid<float> former = HarmonicField().Solve(BeforeScan(map, at, kScanRadius), {});
    warm_ms.push_back(Measure([&] { field.Solve(map, WithThreads(1), former); }).cpu_ms);
    warm_iterations.push_back(field.statistics().iterations);
  }
  std::printf(
      "\nafter one more scan, %d x %d x %d cells, 1 thread: from nothing %.1f ms, %.0f iterations; from the "
      "field before it %.1f ms, %.0f iterations: %.2f\n",
      cells.x, cells.y, cells.z, Median(cold_ms), Median(cold_iterations), Median(warm_ms),
      Median(warm_iterations), Median(warm_ms) / Median(cold_ms));
}

struct Size {
  VoxelIndex cells;
  bool with_eigen;
  bool with_gauss_seidel;
};

void RunSize(const Size& size, int rounds, double triad_one, double triad_two) {
  const FieldMap map = testing::ExplorationScene(size.cells, 1);
  Row one, kept_one, kept_two, eigen, gauss_seidel;
  HarmonicField kept;
  kept.Solve(map, WithThreads(2));
  Matrix a;
  Eigen::VectorXd b;
  double assembly_ms = 0.0;
  if (size.with_eigen) {
    const Unknowns unknowns(map);
    assembly_ms = Measure([&] { Assemble(map, unknowns, a, b); }).wall_ms;
  }
  for (int round = 0; round < rounds; ++round) {
    for (int k = 0; k < 3; ++k) RunOurs(map, 1, nullptr, one);
    for (int k = 0; k < 3; ++k) RunOurs(map, 1, &kept, kept_one);
    for (int k = 0; k < 3; ++k) RunOurs(map, 2, &kept, kept_two);
    if (size.with_eigen) RunEigen(a, b, assembly_ms, eigen);
  }
  std::printf("\n%d x %d x %d cells\n", size.cells.x, size.cells.y, size.cells.z);
  std::printf("  %-22s %9s %6s %9s %9s %10s %10s %10s %8s %8s %8s\n", "", "unknowns", "iter", "residual",
              "setup ms", "solve ms", "total ms", "cpu ms", "cpu ns/u", "x wall", "x cpu");
  Print("ours, new", one, one);
  Print("ours, memory kept", kept_one, one);
  Print("ours, kept, 2 threads", kept_two, one);
  if (size.with_eigen) Print("Eigen CG (setup extra)", eigen, one);
  if (size.with_gauss_seidel) {
    const double error = RunGaussSeidel(a, b, gauss_seidel);
    Print("Gauss-Seidel to 1e-4", gauss_seidel, one);
    std::printf("  Gauss-Seidel's largest error: %.3f of a field that spans 2\n", error);
  }
  const double rate_one = one.bytes / (1e6 * Median(kept_one.solve_ms));
  const double rate_two = one.bytes / (1e6 * Median(kept_two.solve_ms));
  std::printf("  sweeps move %.2f GB: %.1f GB/s = %.0f %% of the triad (2 threads: %.1f GB/s = %.0f %%)\n",
              1e-9 * one.bytes, rate_one, 100.0 * rate_one / triad_one, rate_two,
              100.0 * rate_two / triad_two);
  std::fflush(stdout);
}

}  // namespace
}  // namespace thalweg::explorer

int main(int argc, char** argv) {
  using namespace thalweg::explorer;
  CLI::App app("Field solver against Eigen, Gauss-Seidel and the memory bandwidth");
  int rounds = 3;
  std::vector<std::string> sizes{"100k", "770k", "8m"};
  app.add_option("--rounds", rounds, "Interleaved rounds; three runs of ours in each");
  app.add_option("--sizes", sizes, "Of 100k, 770k, 8m")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  const std::map<std::string, Size> known{{"100k", {{75, 75, 30}, true, true}},
                                          {"770k", {{152, 152, 54}, true, false}},
                                          {"8m", {{336, 336, 116}, false, false}}};
  const double triad_one = TriadGigabytesPerSecond(1);
  const double triad_two = TriadGigabytesPerSecond(2);
  std::printf("triad: %.1f GB/s, two threads %.1f GB/s\n", triad_one, triad_two);
  for (const std::string& name : sizes) {
    const auto size = known.find(name);
    if (size == known.end()) {
      std::fprintf(stderr, "no such size: %s\n", name.c_str());
      return EXIT_FAILURE;
    }
    RunSize(size->second, rounds, triad_one, triad_two);
  }
  for (const char* name : {"100k", "770k"}) RunWarm(known.at(name).cells, rounds);
  RunSealing(rounds);
  return EXIT_SUCCESS;
}
