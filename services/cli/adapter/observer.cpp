#include "services/cli/adapter/observer.h"

#include <algorithm>
#include <cmath>

#include "common/base/stage_names.h"
#include "common/base/text.h"
#include "common/dds/bus_graph.h"
#include "common/dds/convert.h"
#include "common/geometry/polyline.h"
#include "common/scenario/models.h"
#include "common/service/service.h"
#include "services/cli/adapter/service_names.h"
#include "services/cli/report/floor_below.h"
#include "services/cli/report/remaining_time.h"
#include "services/cli/report/run_summary.h"
#include "services/explorer/adapter/convert.h"
#include "services/explorer/text/outcome_text.h"
#include "services/mapper/adapter/mapper_service.h"

namespace thalweg::cli {
namespace {

namespace topics = dds::topics;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

constexpr auto kLongestWaitForMap = 5s;     // of wall time, after the end of the exploration
constexpr auto kLeastBetweenRestarts = 1s;  // of wall time
constexpr auto kPatienceWithClock = 5s;     // of wall time; peers find each other in three
constexpr auto kPatienceWithOdometry = 5s;
constexpr std::uint64_t kManyPoses = 100;  // which a few late ones are not
constexpr auto kTroubleShown = 3s;         // of wall time, after the last refusal
constexpr auto kStopToTell = 1s;           // of wall time; shorter stops are part of replanning
constexpr int kJumpsOfTwo = 5;             // consecutive jumps that restarts would not explain
constexpr auto kBetweenSimulators = 20ms;  // of the run's time, standing in for an unknown time
constexpr double kLeastStep = 0.005;       // [m] smaller steps are odometry noise rather than travel

// More than any of our services sends; bounds what a peer can make a report hold.
constexpr std::size_t kMostEntries = 64;     // of each list in a message
constexpr std::size_t kMostProcesses = 256;  // that report their health
constexpr std::size_t kMostCounts = 1024;    // of messages that were not used
constexpr std::size_t kMostFrontiers = 2048;
constexpr std::size_t kMostOfDetails = 600;  // characters of what stayed unknown

/// Limits a list and cleans the named entries' names.
template <class List>
void CleanNames(List& list) {
  if (list.size() > kMostEntries) list.resize(kMostEntries);
  for (auto& entry : list) entry.name(CleanText(entry.name()));
}

thalweg_msgs::msg::ExplorationStatus Cleaned(thalweg_msgs::msg::ExplorationStatus status) {
  status.strategy(CleanText(status.strategy()));
  status.stop_reason(CleanText(status.stop_reason()));
  status.stop_details(CleanText(status.stop_details(), kMostOfDetails));
  status.activity(CleanText(status.activity()));
  status.last_interruption(CleanText(status.last_interruption()));
  if (status.interruptions().size() > kMostEntries) status.interruptions().resize(kMostEntries);
  if (status.set_aside().size() > kMostEntries) status.set_aside().resize(kMostEntries);
  CleanNames(status.timings());
  return status;
}

thalweg_msgs::msg::ServiceHealth Cleaned(thalweg_msgs::msg::ServiceHealth health) {
  health.service(CleanText(health.service()));
  health.host(CleanText(health.host()));
  CleanNames(health.timings());
  for (auto* counters : {&health.rejected(), &health.dropped()}) {
    CleanNames(*counters);
    for (auto& counter : *counters) counter.last(CleanText(counter.last()));
  }
  return health;
}

template <class Timings>
std::vector<StageTiming> StagesOf(const Timings& timings) {
  std::vector<StageTiming> stages;
  for (const auto& timing : timings) {
    stages.push_back({.name = timing.name(),
                      .count = timing.count(),
                      .p50_ms = timing.p50_ms(),
                      .p95_ms = timing.p95_ms(),
                      .max_ms = timing.max_ms()});
  }
  return stages;
}

/// Number of plans that were abandoned.
std::uint64_t AbandonedIn(const thalweg_msgs::msg::ExplorationStatus& status) {
  std::uint64_t plans = 0;
  for (const auto& count : status.interruptions()) plans += count.plans();
  return plans;
}

/// The point, unless it is the NaN that stands for none.
std::optional<Eigen::Vector3d> PointIn(const geometry_msgs::msg::Point& point) {
  const Eigen::Vector3d p_W(point.x(), point.y(), point.z());
  return p_W.allFinite() ? std::optional(p_W) : std::nullopt;
}

/// "mapper rejects depth/points: frame_id is ..."
std::string RefusalText(const std::string& service, const thalweg_msgs::msg::Counter& counter) {
  return service + " rejects " + counter.name() + ": " + counter.last();
}

/// "controller cannot use odometry: its stamp is ..."
std::string UnusablePoseText(const std::string& service, const thalweg_msgs::msg::Counter& counter) {
  return service + " cannot use " + counter.name() + ": " + counter.last();
}

std::string NoOdometryText(const Scenario& scenario) {
  return "nobody publishes " + dds::WireTopic(NamesFrom(scenario).Topic(topics::Odometry::kName)) +
         " as nav_msgs/msg/Odometry in this domain; thalweg doctor names what is published";
}

/// Whether a service's counter is that of poses by which the robot cannot be led.
bool IsOfPoses(const std::string& service, const std::string& counter) {
  return service == kController && counter == topics::Odometry::kName;
}

/// Whether a counter is that of clouds or depth images.
bool IsOfClouds(const std::string& counter) {
  return counter == topics::DepthPoints::kName || counter == topics::DepthImage::kName;
}

/// Whether a counter has increased since the counters `before`.
bool HasGrown(const thalweg_msgs::msg::Counter& counter,
              const std::vector<thalweg_msgs::msg::Counter>& before) {
  const auto is_same = [&](const auto& other) { return other.name() == counter.name(); };
  const auto known = std::ranges::find_if(before, is_same);
  return known == before.end() || known->count() < counter.count();
}

template <class Counters>
std::uint64_t SumOf(const Counters& counters) {
  std::uint64_t sum = 0;
  for (const auto& counter : counters) sum += counter.count();
  return sum;
}

/// Adds counters under their service and name: a service may have been restarted as another process.
void AddCounts(const std::string& service, const std::vector<thalweg_msgs::msg::Counter>& counters,
               std::vector<MessageCount>& counts) {
  for (const auto& counter : counters) {
    const auto known = std::ranges::find_if(counts, [&](const MessageCount& entry) {
      return entry.service == service && entry.name == counter.name();
    });
    if (known == counts.end()) {
      if (counts.size() < kMostCounts)
        counts.push_back({service, counter.name(), counter.count(), counter.last()});
    } else {
      known->count += counter.count();
      known->last = counter.last();
    }
  }
}

}  // namespace

Observer::Observer(const Scenario& scenario, const std::string& name, dds::Bus& bus)
    : scenario_(scenario), name_(name), bus_(bus), requests_out_(bus.Advertise<topics::MapRequests>()) {
  bus.Subscribe<topics::MapUpdates>([this](const auto& message) { OnMapUpdate(message); });
  bus.Subscribe<topics::Odometry>([this](const auto& message) { OnOdometry(message); });
  bus.Subscribe<topics::Path>([this](const auto& message) { OnPath(message); });
  bus.Subscribe<topics::Frontiers>([this](const auto& message) { OnFrontiers(message); });
  bus.Subscribe<topics::ExplorationStatus>([this](const auto& message) { OnExploration(message); });
  bus.Subscribe<topics::MotionStatus>([this](const auto& message) { OnMotion(message); });
  bus.Subscribe<topics::SimulationStatus>([this](const auto& message) { OnSimulation(message); });
  bus.Subscribe<topics::SurfaceStatus>([this](const auto& message) { OnSurface(message); });
  bus.Subscribe<topics::Health>([this](const auto& message) { OnHealth(message); });
  bus.Every(1s, [this] { Sample(); });
  bus.EveryWall(500ms, [this] { RequestMap(); });
  bus.EveryWall(100ms, [this] {
    BeginTruth();
    JudgeWhetherFinished();
  });
}

void Observer::OnMapUpdate(const thalweg_msgs::msg::MapUpdate& message) {
  if (tally_.known() == 0) Sample();  // the curve begins at zero
  const auto applied = map_.Apply(message);
  if (!applied) return bus_.health().Reject<topics::MapUpdates>(applied.error());
  if (!*applied) return;
  if ((*applied)->replaced) tally_.Add(map_.grid());
  for (const VoxelChange& change : (*applied)->changes) {
    if (!std::isnan(change.log_odds)) tally_.Add(change.voxel);
  }
  if (const auto stamp = dds::FromIdl(message.header(), dds::kMapFrame)) map_stamp_ = *stamp;
}

void Observer::RequestMap() {
  if (map_.missing()) requests_out_.Write(map_.MakeRequest(bus_.Now(), "thalweg"));
}

void Observer::OnOdometry(const nav_msgs::msg::Odometry& message) {
  const auto pose = dds::FromIdl(message);
  if (!pose) return bus_.health().Reject<topics::Odometry>(pose.error());
  Time stamp = pose->stamp - clock_offset_;
  if (!trajectory_.empty() && stamp <= trajectory_.back().stamp) {
    const Duration back = trajectory_.back().stamp - stamp;
    if (back < kClockRestart) return;
    // Another simulator, with the robot at another place: the run's time continues, and the jump is not
    // travel.
    const bool again = Steady::now() - clock_went_back_ < kLeastBetweenRestarts;
    jumps_in_a_row_ = again ? jumps_in_a_row_ + 1 : 1;
    clock_went_back_ = Steady::now();
    clock_offset_ -= back + kBetweenSimulators;
    stamp = trajectory_.back().stamp + kBetweenSimulators;
    counted_W_ = pose->T.translation();
  }
  if (trajectory_.empty()) counted_W_ = pose->T.translation();
  trajectory_.push_back({.stamp = stamp, .T = pose->T});
  const double step = (pose->T.translation() - counted_W_).norm();
  if (step < kLeastStep) return;
  distance_ += step;
  counted_W_ = pose->T.translation();
}

void Observer::OnPath(const nav_msgs::msg::Path& message) {
  const auto path = dds::FromIdl(message);
  if (!path) return bus_.health().Reject<topics::Path>(path.error());
  if (!path->T_WBs.empty()) decisions_.OnPath(path->stamp, PathLength(path->T_WBs));  // empty: a stop
}

void Observer::OnFrontiers(const thalweg_msgs::msg::FrontierList& message) {
  frontiers_.clear();
  for (const auto& frontier : message.frontiers()) {
    const auto center_W = PointIn(frontier.center());
    if (!center_W || frontiers_.size() >= kMostFrontiers) continue;
    frontiers_.push_back(
        {.center_W = *center_W,
         .voxels = frontier.voxels(),
         .fate = static_cast<int>(frontier.fate()),
         .reason = explorer::AsideText(explorer::FromIdl(frontier.reason()), frontier.doubtful())});
  }
}

void Observer::OnExploration(const thalweg_msgs::msg::ExplorationStatus& message) {
  if (message.plans() < exploration_.plans()) {  // the explorer was restarted
    plans_before_ += exploration_.plans();
    replans_before_ += exploration_.replans();
  }
  heard_explorer_ = Steady::now();
  exploration_ = Cleaned(message);
  if (const auto stamp = dds::FromIdl(message.header(), dds::kMapFrame)) {
    decisions_.OnStatus({.stamp = *stamp,
                         .time = TimeNow(),
                         .plans = message.plans(),
                         .abandoned = AbandonedIn(exploration_),
                         .activity = exploration_.activity(),
                         .last_interruption = exploration_.last_interruption(),
                         .target_W = PointIn(exploration_.target())});
  }
  const bool done = message.state() == thalweg_msgs::msg::EXPLORATION_DONE;
  if (!done) done_.reset();
  if (!done || done_) return;
  Sample();
  const auto stamp = dds::FromIdl(message.header(), dds::kMapFrame);
  done_ = stamp ? *stamp : bus_.Now();
  done_wall_ = Steady::now();
  done_time_ = TimeNow();
}

void Observer::OnSimulation(const thalweg_msgs::msg::SimulationStatus& message) {
  if (simulation_ && message.true_collisions() < simulation_->true_collisions()) {
    // the simulator was restarted
    collisions_before_ += simulation_->true_collisions();
  }
  simulation_ = message;
}

void Observer::OnSurface(const thalweg_msgs::msg::SurfaceStatus& message) {
  for (const double area : {message.area_m2(), message.inspected_m2()}) {
    if (!(std::isfinite(area) && area >= 0.0))
      return bus_.health().Reject<topics::SurfaceStatus>("an area is no number of square meters");
  }
  surface_ = message;
}

void Observer::OnMotion(const thalweg_msgs::msg::MotionStatus& message) {
  heard_controller_ = true;
  const bool stopped = message.state() == thalweg_msgs::msg::MOTION_STOPPED;
  if (!stopped) stopped_since_.reset();
  if (stopped && !stopped_since_) stopped_since_ = Steady::now();
  stop_ = stopped ? CleanText(message.reason()) : "";
}

void Observer::OnHealth(const thalweg_msgs::msg::ServiceHealth& message) {
  thalweg_msgs::msg::ServiceHealth health = Cleaned(message);
  const std::pair process(health.service(), health.process_id());
  if (health_.size() >= kMostProcesses && !health_.contains(process)) {
    return bus_.health().Drop<topics::Health>("more than " + std::to_string(kMostProcesses) + " processes");
  }
  const auto before = health_.find(process);
  NoteTrouble(before == health_.end() ? thalweg_msgs::msg::ServiceHealth() : before->second, health);
  health_[process] = std::move(health);
}

void Observer::NoteTrouble(const thalweg_msgs::msg::ServiceHealth& before,
                           const thalweg_msgs::msg::ServiceHealth& now) {
  for (const auto& counter : now.dropped()) {
    const bool of_clouds = now.service() == kMapper && IsOfClouds(counter.name());
    const bool of_poses = IsOfPoses(now.service(), counter.name());
    if ((!of_clouds && !of_poses) || !HasGrown(counter, before.dropped())) continue;
    if (of_poses) unusable_pose_at_ = Steady::now();
    // Without poses there is no place for clouds, so that these only follow from those.
    if (of_clouds && IsRecent(unusable_pose_at_)) continue;
    trouble_ = of_clouds ? CloudsNotMappedText(counter.count(), counter.last())
                         : UnusablePoseText(now.service(), counter);
    trouble_at_ = Steady::now();
  }
  for (const auto& counter : now.rejected()) {
    if (counter.name().starts_with(dds::Health::kDatagrams)) continue;  // of strangers
    if (!HasGrown(counter, before.rejected())) continue;
    trouble_ = RefusalText(now.service(), counter);
    trouble_at_ = Steady::now();
  }
}

bool Observer::IsRecent(const std::optional<Steady::time_point>& at) const {
  return at && Steady::now() - *at < kTroubleShown;
}

/// Whether there is no pose since nobody publishes any, at least by the name and type that are expected.
bool Observer::LacksOdometry() const {
  return trajectory_.empty() && Steady::now() - begun_ > kPatienceWithOdometry &&
         bus_.Writers<topics::Odometry>() == 0;
}

bool Observer::LacksClock() const {
  return !scenario_.network().wall_clock() && bus_.Now() == Time{} &&
         Steady::now() - begun_ > kPatienceWithClock;
}

void Observer::JudgeWhetherFinished() {
  if (!done_ || finished_) return;
  const bool all_heard = simulation_ || !scenario_.world().has_file();
  const bool in_step = all_heard && !map_.missing() && map_stamp_ >= *done_;
  finished_ = in_step || Steady::now() - done_wall_ > kLongestWaitForMap;
}

void Observer::BeginTruth() {
  if (truth_.begun() || !simulation_ || !map_.has_map() || !scenario_.world().has_file()) return;
  const auto T_WB_true = dds::FromIdl(simulation_->map_from_body_true());
  if (!T_WB_true) return bus_.health().Reject<topics::SimulationStatus>(T_WB_true.error());
  truth_.Begin(scenario_, T_WB_true->translation(), map_.grid().voxel_size());
}

double Observer::TimeNow() const {
  return trajectory_.empty() ? 0.0 : Seconds(trajectory_.back().stamp - trajectory_.front().stamp);
}

double Observer::VoxelVolume() const {
  return map_.has_map() ? std::pow(map_.grid().voxel_size(), 3) : 0.0;
}

std::optional<unsigned> Observer::FrontiersLeft() const {
  if (!heard_explorer_) return {};
  const bool has_looked = done_ || exploration_.plans() > 0 || exploration_.frontiers_left() > 0;
  return has_looked ? std::optional(exploration_.frontiers_left()) : std::nullopt;
}

void Observer::Sample() {
  if (trajectory_.empty() || done_) return;
  ProgressSample now;
  now.time = TimeNow();
  now.distance = distance_;
  now.frontiers = FrontiersLeft();
  for (const auto& timing : exploration_.timings()) {
    if (timing.name() == kPlanStage && timing.count() > 0) now.planning_ms = timing.p50_ms();
  }
  tally_.Sample(now, VoxelVolume());
  MeasureFloor();
}

/// For a robot of one's own; in a simulator the place was checked before the start.
void Observer::MeasureFloor() {
  if (!floating_.empty() || simulation_ || !map_.has_map()) return;
  floating_ = FloatingText(RobotFrom(scenario_), map_.grid(), trajectory_.back().T.translation());
}

std::optional<std::string> Observer::failure() const {
  if (jumps_in_a_row_ < kJumpsOfTwo) return std::nullopt;
  return "time jumps back and forth: another run is in this domain; give one of them another --domain";
}

std::vector<std::string> Observer::warnings() const {
  std::vector<std::string> warnings;
  if (LacksClock()) {
    warnings.emplace_back(
        "no clock is heard: is the simulator running? On a robot set network.wall_clock: true");
  }
  if (LacksOdometry()) warnings.push_back(NoOdometryText(scenario_));
  if (!floating_.empty()) warnings.push_back(floating_);
  if (surface_ && surface_->full())
    warnings.emplace_back("the surface takes surface.most_memory_mb: nothing new is added to it");
  for (const auto& [process, health] : health_) {
    for (const auto& counter : health.rejected()) {
      if (!counter.name().starts_with(dds::Health::kDatagrams))
        warnings.push_back(RefusalText(health.service(), counter));
    }
    for (const auto& counter : health.dropped()) {
      if (counter.name() == dds::Health::kFiles) {
        warnings.push_back(health.service() + ": " + counter.last() + "; the run continues");
      } else if (IsOfPoses(health.service(), counter.name()) && counter.count() >= kManyPoses) {
        warnings.push_back(UnusablePoseText(health.service(), counter));
      }
    }
  }
  if (tally_.full()) {
    warnings.push_back(
        "the map has more voxels than are counted: explored volume and coverage over time stop at " +
        std::to_string(tally_.known()));
  }
  return warnings;
}

bool Observer::map_was_resumed() const {
  return std::ranges::any_of(health_, [](const auto& process) {
    const auto& timings = process.second.timings();
    return process.second.service() == kMapper && std::ranges::any_of(timings, [](const auto& timing) {
             return timing.name() == mapper::MapperService::kResumeTiming;
           });
  });
}

LiveState Observer::Live() {
  LiveState live;
  live.time = done_ ? done_time_ : TimeNow();
  live.distance = distance_;
  live.explored = static_cast<double>(tally_.known()) * VoxelVolume();
  if (const simulator::TrueMap* truth = truth_.Poll(); truth && truth->observable_count() > 0) {
    for (; judged_ < tally_.order().size(); ++judged_) {
      observable_ += truth_.Observable(tally_.order()[judged_]) ? 1 : 0;
    }
    live.coverage = static_cast<double>(observable_) / static_cast<double>(truth->observable_count());
  }
  if (simulation_) {
    live.rate = simulation_->time_scale();
    live.collisions = collisions_before_ + simulation_->true_collisions();
  }
  if (LacksOdometry()) live.trouble = NoOdometryText(scenario_);
  if (IsRecent(trouble_at_)) live.trouble = trouble_;
  if (LacksClock()) live.unheard.emplace_back(topics::Clock::kName);
  if (trajectory_.empty()) live.unheard.emplace_back("pose");
  if (!map_.has_map()) live.unheard.emplace_back("map");
  if (!heard_explorer_) live.unheard.emplace_back(kExplorer);
  if (!heard_controller_) live.unheard.emplace_back(kController);
  if (heard_explorer_) {
    live.frontiers = FrontiersLeft();
    if (!done_) live.silence = std::chrono::duration<double>(Steady::now() - *heard_explorer_).count();
    const bool exploring = !done_ && exploration_.state() != thalweg_msgs::msg::EXPLORATION_PAUSED &&
                           !exploration_.homeward() && !IsSilent(live);
    if (const auto left = RemainingTime(tally_.samples()); exploring && left) {
      live.left = *left / (live.rate > 0.0 ? live.rate : 1.0);
    }
    if (!done_ && stopped_since_ && Steady::now() - *stopped_since_ > kStopToTell) live.stop = stop_;
    live.activity = done_ ? "done: " + exploration_.stop_reason() : exploration_.activity();
  }
  return live;
}

RunRecord Observer::Record(const std::string& stop_reason) {
  RunRecord record;
  record.title = scenario_.title();
  record.scenario = name_;
  record.strategy = exploration_.strategy();
  record.stop_reason = done_ ? exploration_.stop_reason() : stop_reason;
  if (done_) {
    record.stop_details = exploration_.stop_details();
    record.outcome = explorer::FromIdl(exploration_.outcome());
    record.succeeded =
        exploration_.outcome() == thalweg_msgs::msg::OUTCOME_COMPLETE || exploration_.home_within_budget();
  }
  record.distance = distance_;
  record.duration = done_ ? done_time_ : TimeNow();
  record.wall = std::chrono::duration<double>((done_ ? done_wall_ : Steady::now()) - begun_).count();
  record.trajectory = trajectory_;
  record.plans = plans_before_ + exploration_.plans();
  record.replans = replans_before_ + exploration_.replans();
  record.planning = StagesOf(exploration_.timings());
  record.frontiers_left = exploration_.frontiers_left();
  for (const auto& entry : exploration_.set_aside()) {
    record.set_aside.push_back({explorer::AsideText(explorer::FromIdl(entry.reason()), entry.doubtful()),
                                entry.clusters(), entry.voxels()});
  }
  if (map_.has_map()) {
    map_.grid().ForEachKnown([&](const VoxelIndex&, float log_odds) {
      const bool free = OccupancyGrid::StateOf(log_odds) == VoxelState::kFree;
      (free ? record.free_volume : record.occupied_volume) += VoxelVolume();
    });
  }
  if (simulation_) {
    record.true_collisions = collisions_before_ + simulation_->true_collisions();
    record.least_clearance = simulation_->least_clearance_m();
  }
  record.progress = tally_.samples();
  if (const simulator::TrueMap* truth = truth_.Wait(); truth && map_.has_map()) {
    const simulator::TrueMap::Agreement agreement = truth->Compare(map_.grid());
    record.agreement = agreement.share();
    record.coverage = agreement.coverage();
    record.progress = tally_.SamplesWith([this](const VoxelIndex& i) { return truth_.Observable(i); },
                                         truth->observable_count());
  }
  AddMessages(record);
  if (surface_) {
    RunRecord::Surface& surface = record.surface.emplace();
    surface.seen = surface_->area_m2();
    surface.inspected = surface_->inspected_m2();
    surface.observable = truth_.ObservableSurface();
  }
  for (const MessageCount& entry : record.dropped) {
    if (!IsOfClouds(entry.name)) continue;
    if (entry.service == kMapper) {
      record.clouds_not_mapped += entry.count;
      record.clouds_not_mapped_why = entry.last;
    } else if (record.surface && entry.service == kSurface) {
      record.surface->clouds_not_fused += entry.count;
      record.surface->clouds_not_fused_why = entry.last;
    }
  }
  AddServices(record);
  record.decisions.assign(decisions_.decisions().begin(), decisions_.decisions().end());
  record.decisions_forgotten = decisions_.forgotten();
  record.frontiers = frontiers_;
  record.robot = RobotFrom(scenario_);
  record.camera = DepthSensorFrom(scenario_).camera;
  record.warnings = warnings();
  return record;
}

void Observer::AddMessages(RunRecord& record) const {
  for (const auto& [process, health] : health_) {
    AddCounts(health.service(), health.rejected(), record.rejected);
    AddCounts(health.service(), health.dropped(), record.dropped);
    if (health.service() == kMapper && !health.timings().empty()) {
      record.integration = StagesOf(health.timings());
    }
  }
}

void Observer::AddServices(RunRecord& record) const {
  std::map<std::string, ServiceRecord> services;
  std::map<std::string, Time> heard;
  for (const auto& [process, health] : health_) {
    ServiceRecord& service = services[health.service()];
    service.name = health.service();
    ++service.processes;
    service.rejected += SumOf(health.rejected());
    service.dropped += SumOf(health.dropped());
    const auto stamp = dds::FromIdl(health.header().stamp());
    const Time at = stamp ? *stamp : Time{};
    if (service.processes > 1 && at < heard[health.service()]) continue;
    heard[health.service()] = at;
    service.host = health.host();
    service.uptime = health.uptime_s();
    service.timings = StagesOf(health.timings());
  }
  for (auto& [name, service] : services) record.services.push_back(std::move(service));
}

}  // namespace thalweg::cli
