#pragma once

#include <cstring>
#include <vector>

#include "services/explorer/core/field/device/jacobi.h"

namespace thalweg::explorer::field::device {

/// Runs the device's bodies on the CPU, one after the other: what the tests compare with the CPU's own solver
/// on a machine without a device. Not for speed.
class HostExecution {
 public:
  template <class T>
  class Buffer {
   public:
    /// The content is undefined afterwards, as it is on a device.
    void Resize(std::size_t size) { values_.assign(size, Garbage()); }
    T* data() { return values_.data(); }

   private:
    /// What a body must not read before it is written.
    static T Garbage() {
      T value;
      std::memset(static_cast<void*>(&value), 0xFE, sizeof(T));
      return value;
    }
    std::vector<T> values_;
  };

  template <class Body>
  void ForEach(Index count, const Body& body) {
    for (Index i = 0; i < count; ++i) body(i);
  }
  /// Calls finish(scalars, sum of body(i)).
  template <class Body, class Finish>
  void Sum(Index count, const Body& body, Scalars* scalars, const Finish& finish) {
    double sum = 0.0;
    for (Index i = 0; i < count; ++i) sum += body(i);
    finish(*scalars, sum);
  }
  /// Runs a body that runs others, each by a group of threads. @param memory  [bytes] of each group's
  /// Memory().
  template <class Body>
  void Together(Index groups, const Body& body, std::size_t memory = 0) {
    memory_.resize(memory / sizeof(double) + 1);
    for (Index group = 0; group < groups; ++group) body(*this, group);
  }
  /// out = matrix in, for `count` rows of as many entries.
  void Product(const float* matrix, Index count, const float* in, float* out) {
    for (Index i = 0; i < count; ++i) {
      float sum = 0.0F;
      for (Index j = 0; j < count; ++j) sum += matrix[std::size_t{i} * count + j] * in[j];
      out[i] = sum;
    }
  }
  void* Memory() { return memory_.data(); }
  std::size_t MemoryOfGroup() const { return 100'000; }
  std::size_t CacheBytes() const { return 1'000'000; }
  /// before[i] = values[0] + ... + values[i - 1]. @return The sum of all.
  Index SumBefore(const Index* values, Index* before, Index count) {
    Index sum = 0;
    for (Index i = 0; i < count; ++i) {
      before[i] = sum;
      sum += values[i];
    }
    return sum;
  }
  void Sweep(const JacobiSweep& sweep) {
    const GridShape& shape = sweep.shape;
    for (int z = 0; z < shape.size[2]; ++z) {
      for (int y = 0; y < shape.size[1]; ++y) {
        for (int x = 0; x < shape.size[0]; ++x) {
          const Index i = shape.Cell(x, y, z);
          if (sweep.codes[i] != kFreeCell) continue;
          const auto neighbor = [&](int axis, int step) {
            int at[3] = {x, y, z};
            at[axis] += step;
            return at[axis] >= 0 && at[axis] < shape.size[axis] ? shape.Cell(at[0], at[1], at[2]) : kNoNode;
          };
          const float after = JacobiMean(
              [&](int axis, int step) {
                const Index n = neighbor(axis, step);
                return n == kNoNode ? kWallCell : sweep.codes[n];
              },
              [&](int axis, int step) { return sweep.from[neighbor(axis, step)]; }, sweep.from[i]);
          sweep.to[i] = after;
          if (JacobiChanged(sweep.from[i], after, sweep.largest_change)) *sweep.changed = 1;
        }
      }
    }
  }
  template <class T>
  void CopyIn(const T* from, T* to, std::size_t count) {
    std::memcpy(to, from, count * sizeof(T));
  }
  template <class T>
  void CopyOut(const T* from, T* to, std::size_t count) {
    std::memcpy(to, from, count * sizeof(T));
  }
  template <class T>
  void Clear(T* values, std::size_t count) {
    std::memset(static_cast<void*>(values), 0, count * sizeof(T));
  }

 private:
  std::vector<double> memory_;
};

}  // namespace thalweg::explorer::field::device
