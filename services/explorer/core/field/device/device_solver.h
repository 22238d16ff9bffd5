#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace thalweg::explorer::field::device {

/// Solves the harmonic field (HarmonicField) on a device with memory of its own.
/// Threading: one thread at a time.
class DeviceSolver {
 public:
  struct Parameters {
    double relative_residual = 1e-6;
    int max_iterations = 100;
    float screening = 0.0F;   ///< k^2, k = cell / screening length.
    float weak_sink = -0.5F;  ///< phi of weak sinks.
  };
  struct Outcome {
    std::size_t unknowns = 0;
    int iterations = 0;
    double relative_residual = 0.0;  ///< |b - A phi| / |b|, as reached.
  };

  virtual ~DeviceSolver() = default;
  /// @param cells  FieldCell by cell, x fastest.
  /// @param size   [cells] of the grid.
  /// @param phi    As many as cells; NaN in walls.
  /// @throws std::length_error   if the map has more cells than the solver can number.
  /// @throws std::runtime_error  if the device fails or has too little memory; it names the call.
  virtual Outcome Solve(const std::uint8_t* cells, const int size[3], const Parameters& parameters,
                        float* phi) = 0;

  struct Relaxed {
    int sweeps = 0;
    bool stopped = false;  ///< By largest_change, not by max_sweeps.
  };
  /// The thesis's own relaxation by Jacobi sweeps, as Relax on the CPU with mirrored walls, in single
  /// precision: a baseline for comparisons. Whether it may stop is looked at every kSweepsAtOnce sweeps only,
  /// all of which are kept.
  /// @param largest_change  The limit for |change / old value|.
  virtual Relaxed Relax(const std::uint8_t* cells, const int size[3], float largest_change, int max_sweeps,
                        float* phi) = 0;
  static constexpr int kSweepsAtOnce = 32;
};

/// @return nullptr if this build or this machine has no device; `why` then says which.
std::unique_ptr<DeviceSolver> OpenDeviceSolver(std::string& why);

}  // namespace thalweg::explorer::field::device
