#include "services/evaluator/adapter/campaign.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <exception>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "common/base/hash.h"
#include "common/base/text.h"
#include "common/files/write_file.h"
#include "common/scenario/models.h"
#include "services/evaluator/adapter/file_hash.h"
#include "services/evaluator/adapter/outcome_json.h"
#include "services/explorer/adapter/options.h"

namespace thalweg::evaluator {
namespace {

/// Hash of everything besides strategy and seed that determines an outcome: this program, the scenario, the
/// world, which may lie elsewhere on another machine.
std::string FingerprintOf(const Scenario& scenario) {
  static const std::uint64_t program = HashOfFile("/proc/self/exe");
  const std::uint64_t world = HashOfFile(scenario.world().file(), program);
  Scenario anywhere = scenario;
  anywhere.mutable_world()->clear_file();
  return HashText(HashOf(anywhere.SerializeAsString(), world));
}

int ThreadsFor(int asked, std::size_t jobs) {
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return std::min(asked > 0 ? asked : cores, static_cast<int>(std::max<std::size_t>(1, jobs)));
}

/// Throws std::invalid_argument naming those that are unknown, before worlds are loaded.
void CheckStrategies(const std::vector<std::string>& strategies) {
  std::string text;
  for (const std::string& name : strategies) {
    Scenario scenario;
    scenario.mutable_explorer()->set_strategy(name);
    // Whether the robot is one for it is its scenario's to say.
    const bool drives = explorer::MisfitOf(RobotFrom(scenario), name).has_value();
    scenario.mutable_robot()->set_drives(drives);
    for (const Mistake& mistake : explorer::MistakesIn(scenario)) {
      text.append(text.empty() ? "" : "\n").append("strategy ").append(mistake.text);
    }
  }
  if (!text.empty()) throw std::invalid_argument(text);
}

/// Throws std::invalid_argument naming what is there twice: its runs would be counted, and its files written,
/// twice.
void CheckTwice(const std::string& what, std::vector<std::string> names) {
  std::ranges::sort(names);
  const auto twice = std::ranges::adjacent_find(names);
  if (twice != names.end()) throw std::invalid_argument(what + " " + *twice + " is given twice");
}

/// Throws std::invalid_argument if a strategy is not one for the robot of a scenario.
void CheckStrategy(const std::string& strategy, const Scene& scene) {
  try {
    const explorer::Explorer probe(scene.Options(strategy, 0).explorer);
  } catch (const std::invalid_argument& mistake) {
    throw std::invalid_argument("scenario " + scene.name() + ": " + mistake.what());
  }
}

}  // namespace

Shard ShardFrom(const std::string& text) {
  int number = 0;
  int count = 0;
  const char* const end = text.data() + text.size();
  const auto [slash, number_error] = std::from_chars(text.data(), end, number);
  const bool split = number_error == std::errc() && slash != end && *slash == '/';
  if (split) {
    const auto [rest, count_error] = std::from_chars(slash + 1, end, count);
    if (count_error != std::errc() || rest != end) count = 0;
  }
  if (number < 1 || number > count)
    throw std::invalid_argument("a shard must be K/N with K from 1 to N, is " + CleanText(text));
  return {number - 1, count};
}

Campaign::Campaign(const Options& options) : options_(options) {
  if (options.scenarios.empty()) throw std::invalid_argument("no scenario is given");
  if (options.strategies.empty()) throw std::invalid_argument("no strategy is given");
  CheckTwice("strategy", options.strategies);
  if (options.poses.empty()) throw std::invalid_argument("no source of poses is given");
  if (std::set(options.poses.begin(), options.poses.end()).size() < options.poses.size())
    throw std::invalid_argument("a source of poses is given twice");
  if (options.runs < 1) throw std::invalid_argument("runs must be >= 1, is " + std::to_string(options.runs));
  if (options.seed < 1) throw std::invalid_argument("seed must be >= 1, is " + std::to_string(options.seed));
  const auto [shard, shards] = options.shard;
  if (shards < 1 || shard < 0 || shard >= shards)
    throw std::invalid_argument(fmt::format("shard must be 0 to {}, is {}", shards - 1, shard));
  if (options.motion == MotionModel::kDynamic && std::ranges::count(options.poses, PoseSource::kOdometry) > 0)
    throw std::invalid_argument("dynamic motion needs the true pose");
  CheckStrategies(options.strategies);
  for (const std::string& name : options.scenarios) {
    scenes_.push_back(std::make_unique<Scene>(name, options.overrides));
  }
  std::vector<std::string> names;
  for (const auto& scene : scenes_) names.push_back(scene->name());
  CheckTwice("scenario", names);
  for (const auto& scene : scenes_) {
    const std::string fingerprint = FingerprintOf(scene->scenario());
    for (const std::string& strategy : options.strategies) {
      CheckStrategy(strategy, *scene);
      for (const PoseSource pose : options.poses) {
        for (int run = shard; run < options.runs; run += shards) {
          jobs_.push_back({.scene = scene.get(),
                           .strategy = strategy,
                           .pose = pose,
                           .run = run,
                           .key = fingerprint + ' ' + scene->name() + ' ' + strategy + ' ' +
                                  (pose == PoseSource::kOdometry ? "odometry " : "") +
                                  (options.motion == MotionModel::kDynamic ? "dynamic " : "") +
                                  (options.tail ? "tail " : "") + (options.meshes ? "surface " : "") +
                                  std::to_string(options.seed + run),
                           .outcome = {}});
        }
      }
    }
  }
  if (!options.journal.empty() && std::filesystem::exists(options.journal))
    ReadJournal(options.journal, !options.merged.empty());
  for (const std::filesystem::path& file : options.merged) ReadJournal(file, true);
}

void Campaign::ReadJournal(const std::filesystem::path& file, bool without_mesh) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  std::map<std::string, Outcome> known;
  std::size_t number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (line.empty()) continue;
    const auto json = nlohmann::json::parse(line, nullptr, /*allow_exceptions=*/false);
    const bool good = json.is_object() && json.contains("key") && json["key"].is_string();
    Result<Outcome> outcome = good ? OutcomeFromJson(json) : Result<Outcome>(Error{"no outcome"});
    if (outcome) {
      known.insert_or_assign(json["key"].get<std::string>(), *std::move(outcome));
    } else {  // the last line of a program that was killed while writing
      spdlog::warn("{}:{}: {}; the run is not taken", file.string(), number, outcome.error());
    }
  }
  std::size_t meshes_missing = 0;
  for (Job& job : jobs_) {
    const auto found = known.find(job.key);
    if (found == known.end() || job.outcome) continue;
    if (options_.meshes && !without_mesh && !HasMesh(job, found->second)) {
      ++meshes_missing;
      continue;
    }
    job.outcome = found->second;
    job.outcome->run = job.run;
    ++resumed_;
  }
  if (meshes_missing > 0) {
    spdlog::warn("{}: {} of its runs are made again, since their meshes are not in {}", file.string(),
                 meshes_missing, options_.meshes->string());
  }
}

