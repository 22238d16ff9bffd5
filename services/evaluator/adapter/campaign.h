#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "services/evaluator/adapter/scene.h"

namespace thalweg::evaluator {

/// Every strategy, with every source of poses, in every scenario from the same starts: run k of each has seed
/// `seed + k`.
///
/// Runs are spread over threads, each run on one; so an outcome does not depend on their number. Each is
/// written to a journal as soon as it is there, and a campaign that was broken off goes on from there.
class Campaign {
 public:
  struct Options {
    std::vector<std::string> scenarios;  ///< Names or files.
    std::vector<std::string> overrides;  ///< "mapper.voxel_size_m=0.05", of all scenarios.
    std::vector<std::string> strategies;
    std::vector<PoseSource> poses = {PoseSource::kTruth};
    int runs = 10;
    int seed = 1;
    int threads = 0;                ///< 0 = one a core
    std::filesystem::path journal;  ///< Empty = none.
  };
  /// Loads all scenarios. Throws std::runtime_error or std::invalid_argument naming what is wrong.
  explicit Campaign(const Options& options);

  std::size_t total() const { return jobs_.size(); }
  /// Taken over from the journal: made by the same program, of the same scenario and world.
  std::size_t resumed() const { return resumed_; }

  /// @param told  After each run, one call at a time: the outcome, and how many there are now.
  /// @return      In the order scenario, strategy, run; those that were made, when stopped before the end;
  /// runs that go on
  ///              then are given up.
  /// Throws what a run throws, and std::runtime_error when the journal cannot be written.
  std::vector<Outcome> Run(std::stop_token stop,
                           const std::function<void(const Outcome&, std::size_t)>& told = {});

 private:
  struct Job {
    const Scene* scene;
    std::string strategy;
    PoseSource pose;
    int run;
    std::string key;  ///< In the journal.
    std::optional<Outcome> outcome;
  };
  void ReadJournal();

  Options options_;
  std::vector<std::unique_ptr<Scene>> scenes_;
  std::vector<Job> jobs_;
  std::size_t resumed_ = 0;
};

}  // namespace thalweg::evaluator
