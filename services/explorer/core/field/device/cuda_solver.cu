#include <cuda_runtime.h>

#include <cstring>
#include <cub/device/device_scan.cuh>
#include <stdexcept>
#include <string>
#include <utility>

#include "services/explorer/core/field/device/solver.h"

namespace thalweg::explorer::field::device {
namespace {

void Check(cudaError_t error, const char* call) {
  if (error == cudaSuccess) return;
  throw std::runtime_error(std::string("CUDA: ") + call + ": " + cudaGetErrorString(error));
}

constexpr unsigned kThreads = 256;
constexpr unsigned kGroup = 1024;

/// One row of a product by one warp. @return The sum, in the warp's first lane.
__device__ float SumOfRow(const float* row, Index count, const float* in) {
  float sum = 0.0F;
  for (Index j = threadIdx.x % 32; j < count; j += 32) sum += row[j] * in[j];
  for (int step = 16; step > 0; step /= 2) sum += __shfl_down_sync(0xFFFFFFFFU, sum, step);
  return sum;
}

__global__ void MultiplyRows(const float* matrix, Index count, const float* in, float* out) {
  const Index row = (blockIdx.x * blockDim.x + threadIdx.x) / 32;
  if (row >= count) return;
  const float sum = SumOfRow(matrix + static_cast<std::size_t>(row) * count, count, in);
  if (threadIdx.x % 32 == 0) out[row] = sum;
}

/// The threads of one group, which meet after each body.
struct GroupExecution {
  __device__ void* Memory() {
    extern __shared__ double memory[];
    return memory;
  }
  template <class Body>
  __device__ void ForEach(Index count, const Body& body) {
    for (Index i = threadIdx.x; i < count; i += blockDim.x) body(i);
    __syncthreads();
  }
  __device__ void Product(const float* matrix, Index count, const float* in, float* out) {
    for (Index row = threadIdx.x / 32; row < count; row += blockDim.x / 32) {
      const float sum = SumOfRow(matrix + static_cast<std::size_t>(row) * count, count, in);
      if (threadIdx.x % 32 == 0) out[row] = sum;
    }
    __syncthreads();
  }
};

template <class Body>
__global__ void RunEach(Index count, const __grid_constant__ Body body) {
  const Index i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) body(i);
}

template <class Body>
__global__ void __launch_bounds__(kGroup) RunTogether(const __grid_constant__ Body body) {
  GroupExecution execution;
  body(execution, blockIdx.x);
}

/// @return The sum over all threads of the block, in its first thread.
__device__ double SumOfBlock(double value) {
  __shared__ double of_warp[32];
  for (int step = 16; step > 0; step /= 2) value += __shfl_down_sync(0xFFFFFFFFU, value, step);
  if (threadIdx.x % 32 == 0) of_warp[threadIdx.x / 32] = value;
  __syncthreads();
  if (threadIdx.x < 32) {
    value = threadIdx.x < blockDim.x / 32 ? of_warp[threadIdx.x] : 0.0;
    for (int step = 16; step > 0; step /= 2) value += __shfl_down_sync(0xFFFFFFFFU, value, step);
  }
  __syncthreads();
  return value;
}

/// The block that is done last adds up what all have summed, in their order, so that any two runs give the
/// same bits.
template <class Body, class Finish>
__global__ void RunSum(Index count, const __grid_constant__ Body body, Scalars* scalars, const Finish finish,
                       double* of_block, unsigned* blocks_done) {
  const Index i = blockIdx.x * blockDim.x + threadIdx.x;
  const double sum = SumOfBlock(i < count ? body(i) : 0.0);
  __shared__ bool last;
  if (threadIdx.x == 0) {
    of_block[blockIdx.x] = sum;
    __threadfence();
    last = atomicAdd(blocks_done, 1U) == gridDim.x - 1;
  }
  __syncthreads();
  if (!last) return;
  __threadfence();
  double total = 0.0;
  for (unsigned k = threadIdx.x; k < gridDim.x; k += blockDim.x) total += __ldcg(of_block + k);
  total = SumOfBlock(total);
  if (threadIdx.x == 0) {
    finish(*scalars, total);
    *blocks_done = 0;
  }
}

/// Each thread holds a column of the grid and climbs through it. A block's outermost threads only load what
/// the inner ones need, so blocks overlap by two columns.
__global__ void SweepTiles(const __grid_constant__ JacobiSweep sweep) {
  __shared__ float phi[3][kTileY][kTileX];
  __shared__ std::uint8_t code[3][kTileY][kTileX];
  const int tx = static_cast<int>(threadIdx.x);
  const int ty = static_cast<int>(threadIdx.y);
  const GridShape& shape = sweep.shape;
  const int x = static_cast<int>(blockIdx.x) * (kTileX - 2) + tx - 1;
  const int y = static_cast<int>(blockIdx.y) * (kTileY - 2) + ty - 1;
  const auto load = [&](int z) {
    const int slot = (z + 3) % 3;
    const bool inside = shape.Contains(x, y, z);
    const Index i = inside ? shape.Cell(x, y, z) : 0;
    code[slot][ty][tx] = inside ? sweep.codes[i] : kWallCell;
    phi[slot][ty][tx] = inside ? sweep.from[i] : 0.0F;
  };
  const bool inner = tx > 0 && tx < kTileX - 1 && ty > 0 && ty < kTileY - 1;
  load(-1);
  load(0);
  bool changed = false;
  for (int z = 0; z < shape.size[2]; ++z) {
    load(z + 1);
    __syncthreads();
    if (inner && code[z % 3][ty][tx] == kFreeCell) {
      const auto slot = [z](int axis, int step) { return (z + (axis == 2 ? step : 0) + 3) % 3; };
      const auto row = [ty](int axis, int step) { return ty + (axis == 1 ? step : 0); };
      const auto column = [tx](int axis, int step) { return tx + (axis == 0 ? step : 0); };
      const float before = phi[z % 3][ty][tx];
      const float after = JacobiMean(
          [&](int a, int step) { return code[slot(a, step)][row(a, step)][column(a, step)]; },
          [&](int a, int step) { return phi[slot(a, step)][row(a, step)][column(a, step)]; }, before);
      sweep.to[shape.Cell(x, y, z)] = after;
      changed |= JacobiChanged(before, after, sweep.largest_change);
    }
    __syncthreads();
  }
  if (__syncthreads_or(changed ? 1 : 0) != 0 && tx == 0 && ty == 0) *sweep.changed = 1;
}

class CudaExecution {
 public:
  template <class T>
  class Buffer {
   public:
    Buffer() = default;
    Buffer(Buffer&& other) noexcept
        : begin_(std::exchange(other.begin_, nullptr)), capacity_(std::exchange(other.capacity_, 0)) {}
    Buffer& operator=(Buffer&& other) noexcept {
      std::swap(begin_, other.begin_);
      std::swap(capacity_, other.capacity_);
      return *this;
    }
    ~Buffer() { cudaFree(begin_); }
    /// The content is undefined afterwards.
    void Resize(std::size_t size) {
      if (size <= capacity_ && begin_ != nullptr) return;
      cudaFree(begin_);
      begin_ = nullptr;
      capacity_ = 0;
      Check(cudaMalloc(reinterpret_cast<void**>(&begin_), (size > 0 ? size : 1) * sizeof(T)), "cudaMalloc");
      capacity_ = size;
    }
    T* data() { return begin_; }

