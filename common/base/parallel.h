#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace thalweg {

/// Calls work(i) for every i < count, in any order, on one thread per core, or on at most `threads` threads
/// if that is not 0. Calls must be independent of each other, since any thread may make any of them. A thread
/// takes `grain` consecutive calls at a time. If calls throw, the first exception is rethrown from here, and
/// calls not yet begun are skipped.
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
    } catch (...) {  // passed on to the caller, whatever its type
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
