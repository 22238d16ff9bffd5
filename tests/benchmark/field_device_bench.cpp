/// Compares the field's solver on a GPU, copies included, with the one on the CPU and with the source
/// thesis's Jacobi sweeps on the same GPU. Needs a build with -DTHALWEG_CUDA=ON and a GPU.
///
///   bench_field_device [--rounds N]
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "common/base/median.h"
#include "services/explorer/core/field/device/device_solver.h"
#include "services/explorer/core/field/harmonic_field.h"
#include "services/explorer/core/field/relaxation.h"
#include "tests/support/random_maps.h"

namespace thalweg::explorer {
namespace {

using testing::FieldMap;

template <class Work>
double Milliseconds(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

/// A box without any wall, the robot and the one frontier in opposite corners.
FieldMap FreeCube(int edge) {
  FieldMap map({{0, 0, 0}, {edge, edge, edge}}, FieldCell::kFree);
  map[std::size_t{0}] = FieldCell::kSource;
  map[map.size() - 1] = FieldCell::kSink;
  return map;
}

double LargestDifference(const DenseGrid<float>& a, const DenseGrid<float>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isnan(a[i])) largest = std::max(largest, static_cast<double>(std::abs(a[i] - b[i])));
  }
  return largest;
}

void Compare(const char* name, const FieldMap& map, int rounds) {
  HarmonicField gpu, cpu;
  std::vector<double> gpu_ms, cpu_ms;
  const double first = Milliseconds([&] { gpu.Solve(map, {.solver = HarmonicField::Solver::kGpu}); });
  for (int round = 0; round < rounds; ++round) {
    for (int k = 0; k < 3; ++k) {
      gpu_ms.push_back(Milliseconds([&] { gpu.Solve(map, {.solver = HarmonicField::Solver::kGpu}); }));
    }
    cpu_ms.push_back(Milliseconds([&] { cpu.Solve(map, {.solver = HarmonicField::Solver::kCpu}); }));
  }
  std::printf("%-22s %10zu %10zu %5d %5d %10.1e %10.1f %9.2f %10.1f %8.1f %12.1e\n", name, map.size(),
              gpu.statistics().unknowns, gpu.statistics().iterations, cpu.statistics().iterations,
              gpu.statistics().relative_residual, first, Median(gpu_ms), Median(cpu_ms),
              Median(cpu_ms) / Median(gpu_ms), LargestDifference(gpu.phi(), cpu.phi()));
  std::fflush(stdout);
}

/// The thesis's sweeps to its stop, |change / old value| < 1e-4.
void CompareJacobi(field::device::DeviceSolver& solver, const FieldMap& map) {
  const VoxelBox& box = map.box();
  const int size[3] = {box.size_x(), box.size_y(), box.size_z()};
  DenseGrid<float> phi(box, 0.0F);
  field::device::DeviceSolver::Relaxed relaxed;
  constexpr RelaxationOptions kPrinted{.sweep = RelaxationOptions::Sweep::kJacobi};
  const auto run = [&] {
    relaxed = solver.Relax(reinterpret_cast<const std::uint8_t*>(map.data()), size,
                           static_cast<float>(kPrinted.largest_change), kPrinted.max_sweeps, phi.data());
  };
  run();
  const double gpu_ms = Milliseconds(run);
  Relaxation cpu;
  const double cpu_ms = Milliseconds([&] { cpu = Relax(map, kPrinted); });
  std::printf(
      "\nJacobi as printed, %d x %d x %d cells: GPU %d sweeps, %.1f ms; CPU, one thread, double precision, "
      "%d sweeps, %.0f ms: %.0f times a sweep\n",
      size[0], size[1], size[2], relaxed.sweeps, gpu_ms, cpu.sweeps, cpu_ms,
      cpu_ms / cpu.sweeps / (gpu_ms / relaxed.sweeps));
}

int Run(int rounds) {
  std::string why;
  const auto solver = field::device::OpenDeviceSolver(why);
  if (!solver) {
    std::fprintf(stderr, "%s\n", why.c_str());
    return EXIT_FAILURE;
  }
  std::printf("%-22s %10s %10s %5s %5s %10s %10s %9s %10s %8s %12s\n", "", "cells", "unknowns", "iter",
              "cpu's", "residual", "first ms", "GPU ms", "CPU ms", "ratio", "difference");
  const VoxelIndex scenes[] = {{72, 72, 27}, {150, 120, 27}, {220, 228, 32}, {600, 560, 40}};
  for (const VoxelIndex& size : scenes) {
    const std::string name =
        std::to_string(size.x) + " x " + std::to_string(size.y) + " x " + std::to_string(size.z);
    Compare(name.c_str(), testing::ExplorationScene(size, 1), rounds);
  }
  Compare("free cube of 100", FreeCube(100), rounds);
  Compare("free cube of 256", FreeCube(256), rounds);
  CompareJacobi(*solver, testing::ExplorationScene({100, 100, 18}, 1));
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace thalweg::explorer

int main(int argc, char** argv) {
  CLI::App app("Times the field's solver on a GPU beside the CPU's");
  int rounds = 3;
  app.add_option("--rounds", rounds, "How often all is repeated")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  return thalweg::explorer::Run(rounds);
}