   private:
    T* begin_ = nullptr;
    std::size_t capacity_ = 0;
  };

  CudaExecution() {
    int device = 0;
    int memory = 0;
    Check(cudaGetDevice(&device), "cudaGetDevice");
    Check(cudaDeviceGetAttribute(&memory, cudaDevAttrMaxSharedMemoryPerBlockOptin, device),
          "cudaDeviceGetAttribute");
    memory_of_group_ = static_cast<std::size_t>(memory);
    Check(cudaDeviceGetAttribute(&memory, cudaDevAttrL2CacheSize, device), "cudaDeviceGetAttribute");
    cache_bytes_ = static_cast<std::size_t>(memory);
    Check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "cudaStreamCreate");
    Check(cudaMallocHost(&pinned_, kPinnedBytes), "cudaMallocHost");
    blocks_done_.Resize(1);
    Check(cudaMemsetAsync(blocks_done_.data(), 0, sizeof(unsigned), stream_), "cudaMemset");
  }
  CudaExecution(const CudaExecution&) = delete;
  CudaExecution& operator=(const CudaExecution&) = delete;
  ~CudaExecution() {
    cudaFreeHost(pinned_);
    cudaStreamDestroy(stream_);
  }

  template <class Body>
  void ForEach(Index count, const Body& body) {
    if (count == 0) return;
    RunEach<<<BlocksFor(count), kThreads, 0, stream_>>>(count, body);
    Check(cudaGetLastError(), "kernel");
  }
  template <class Body, class Finish>
  void Sum(Index count, const Body& body, Scalars* scalars, const Finish& finish) {
    const unsigned blocks = BlocksFor(count);
    of_block_.Resize(blocks);
    RunSum<<<blocks, kThreads, 0, stream_>>>(count, body, scalars, finish, of_block_.data(),
                                             blocks_done_.data());
    Check(cudaGetLastError(), "kernel with a sum");
  }
  template <class Body>
  void Together(Index groups, const Body& body, std::size_t memory = 0) {
    if (memory > 0) {
      Check(cudaFuncSetAttribute(RunTogether<Body>, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                 static_cast<int>(memory)),
            "cudaFuncSetAttribute");
    }
    RunTogether<<<groups, kGroup, memory, stream_>>>(body);
    Check(cudaGetLastError(), "kernel of groups");
  }
  void Product(const float* matrix, Index count, const float* in, float* out) {
    MultiplyRows<<<BlocksFor(32 * count), kThreads, 0, stream_>>>(matrix, count, in, out);
    Check(cudaGetLastError(), "kernel of a product");
  }
  std::size_t MemoryOfGroup() const { return memory_of_group_; }
  std::size_t CacheBytes() const { return cache_bytes_; }
  Index SumBefore(const Index* values, Index* before, Index count) {
    if (count == 0) return 0;
    std::size_t bytes = 0;
    Check(cub::DeviceScan::ExclusiveSum(nullptr, bytes, values, before, static_cast<int>(count), stream_),
          "cub::DeviceScan");
    scan_.Resize(bytes);
    Check(
        cub::DeviceScan::ExclusiveSum(scan_.data(), bytes, values, before, static_cast<int>(count), stream_),
        "cub::DeviceScan");
    auto* ends = static_cast<Index*>(pinned_);
    Copy(before + count - 1, ends, sizeof(Index), cudaMemcpyDeviceToHost);
    Copy(values + count - 1, ends + 1, sizeof(Index), cudaMemcpyDeviceToHost);
    Wait();
    return ends[0] + ends[1];
  }
  void Sweep(const JacobiSweep& sweep) {
    const auto tiles = [](int size, int tile) {
      return static_cast<unsigned>((size + tile - 3) / (tile - 2));
    };
    const dim3 blocks(tiles(sweep.shape.size[0], kTileX), tiles(sweep.shape.size[1], kTileY));
    if (blocks.x == 0 || blocks.y == 0) return;
    SweepTiles<<<blocks, dim3(kTileX, kTileY), 0, stream_>>>(sweep);
    Check(cudaGetLastError(), "kernel of a sweep");
  }
  template <class T>
  void CopyIn(const T* from, T* to, std::size_t count) {
    Copy(from, to, count * sizeof(T), cudaMemcpyHostToDevice);
  }
  template <class T>
  void CopyOut(const T* from, T* to, std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    const bool small = bytes <= kPinnedBytes;
    Copy(from, small ? pinned_ : to, bytes, cudaMemcpyDeviceToHost);
    Wait();
    if (small) std::memcpy(to, pinned_, bytes);
  }
  template <class T>
  void Clear(T* values, std::size_t count) {
    Check(cudaMemsetAsync(values, 0, count * sizeof(T), stream_), "cudaMemset");
  }

