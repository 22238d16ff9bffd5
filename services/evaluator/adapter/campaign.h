#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "services/evaluator/adapter/scene.h"

namespace thalweg::evaluator {

/// The part of a campaign that one of several processes makes: the runs k with k % count == index, which are
/// all strategies from a start, so that a part can be compared.
struct Shard {
  int index = 0;
  int count = 1;
};
/// The shard named "K/N", K from 1 to N. Throws std::invalid_argument for anything else.
Shard ShardFrom(const std::string& text);

/// A set of runs: each strategy, with each source of poses, in each scenario, from the same starts. Run k of
/// every combination has the seed `seed + k`, so that strategies can be compared in pairs.
///
/// Runs are distributed over threads, one thread per run, so outcomes do not depend on the number of threads.
/// Each outcome is appended to a journal as soon as it is known, and an aborted campaign resumes from its
/// journal.
class Campaign {
 public:
  struct Options {
    std::vector<std::string> scenarios;  ///< Names or files.
    std::vector<std::string> overrides;  ///< Apply to all scenarios, e.g. "mapper.voxel_size_m=0.05".
    std::vector<std::string> strategies;
    std::vector<PoseSource> poses = {PoseSource::kTruth};
    MotionModel motion = MotionModel::kKinematic;  ///< kDynamic needs the true pose.
    int runs = 10;
    int seed = 1;
    int threads = 0;                ///< 0 = one per core.
    bool tail = false;              ///< Whether outcomes have the runs' tails.
    std::filesystem::path journal;  ///< Empty = none.
    /// If given, outcomes have figures of surfaces, and the runs that are made leave their meshes in this
    /// folder, see Scene::Run.
    std::optional<std::filesystem::path> meshes = std::nullopt;
    Shard shard = {};
    /// Journals of others, from which outcomes are taken as well.
    std::vector<std::filesystem::path> merged = {};
  };
  /// Loads all scenarios. Throws std::runtime_error or std::invalid_argument naming the fault.
  explicit Campaign(const Options& options);

  std::size_t total() const { return jobs_.size(); }
  /// Number of outcomes taken from the journals: those by the same program, of the same scenario and world.
  std::size_t resumed() const { return resumed_; }

  /// The outcomes that there are, ordered by scenario, strategy, pose source and run.
  std::vector<Outcome> Outcomes() const;

  /// Runs everything that is not in the journals.
  /// @param on_outcome  Called after each run, one call at a time, with the outcome and the number of
  /// outcomes so far.
  /// @return As Outcomes. When stopped early, the outcomes so far; runs in progress are abandoned.
  /// Throws what a run throws, and std::runtime_error when the journal cannot be written.
  std::vector<Outcome> Run(std::stop_token stop,
                           const std::function<void(const Outcome&, std::size_t)>& on_outcome = {});

 private:
  struct Job {
    const Scene* scene;
    std::string strategy;
    PoseSource pose;
    int run;
    std::string key;  ///< Identifies the job in the journal.
    std::optional<Outcome> outcome;
  };
  /// Whether the mesh of a run is in the folder as the run has written it, and its picture.
  bool HasMesh(const Job& job, const Outcome& outcome) const;
  /// @param without_mesh  Whether to take runs whose mesh is wanted, but not there.
  void ReadJournal(const std::filesystem::path& file, bool without_mesh);

  Options options_;
  std::vector<std::unique_ptr<Scene>> scenes_;
  std::vector<Job> jobs_;
  std::size_t resumed_ = 0;
};

}  // namespace thalweg::evaluator
