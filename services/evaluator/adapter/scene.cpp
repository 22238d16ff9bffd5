#include "services/evaluator/adapter/scene.h"

#include <spdlog/spdlog.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "common/base/stopwatch.h"
#include "common/files/write_file.h"
#include "common/files/write_picture.h"
#include "common/scenario/models.h"
#include "services/controller/adapter/options.h"
#include "services/evaluator/adapter/file_hash.h"
#include "services/evaluator/adapter/stereo_options.h"
#include "services/evaluator/core/flown_trajectory.h"
#include "services/explorer/adapter/options.h"
#include "services/mapper/adapter/options.h"
#include "services/simulator/adapter/load_mesh.h"
#include "services/simulator/adapter/stereo_camera.h"
#include "services/simulator/core/reachable.h"
#include "services/surface/adapter/mesh_ply.h"
#include "services/surface/adapter/options.h"
#include "services/surface/evaluation/mesh_picture.h"
#include "services/visual_odometry/adapter/options.h"

namespace thalweg::evaluator {
namespace {

/// [s] CPU time of this thread.
double ThreadSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

void CheckNothingMoves(const std::vector<std::string>& scenarios, const std::vector<std::string>& overrides,
                       const std::string& for_what) {
  for (const std::string& name : scenarios) {
    if (LoadScenario(name, overrides).world().moving().empty()) continue;
    throw std::invalid_argument(for_what +
                                " needs a world that stays as it is, but parts of that of scenario " + name +
                                " move (world.moving)");
  }
}

Scene::Scene(const std::string& name_or_file, const std::vector<std::string>& overrides)
    : name_(std::filesystem::path(name_or_file).stem().string()),
      scenario_(LoadScenario(name_or_file, overrides, {.mistakes = explorer::MistakesIn})),
      world_(simulator::LoadWorld(scenario_)) {
  simulator::CheckExtent(world_, Options("", 0).mapper.voxel_size);
  Start(0);  // throws when the start is inside a wall, before any run
}

RigidTransform Scene::Start(int seed) const {
  const RobotModel robot = RobotFrom(scenario_);
  if (seed == 0) {
    Scenario scenario = scenario_;
    scenario.mutable_simulator()->clear_start_seed();
    return simulator::StartFrom(scenario, world_, robot);
  }
  const std::lock_guard lock(mutex_);
  if (start_places_.empty()) start_places_ = simulator::StartPlacesFrom(scenario_, world_, robot);
  return simulator::RandomStart(start_places_, static_cast<std::uint32_t>(seed));
}

LockstepOptions Scene::Options(const std::string& strategy, int seed, PoseSource pose,
                               MotionModel motion) const {
  LockstepOptions options;
  options.motion = motion;
  options.controller = controller::OptionsFrom(scenario_).type;
  options.robot = RobotFrom(scenario_);
  options.sensor = DepthSensorFrom(scenario_);
  if (scenario_.depth_source() == DepthSource::STEREO) options.stereo = StereoSensorFrom(scenario_);
  options.mapper = mapper::OptionsFrom(scenario_, {}).map;
  options.filter = MapFrom(scenario_).filter;
  Scenario with_strategy = scenario_;
  if (!strategy.empty()) with_strategy.mutable_explorer()->set_strategy(strategy);
  options.explorer = explorer::OptionsFrom(with_strategy);
  options.noise_seed = static_cast<std::uint32_t>(std::max(1, seed));
  if (pose == PoseSource::kOdometry) {
    Scenario scenario = scenario_;
    scenario.mutable_simulator()->clear_start_seed();  // each run passes its own start
    options.own_pose = {simulator::StereoRigFrom(scenario), visual_odometry::OptionsFrom(scenario).estimator};
    // The longest time step, up to the usual one, that divides the frame period, so that frames fall on
    // steps.
    const double period = 1.0 / options.own_pose->camera.rate;
    options.time_step = period / std::ceil(period / options.time_step);
  }
  return options;
}

simulator::TrueMap::Options Scene::TruthOptions() const {
  const LockstepOptions options = Options("", 0);
  return {.voxel_size = options.mapper.voxel_size,
          .robot = options.robot,
          .camera = options.sensor.camera,
          .view_range = MapFrom(scenario_).SeenRange(options.sensor.max_range)};
}

std::shared_ptr<const simulator::TrueMap> Scene::Truth(const Eigen::Vector3d& start_W) const {
  const std::lock_guard lock(mutex_);
  for (const auto& truth : truths_) {
    if (truth->HoldsFor(start_W)) return truth;
  }
  truths_.push_back(std::make_shared<const simulator::TrueMap>(world_, start_W, TruthOptions()));
  return truths_.back();
}

std::shared_ptr<const SurfaceTruth> Scene::Surfaces(const std::shared_ptr<const simulator::TrueMap>& truth,
                                                    const Eigen::Vector3d& start_W) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [known, surface] : surfaces_) {
    if (known == truth) return surface;
  }
  surfaces_.emplace_back(
      truth, std::make_shared<const SurfaceTruth>(SurfaceTruth::Of(world_, *truth, TruthOptions(), start_W)));
  return surfaces_.back().second;
}

std::unique_ptr<mapper::FusedMap> Scene::NewMap() const {
  const mapper::MapperOptions options = mapper::OptionsFrom(scenario_, {});
  return mapper::MakeMap(options.engine, options.map);
}