bool Campaign::HasMesh(const Job& job, const Outcome& outcome) const {
  std::filesystem::path file =
      *options_.meshes / job.scene->MeshFile(job.strategy, options_.seed + job.run, job.pose);
  if (!std::filesystem::exists(file) || HashText(HashOfFile(file)) != outcome.mesh_hash) return false;
  return std::filesystem::exists(file.replace_extension(".png"));
}

std::vector<Outcome> Campaign::Run(std::stop_token stop,
                                   const std::function<void(const Outcome&, std::size_t)>& on_outcome) {
  std::vector<Job*> open;
  for (Job& job : jobs_) {
    if (!job.outcome) open.push_back(&job);
  }
  // Run all strategies from one start before the next start, so that the part of an aborted campaign that is
  // done can already be compared.
  std::stable_sort(open.begin(), open.end(), [](const Job* a, const Job* b) { return a->run < b->run; });

  std::ofstream journal;
  if (!options_.journal.empty() && (!open.empty() || jobs_.empty())) {
    if (options_.journal.has_parent_path())
      std::filesystem::create_directories(options_.journal.parent_path());
    journal.open(options_.journal, std::ios::app);
    if (!journal) throw CannotWrite(options_.journal, errno);
    // Ends a line that was cut off; empty lines are skipped when reading.
    if (journal.tellp() > 0) journal << '\n';
  }
  std::mutex mutex;  // guards the variables below and the journal
  std::size_t made = resumed_;
  std::exception_ptr failure;
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t n = next++; n < open.size() && !stop.stop_requested(); n = next++) {
      try {
        Job& job = *open[n];
        Outcome outcome = job.scene->Run(job.strategy, options_.seed + job.run, job.pose, stop, options_.tail,
                                         options_.motion, options_.meshes);
        if (outcome.end.kind == RunEnd::Kind::kInterrupted) break;
        outcome.run = job.run;
        const std::lock_guard lock(mutex);
        if (journal.is_open()) {
          nlohmann::ordered_json line = {{"key", job.key}};
          line.update(ToJson(outcome));
          if (!(journal << line.dump() << std::endl)) {
            throw CannotWrite(options_.journal, errno);
          }
        }
        ++made;
        if (on_outcome) on_outcome(outcome, made);
        job.outcome = std::move(outcome);
      } catch (const std::exception&) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        next = open.size();
      }
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int k = 1; k < ThreadsFor(options_.threads, open.size()); ++k) threads.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
  return Outcomes();
}

std::vector<Outcome> Campaign::Outcomes() const {
  std::vector<Outcome> outcomes;
  for (const Job& job : jobs_) {
    if (job.outcome) outcomes.push_back(*job.outcome);
  }
  return outcomes;
}

}  // namespace thalweg::evaluator