 private:
  static unsigned BlocksFor(Index count) { return (count + kThreads - 1) / kThreads; }
  void Copy(const void* from, void* to, std::size_t bytes, cudaMemcpyKind kind) {
    Check(cudaMemcpyAsync(to, from, bytes, kind, stream_), "cudaMemcpy");
  }
  void Wait() { Check(cudaStreamSynchronize(stream_), "waiting for the device"); }

  static constexpr std::size_t kPinnedBytes = 4096;
  std::size_t memory_of_group_ = 0;
  std::size_t cache_bytes_ = 0;
  cudaStream_t stream_ = nullptr;
  void* pinned_ = nullptr;
  Buffer<double> of_block_;
  Buffer<unsigned> blocks_done_;
  Buffer<unsigned char> scan_;
};

}  // namespace

std::unique_ptr<DeviceSolver> OpenDeviceSolver(std::string& why) {
  int count = 0;
  const cudaError_t error = cudaGetDeviceCount(&count);
  if (error != cudaSuccess || count == 0) {
    why = std::string("no CUDA device: ") + cudaGetErrorString(error);
    return nullptr;
  }
  try {
    return std::unique_ptr<DeviceSolver>(new Solver<CudaExecution>());
  } catch (const std::runtime_error& failed) {
    why = failed.what();
    return nullptr;
  }
}

}  // namespace thalweg::explorer::field::device