std::optional<NoiseFreeMap> Scene::NewNoiseFreeMap(const LockstepOptions& options) const {
  const bool has_noise = options.sensor.disparity_noise_px > 0.0 || options.sensor.image_noise_px > 0.0;
  if (!has_noise || options.stereo || options.own_pose || !world_.parts().empty()) return std::nullopt;
  Scenario without = scenario_;
  without.mutable_depth_sensor()->clear_disparity_noise_px();
  without.mutable_depth_sensor()->clear_image_noise_px();
  const mapper::MapperOptions mapper = mapper::OptionsFrom(without, {});
  return std::make_optional<NoiseFreeMap>(world_, options.sensor, mapper::MakeFilter(mapper.filter),
                                          mapper::MakeMap(mapper.engine, mapper.map));
}

Outcome Scene::Run(const std::string& strategy, int seed, PoseSource pose, std::stop_token stop,
                   bool with_tail, MotionModel motion,
                   const std::optional<std::filesystem::path>& meshes) const {
  const Stopwatch wall;
  const double cpu = ThreadSeconds();
  LockstepOptions options = Options(strategy, seed, pose, motion);
  options.stop = std::move(stop);
  options.colors = meshes.has_value();
  const RigidTransform start = Start(seed);
  const auto truth = Truth(start.translation());
  const std::unique_ptr<mapper::FusedMap> map = NewMap();
  TailRecorder tail;
  PlanObserver on_plan;
  ScanObserver on_scan;
  if (with_tail) {
    on_plan = [&](const explorer::Plan& plan, const explorer::Explorer& explorer, const RigidTransform&) {
      tail.OnPlan(plan, explorer.target());
    };
    const auto all = static_cast<double>(std::max<std::size_t>(1, truth->observable_count()));
    on_scan = [&, all](const LockstepResult::Sample& sample, const explorer::Explorer& explorer) {
      tail.OnScan(sample.distance, static_cast<double>(sample.observed) / all, sample.p_W, explorer.map());
    };
  }
  std::shared_ptr<const SurfaceTruth> surfaces;
  std::optional<SurfaceRecorder> recorder;
  std::optional<NoiseFreeMap> noise_free = NewNoiseFreeMap(options);
  if (meshes) {
    surfaces = Surfaces(truth, start.translation());
    DepthSensorModel sensor = options.sensor;
    if (options.stereo) sensor.camera = options.stereo->rig.camera;
    recorder.emplace(world_, *surfaces, sensor, surface::OptionsFrom(scenario_, *meshes).surface);
  }
  CloudObserver on_cloud;
  if (recorder || noise_free) {
    on_cloud = [&](const PointCloud& cloud, const RigidTransform& T_WC, const RigidTransform& T_WC_true) {
      if (recorder) recorder->OnScan(cloud, T_WC, T_WC_true);
      if (noise_free) noise_free->OnScan(T_WC_true);
    };
  }
  const LockstepResult result =
      RunLockstep(world_, start, options, *map, on_plan, truth.get(), on_scan, on_cloud);
  const OccupancyGrid known = map->Snapshot();
  Outcome outcome = Judge(result, known, *truth);
  if (noise_free) outcome.likeness = noise_free->Likeness(known);
  if (recorder) {
    outcome.surface = recorder->Figures(options.mapper.voxel_size);
    if (recorder->full())
      spdlog::warn("{} {}: the surface takes surface.most_memory_mb: nothing new was added to it", name_,
                   seed);
  }
  if (recorder && outcome.end.kind != RunEnd::Kind::kInterrupted) {
    const surface::TriangleMesh mesh = recorder->mesh().Joined();
    std::filesystem::path file = *meshes / MeshFile(options.explorer.strategy.name, seed, pose);
    const std::string ply = surface::PlyOf(mesh);
    WriteFile(file, ply);
    outcome.mesh_hash = HashText(HashOf(ply));
    WritePicture(file.replace_extension(".png"), surface::DrawMesh(mesh));
  }
  if (with_tail) outcome.tail = tail.Finish(result.distance);
  outcome.scenario = name_;
  outcome.strategy = options.explorer.strategy.name + (pose == PoseSource::kOdometry ? ", odometry" : "");
  outcome.seed = seed;
  outcome.wall = wall.Milliseconds() * 1e-3;
  outcome.cpu = ThreadSeconds() - cpu;
  return outcome;
}

std::string Scene::MeshFile(const std::string& strategy, int seed, PoseSource pose) const {
  const char* const source = pose == PoseSource::kOdometry ? "-odometry-" : "-";
  return name_ + '-' + strategy + source + std::to_string(seed) + ".ply";
}

Outcome Scene::JudgeTrajectory(std::span<const TimedPose> T_WBs, const std::string& name,
                               std::stop_token stop) const {
  const Stopwatch wall;
  const double cpu = ThreadSeconds();
  LockstepOptions options = Options("", 0);
  options.stop = std::move(stop);
  if (T_WBs.empty()) throw std::invalid_argument("a trajectory needs at least two poses");
  const auto truth = Truth(T_WBs.front().T.translation());
  const std::unique_ptr<mapper::FusedMap> map = NewMap();
  const LockstepResult result = Fly(world_, T_WBs, options, *map, *truth);
  Outcome outcome = Judge(result, map->Snapshot(), *truth);
  outcome.scenario = name_;
  outcome.strategy = name;
  outcome.wall = wall.Milliseconds() * 1e-3;
  outcome.cpu = ThreadSeconds() - cpu;
  return outcome;
}

}  // namespace thalweg::evaluator
