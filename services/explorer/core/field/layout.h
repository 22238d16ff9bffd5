#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "services/explorer/core/field/team.h"

/// Storage of one level of the field: dense, padded, and swept only where there are unknowns.
namespace thalweg::explorer::field {

/// Number of cells that a sweep processes at a time. Rows begin and segments end at multiples of it.
inline constexpr std::size_t kChunk = 8;

/// A box of cells in memory, x fastest, with a margin on every side so that every cell has neighbors.
struct Layout {
  int nx = 0, ny = 0, nz = 0;
  std::size_t stride_y = 0, stride_z = 0, total = 0;

  Layout() = default;
  Layout(int size_x, int size_y, int size_z) : nx(size_x), ny(size_y), nz(size_z) {
    stride_y = (static_cast<std::size_t>(nx) + kChunk - 1) / kChunk * kChunk + kChunk;
    stride_z = stride_y * (static_cast<std::size_t>(ny) + 1);  // one row separates consecutive planes
    total = stride_z * (static_cast<std::size_t>(nz) + 2) + stride_y + kChunk;
  }
  /// Indices from -1 to size are in memory.
  std::size_t Offset(int x, int y, int z) const {
    return static_cast<std::size_t>(z + 1) * stride_z + static_cast<std::size_t>(y + 1) * stride_y + kChunk +
           static_cast<std::size_t>(x) - stride_y;
  }
  std::size_t Row(int y, int z) const { return Offset(0, y, z); }
  Layout Halved() const { return {(nx + 1) / 2, (ny + 1) / 2, (nz + 1) / 2}; }
  /// Offset in Halved() of the 2x2x2 block that contains a cell.
  std::size_t Parent(std::size_t offset, const Layout& halved) const {
    const std::size_t plane = offset / stride_z;
    const std::size_t row = offset % stride_z / stride_y;
    const std::size_t x = offset % stride_y - kChunk;
    return halved.Offset(static_cast<int>(x / 2), static_cast<int>(row / 2), static_cast<int>(plane - 1) / 2);
  }
};

/// A section of a row that contains unknowns, and possibly other cells among them.
struct Segment {
  std::size_t begin;   ///< Offset of the first cell, whose x is a multiple of kChunk.
  std::size_t coarse;  ///< Offset of its 2x2x2 block in the next level.
  std::size_t length;  ///< A multiple of kChunk.
};

/// Zeroed, cache-line aligned memory that is reused for the next solve; uses huge pages where available.
template <class T>
class Buffer {
 public:
  void Reset(std::size_t size) {
    if (Reserve(size)) std::memset(static_cast<void*>(begin_), 0, size * sizeof(T));
  }
  /// The same, zeroed by all threads.
  void Reset(std::size_t size, Team& team) {
    if (!Reserve(size)) return;
    team.ForParts(static_cast<int>(size / kPage) + 1, size, [&](int begin, int end, int) {
      const std::size_t first = static_cast<std::size_t>(begin) * kPage;
      const std::size_t last = std::min(size, static_cast<std::size_t>(end) * kPage);
      if (first < last) std::memset(static_cast<void*>(begin_ + first), 0, (last - first) * sizeof(T));
    });
  }
  T* data() { return begin_; }
  const T* data() const { return begin_; }
  T& operator[](std::size_t i) { return begin_[i]; }
  const T& operator[](std::size_t i) const { return begin_[i]; }

 private:
  /// @return Whether the memory must still be zeroed; fresh memory from the system is already zero.
  bool Reserve(std::size_t size) {
    if (size <= size_) return true;
    memory_.reset();
    memory_.reset(std::calloc(size * sizeof(T) + kLine, 1));
    if (!memory_) throw std::bad_alloc();
    const auto address = reinterpret_cast<std::uintptr_t>(memory_.get());
    begin_ = reinterpret_cast<T*>((address + kLine - 1) / kLine * kLine);
    size_ = size;
    const std::uintptr_t first = (address + kPage - 1) / kPage * kPage;
    const std::uintptr_t last = (address + size * sizeof(T)) / kPage * kPage;
    if (last > first + 512 * kPage) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
    return false;
  }

  static constexpr std::uintptr_t kLine = 64;
  static constexpr std::uintptr_t kPage = 4096;
  struct Free {
    void operator()(void* p) const { std::free(p); }
  };
  std::unique_ptr<void, Free> memory_;
  T* begin_ = nullptr;
  std::size_t size_ = 0;
};

/// The segments of a level, plane by plane.
struct Segments {
  std::vector<Segment> list;
  std::vector<std::size_t> plane_begin;  ///< nz + 1 indices into `list`.
};

}  // namespace thalweg::explorer::field
