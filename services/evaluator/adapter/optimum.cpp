#include "services/evaluator/adapter/optimum.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <list>
#include <map>
#include <mutex>
#include <utility>

#include "common/base/parallel.h"
#include "common/base/stopwatch.h"
#include "common/files/write_file.h"
#include "services/evaluator/adapter/file_hash.h"
#include "services/evaluator/adapter/outcome_json.h"
#include "services/evaluator/adapter/scene.h"

namespace thalweg::evaluator {
namespace {

/// To be increased with every change of the search that changes its tours.
constexpr int kSearchVersion = 1;

template <class Vector>
std::string Numbers(const Vector& values) {
  std::string text;
  for (const double value : values.reshaped()) text += fmt::format("{:.17g} ", value);
  return text;
}

/// Everything that determines a tour.
std::string KeyOf(const Scene& scene, const Eigen::Vector3d& start_W, const TourGround::Options& tours) {
  const simulator::TrueMap::Options truth = scene.TruthOptions();
  const simulator::World& world = scene.world();
  const RobotModel& robot = truth.robot;
  std::string text = fmt::format("search {} bounds {}{}", kSearchVersion, Numbers(world.bounds().min()),
                                 Numbers(world.bounds().max()));
  for (const Eigen::AlignedBox3d& box : world.no_go()) {
    text += "no-go " + Numbers(box.min()) + Numbers(box.max());
  }
  text += fmt::format("robot {:.17g} {:.17g} {} {}", robot.radius, robot.height, robot.drives,
                      Numbers(robot.T_BC.matrix()));
  text += fmt::format("camera {} {} {:.17g} {:.17g} {:.17g} {:.17g} range {:.17g} voxel {:.17g} ",
                      truth.camera.width_px, truth.camera.height_px, truth.camera.fx, truth.camera.fy,
                      truth.camera.cx, truth.camera.cy, truth.view_range, truth.voxel_size);
  text += fmt::format("clearance {:.17g} spacing {:.17g} places {} samples {} seed {} iterations {} start {}",
                      tours.clearance, tours.spacing, tours.max_places, tours.max_samples, tours.seed,
                      tours.iterations, Numbers(start_W));
  return fmt::format("{:016x}", HashOf(text, HashOfFile(scene.scenario().world().file())));
}

class Cache {
 public:
  explicit Cache(std::filesystem::path file) : file_(std::move(file)) {
    std::ifstream stream(file_);
    std::size_t number = 0;
    for (std::string line; std::getline(stream, line);) {
      ++number;
      if (line.empty()) continue;
      const auto json = nlohmann::json::parse(line, nullptr, /*allow_exceptions=*/false);
      const bool good = json.is_object() && json.contains("key") && json["key"].is_string() &&
                        json.contains("budget_s") && json["budget_s"].is_number();
      Result<OfflineTours> tours =
          good ? OfflineToursFromJson(json) : Result<OfflineTours>(Error{"no tours"});
      if (tours) {
        entries_.insert_or_assign(json["key"].get<std::string>(),
                                  Entry{*std::move(tours), json["budget_s"].get<double>()});
      } else {  // the last line of a program that was killed while writing
        spdlog::warn("{}:{}: {}; the tours are not taken", file_.string(), number, tours.error());
      }
    }
  }

  /// @param budget  [s] Tours that ran out of a smaller one are not taken.
  const OfflineTours* Find(const std::string& key, double budget) const {
    const auto found = entries_.find(key);
    if (found == entries_.end()) return nullptr;
    if (found->second.tours.out_of_time && found->second.budget < budget) return nullptr;
    return &found->second.tours;
  }

