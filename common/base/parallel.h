#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace thalweg {

/// Calls work(i) for every i below `count`, in any order, from as many threads as there are cores, or at most
/// `threads` when that is not 0; which one does which is not told, so each call must stand alone. `grain`
/// calls at a time go to one thread. What a call throws is thrown from here, the first of them if several;
/// calls that have not begun by then are left out.
template <class Work>
void ParallelFor(std::size_t count, std::size_t grain, Work&& work, std::size_t threads = 0) {
  const std::size_t cores = threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
  const std::size_t helpers = std::min(cores, (count + grain - 1) / grain) - (count > 0 ? 1 : 0);
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> failed = false;
  std::exception_ptr failure;
  const auto run = [&] {
    try {
      for (std::size_t begin = next.fetch_add(grain); begin < count; begin = next.fetch_add(grain)) {
        for (std::size_t i = begin; i < std::min(begin + grain, count); ++i) {
          if (failed) return;
          work(i);
        }
      }
    } catch (...) {  // whatever it is, the caller gets it
      if (!failed.exchange(true)) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    others.reserve(helpers);
    for (std::size_t i = 0; i < helpers; ++i) others.emplace_back(run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace thalweg
