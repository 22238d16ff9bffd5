#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace thalweg::explorer::field {

/// Threads that run the same code over different planes and meet at barriers. A barrier spins for a while
/// before it sleeps. Sweeps over a coarse level take only microseconds, but on a busy machine the thread that
/// the others wait for may not even be running.
class Team {
 public:
  explicit Team(int count) : count_(count < 1 ? 1 : count) {}

  /// One thread's share in the team. Alone() returns a member that has all the work and waits for nobody.
  struct Member {
    Team* team = nullptr;
    int index = 0;
    int count = 1;

    void Wait() const {
      if (count > 1) team->Wait();
    }
    bool leads() const { return index == 0; }
    Member Alone() const { return {team, 0, 1}; }
  };

  /// Calls work(member) on every thread and returns when all are done.
  template <class Work>
  void Run(Work&& work) {
    std::vector<std::jthread> others;
    for (int k = 1; k < count_; ++k) others.emplace_back([&, k] { work(Member{this, k, count_}); });
    work(Member{this, 0, count_});
  }

  /// Splits [0, planes) evenly and calls work(begin, end, k) in parallel for each part k < count().
  template <class Work>
  void ForParts(int planes, std::size_t cells, Work&& work) {
    if (count_ == 1 || cells < kWorthThreads) return work(0, planes, 0);
    Run([&](const Member& member) {
      work(planes * member.index / count_, planes * (member.index + 1) / count_, member.index);
    });
  }

  /// Two sweeps over a member's planes [begin, end) as one: calls ahead(plane) for every plane, and
  /// follow(plane) once that plane and those beside it are done, also where these are another member's. What
  /// a plane's follow reads of them is then still in the cache.
  template <class Ahead, class Follow>
  static void Pipeline(const Member& member, int begin, int end, Ahead&& ahead, Follow&& follow) {
    // Other members read the outermost planes, so these are first.
    if (begin < end) ahead(begin);
    if (begin + 1 < end) ahead(end - 1);
    member.Wait();
    for (int plane = begin; plane < end; ++plane) {
      if (plane + 2 < end) ahead(plane + 1);
      follow(plane);
    }
  }

  int count() const { return count_; }

 private:
  void Wait() {
    const unsigned round = round_.load(std::memory_order_relaxed);
    if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == count_) {
      arrived_.store(0, std::memory_order_relaxed);
      round_.store(round + 1, std::memory_order_release);
      round_.notify_all();
      return;
    }
    for (int spins = 0; spins < kSpins; ++spins) {
      if (round_.load(std::memory_order_acquire) != round) return;
    }
    round_.wait(round, std::memory_order_acquire);
  }

  static constexpr std::size_t kWorthThreads = 50000;
  static constexpr int kSpins = 4000;
  int count_;
  alignas(64) std::atomic<int> arrived_{0};
  alignas(64) std::atomic<unsigned> round_{0};
};

}  // namespace thalweg::explorer::field