  void Append(const std::string& key, const OfflineTours& tours, double budget) {
    if (file_.empty()) return;
    if (!stream_.is_open()) {
      if (file_.has_parent_path()) std::filesystem::create_directories(file_.parent_path());
      stream_.open(file_, std::ios::app);
      // Ends a line that was cut off; empty lines are skipped when reading.
      if (stream_ && stream_.tellp() > 0) stream_ << '\n';
    }
    nlohmann::ordered_json line = {{"key", key}, {"budget_s", budget}};
    line.update(ToJson(tours));
    if (!(stream_ << line.dump() << std::endl)) throw CannotWrite(file_, errno);
  }

 private:
  struct Entry {
    OfflineTours tours;
    double budget = 0.0;  ///< [s]
  };
  std::filesystem::path file_;
  std::ofstream stream_;
  std::map<std::string, Entry> entries_;
};

/// A start, and the outcomes of the runs from it.
struct Start {
  std::string key;
  Eigen::Vector3d start_W;
  std::vector<Outcome*> outcomes;
};

std::vector<Start> StartsIn(const Scene& scene, const TourGround::Options& tours,
                            std::vector<Outcome>& outcomes) {
  std::vector<Start> starts;
  for (Outcome& outcome : outcomes) {
    if (outcome.scenario != scene.name() || outcome.progress.empty()) continue;
    const Eigen::Vector3d& start_W = outcome.progress.front().p_W;
    std::string key = KeyOf(scene, start_W, tours);
    const auto known =
        std::find_if(starts.begin(), starts.end(), [&](const Start& start) { return start.key == key; });
    if (known != starts.end()) {
      known->outcomes.push_back(&outcome);
    } else {
      starts.push_back({std::move(key), start_W, {&outcome}});
    }
  }
  return starts;
}

}  // namespace

void AddOptimum(const OptimumOptions& options, std::vector<Outcome>& outcomes, const std::stop_token& stop,
                const std::function<void(const Outcome&, bool from_cache)>& on_tours) {
  Cache cache(options.cache);
  std::mutex mutex;  // guards cache and on_tours
  for (const std::string& name : options.scenarios) {
    const Scene scene(name, options.overrides);
    const LockstepOptions of_run = scene.Options("", 0);
    TourGround::Options tours = options.tours;
    tours.clearance = of_run.robot.radius + of_run.explorer.safety_margin;
    const auto hand_out = [&](const Start& start, const OfflineTours& found, bool from_cache) {
      for (Outcome* outcome : start.outcomes) outcome->optimum = found;
      if (on_tours) on_tours(*start.outcomes.front(), from_cache);
    };

    std::list<TourGround> grounds;
    std::vector<std::pair<const Start*, const TourGround*>> open;
    const std::vector<Start> starts = StartsIn(scene, tours, outcomes);
    for (const Start& start : starts) {
      if (stop.stop_requested()) return;
      if (const OfflineTours* found = cache.Find(start.key, tours.budget)) {
        hand_out(start, *found, true);
      } else if (!TourGround::Fits(scene.world(), of_run.robot, start.start_W, tours.clearance)) {
        hand_out(start, {}, false);
      } else {
        auto ground = std::find_if(grounds.begin(), grounds.end(),
                                   [&](const TourGround& g) { return g.HoldsFor(start.start_W); });
        if (ground == grounds.end()) {
          grounds.emplace_back(scene.world(), scene.Truth(start.start_W), scene.TruthOptions(), start.start_W,
                               tours, stop);
          ground = std::prev(grounds.end());
        }
        open.emplace_back(&start, &*ground);
      }
    }
    ParallelFor(
        open.size(), 1,
        [&](std::size_t n) {
          if (stop.stop_requested()) return;
          const OfflineTours found = open[n].second->ToursFrom(
              open[n].first->start_W, stop, [watch = Stopwatch()] { return watch.Milliseconds() * 1e-3; });
          if (stop.stop_requested()) return;
          const std::lock_guard lock(mutex);
          cache.Append(open[n].first->key, found, tours.budget);
          hand_out(*open[n].first, found, false);
        },
        static_cast<std::size_t>(options.threads));
  }
}

}  // namespace thalweg::evaluator
