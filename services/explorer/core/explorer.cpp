#include "services/explorer/core/explorer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "common/base/stopwatch.h"

namespace thalweg::explorer {
namespace {

/// Scans from nearly the same pose tell nothing new.
constexpr double kSamePosition = 0.05;                         // [m]
constexpr double kSameAngle = 5.0 * std::numbers::pi / 180.0;  // [rad]
constexpr double kPathSampling = 0.2;                          // [m]
constexpr std::string_view kTooSmall = "too small";
constexpr const char* kDoubtful = "doubtful";

std::string DoubtfulAnd(std::string_view reason) {
  return std::string(kDoubtful) + ": " + std::string(reason);
}

std::string TextOf(AsideReason reason, bool doubtful) {
  if (!doubtful) return std::string(ToText(reason));
  return DoubtfulAnd(reason == AsideReason::kLookedAt ? "looked at and stayed so" : ToText(reason));
}

PlanningMap::Options MapOptions(const Explorer::Options& options) {
  // The floor under a robot that drives may be as near as it is: no margin there.
  const double above = options.robot.drives || options.robot.height == 0.0 ? 0.0 : options.safety_margin;
  return {.voxel_size = options.voxel_size,
          .clearance = options.robot.radius + options.safety_margin,
          .half_height = 0.5 * options.robot.height + above,
          .bounds = options.bounds,
          .max_voxels = options.max_voxels,
          .no_go = options.no_go,
          .camera_height = options.robot.T_BC.translation().z(),
          .doubt = options.doubt};
}

/// What lies about the feet of a robot that drives, where it wakes up, it cannot see: it must cross that to
/// get to what it can.
Explorer::Options ReachingBeyondItsFeet(Explorer::Options options) {
  if (!options.robot.drives) return options;
  const ViewPlanner views(options.camera, options.robot.T_BC.linear(), /*level=*/true);
  const double highest = 0.5 * options.robot.height - options.robot.T_BC.translation().z();
  const double lowest = highest - options.robot.height;
  double blind = 0.0;
  for (double distance = 0.0; distance < options.look_range; distance += 0.5 * options.voxel_size) {
    const bool shown = views.CanShow({distance, 0.0, highest}) && views.CanShow({distance, 0.0, lowest});
    if (!shown) blind = distance;
  }
  const double beyond = blind + options.robot.radius + options.safety_margin + 3.0 * options.voxel_size;
  options.wide_exemption = std::max(options.wide_exemption, beyond);
  return options;
}

Journey::Options JourneyOptions(const Explorer::Options& options) {
  return {.time_budget = options.time_budget,
          .distance_budget = options.distance_budget,
          .return_home = options.return_home,
          .way_home = {.margin = options.home_margin,
                       .robot_radius = options.robot.radius,
                       .exemption = options.exemption,
                       .wide_exemption = options.wide_exemption,
                       .max_speed = options.robot.max_speed,
                       .max_turn_rate = options.robot.max_turn_rate}};
}

}  // namespace

Explorer::Explorer(const Options& options)
    : options_(ReachingBeyondItsFeet(options)),
      map_(MapOptions(options)),
      memory_(options.memory),
      views_(options.camera, options.robot.T_BC.linear(), options.robot.drives),
      strategy_(MakeStrategy(options.strategy)),
      goal_finder_(options.look_range, options.voxel_size),
      journey_(JourneyOptions(options_)) {
  if (!(options.comfort.distance >= 0.0)) throw std::invalid_argument("comfort must be >= 0");
  if (!(options.look_range > 0.0)) throw std::invalid_argument("look_range must be > 0");
  if (!(options.min_measured_share >= 0.0 && options.min_measured_share <= 1.0))
    throw std::invalid_argument("min_measured_share must be 0 to 1");
  if (!(options.max_missed_share >= 0.0 && options.max_missed_share <= 1.0))
    throw std::invalid_argument("max_missed_share must be 0 to 1");
  if (!(options.frontier.min_area >= 0.0)) throw std::invalid_argument("min_cluster_area must be >= 0");
  if (!(options.frontier.extent > 0.0)) throw std::invalid_argument("cluster_extent must be > 0");
  if (options.memory.looks < 1) throw std::invalid_argument("looks_before_set_aside must be >= 1");
  if (options.robot.drives && !(options.robot.height > 0.0))
    throw std::invalid_argument("a robot that drives needs a height");
  memory_.Cover(map_.box());
}

void Explorer::Reset() {
  map_.Reset();
  memory_.Cover(map_.box());
  memory_.Clear();
  counted_T_WC_.reset();
  last_scan_.reset();
  has_left_start_ = false;
  blind_looks_ = 0;
  task_ = {};
  after_turn_.reset();
}

void Explorer::Update(std::span<const VoxelChange> changes, std::span<const ScanView> scans, Time now) {
  updated_ = now;
  TakeIn(map_.Apply(changes));
  for (const ScanView& scan : scans) {
    const RigidTransform& T_WC = scan.T_WC;
    if (counted_T_WC_ && (counted_T_WC_->translation() - T_WC.translation()).norm() < kSamePosition &&
        AngleBetween(*counted_T_WC_, T_WC) < kSameAngle) {
      continue;
    }
    counted_T_WC_ = T_WC;
    const Eigen::Matrix3d R_WB = T_WC.linear() * options_.robot.T_BC.linear().transpose();
    for (const Sighting& sighting : SightingsFrom(map_, T_WC.translation(), options_.look_range)) {
      if (!views_.Shows(R_WB, sighting)) continue;
      const Sensed sensed = SensedBy(scan, sighting.voxel).value_or(Sensed::kDepth);
      memory_.Look(sighting.voxel, T_WC.translation(), sensed, now);
    }
  }
  if (!scans.empty()) last_scan_ = scans.back();
}

void Explorer::TakeIn(std::span<const PlanningMap::StateChange> changes) {
  memory_.Cover(map_.box());
  memory_.Follow(changes);
}

std::optional<Sensed> Explorer::SensedBy(const ScanView& scan, const VoxelIndex& i) const {
  if (!scan.measured) return std::nullopt;
  const Eigen::Vector3d p_C = scan.T_WC.inverse() * map_.CenterOf(i);
  const std::optional<double> share = scan.measured->At(options_.camera, p_C);
  if (!share) return std::nullopt;
  return *share < options_.min_measured_share ? Sensed::kNothing : Sensed::kDepth;
}

bool Explorer::KnowsPlace(const RigidTransform& T_WB) const {
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(options_.exemption);
  const Eigen::Vector3d eye_W = map_.EyeAt(T_WB.translation());
  const VoxelIndex low = map_.IndexOf(eye_W - reach);
  const VoxelIndex high = map_.IndexOf(eye_W + reach);
  for (VoxelIndex i = low; i.z <= high.z; ++i.z) {
    for (i.y = low.y; i.y <= high.y; ++i.y) {
      for (i.x = low.x; i.x <= high.x; ++i.x) {
        if (map_.State(i) == VoxelState::kFree) return true;
      }
    }
  }
  return false;
}

void Explorer::Arrived(Time now) {
  std::vector<VoxelIndex> left;
  std::vector<std::optional<Sensed>> sensed;  // from where it arrived, of each of these
  for (const VoxelIndex& i : task_.target) {
    if (!IsTarget(map_, i)) continue;
    left.push_back(i);
    sensed.push_back(last_scan_ ? SensedBy(*last_scan_, i) : std::nullopt);
  }
  // A look around counts for what it was to show; a journey from which nothing came decides for its cluster:
  // going there a second time later costs more than it ever brought. Of several clusters it decides for what
  // the last scan could show, each voxel by itself.
  const bool fruitless = task_.plan.kind == Plan::Kind::kGo && task_.KnownOfTarget(map_) == 0;
  const bool several = !task_.choice.target.empty() &&
                       std::any_of(sensed.begin(), sensed.end(), [](const auto& s) { return s.has_value(); });
  const bool nothing_sensed = std::count(sensed.begin(), sensed.end(), Sensed::kNothing) >
                              std::count(sensed.begin(), sensed.end(), Sensed::kDepth);
  for (std::size_t n = 0; n < left.size(); ++n) {
    if (task_.plan.kind == Plan::Kind::kLook)
      memory_.CountLook(left[n], AsideReason::kLookedAt, sensed[n].value_or(Sensed::kDepth), now);
    if (!fruitless || (several && !sensed[n])) continue;
    const bool no_depth = several ? sensed[n] == Sensed::kNothing : nothing_sensed;
    memory_.SetAside(left[n], no_depth ? AsideReason::kNoDepth : AsideReason::kVisited, now);
  }
  task_.DropTarget();
}

void Explorer::GotLost(Time now) {
  for (const VoxelIndex& i : task_.target) {
    if (IsTarget(map_, i)) memory_.CountLook(i, AsideReason::kLostThere, Sensed::kDepth, now);
  }
  task_.DropTarget();
}

std::optional<Explorer::Interruption> Explorer::CheckPlan(const RigidTransform& T_WB) const {
  if (task_.plan.kind != Plan::Kind::kGo) return std::nullopt;
  const Eigen::Vector3d p_W = T_WB.translation();
  if (!task_.StillClear(map_, p_W, least_clearance()))
    return Interruption{"the path is no longer clear", true};
  if (!task_.FacesNarrowWay(T_WB)) return Interruption{"it does not face the narrow way that it goes", true};
  if (!homeward_.empty()) return std::nullopt;
  if (const std::optional<std::string> budget = journey_.HomeIsDue(map_, p_W, updated_)) {
    return Interruption{"home is due: " + *budget, false};
  }
  const auto known = static_cast<double>(task_.KnownOfTarget(map_));
  if (known >= options_.resolved_share * static_cast<double>(task_.target.size())) {
    return Interruption{"the target was seen on the way", false};
  }
  return std::nullopt;
}

Plan Explorer::Done(const std::string& reason) const {
  Plan plan;
  plan.stop_reason = reason;
  plan.activity = "done: " + reason;
  return plan;
}

Plan Explorer::NothingLeft() const {
  const OpenBorder border = FindOpenBorder(map_, memory_.set_aside());
  const bool complete = border.missed_share() <= options_.max_missed_share;
  Plan plan = Done(complete ? "complete" : kTooMuchUnknown);
  std::size_t doubtful = 0;
  for (std::size_t k = 0; k < map_.doubtful().size(); ++k) {
    if (map_.doubtful()[k] != 0 && IsTarget(map_, map_.states().IndexAt(k))) ++doubtful;
  }
  if (doubtful > 0) plan.activity += "; " + std::to_string(doubtful) + " known voxels stayed doubtful";
  if (border.open() == 0) return plan;
  const double face = map_.voxel_size() * map_.voxel_size();  // [m^2]
  const auto append = [&plan](const char* format, auto... values) {
    char text[200];
    std::snprintf(text, sizeof text, format, values...);
    plan.activity += text;
  };
  append("; %.2f m2 of frontier stayed unknown, %.1f %% of what free space ends at",
         static_cast<double>(border.open()) * face, 100.0 * border.share());
  const char* before = ": ";
  for (const auto& [reason, voxels] : border.unknown) {
    const std::string why(reason == AsideReason::kNone ? kTooSmall : ToText(reason));
    append("%s%.2f m2 %s", std::exchange(before, ", "), static_cast<double>(voxels) * face, why.c_str());
  }
  if (!complete)
    append("; does the sensor's range of %.1f m end before the surfaces do?", options_.sensor_range);
  return plan;
}

void Explorer::ShiftTimes(Duration back) {
  journey_.ShiftTimes(back);
  updated_ -= back;
  memory_.ShiftTimes(back);
}

void Explorer::StayInPlane(RigidTransform& T_WB) {
  if (!options_.robot.drives) return;
  if (!map_.plane()) {
    map_.SetPlane(T_WB.translation().z());
    memory_.Cover(map_.box());
  }
  T_WB.translation().z() = *map_.plane();
}

Plan Explorer::MakePlan(const RigidTransform& T_WB_told, Time now) {
  const Stopwatch whole;
  RigidTransform T_WB = T_WB_told;
  StayInPlane(T_WB);
  ++plans_;
  task_.choice = {};
  task_.turn_first = false;
  memory_.Expire(now);
  journey_.FindWaysHome(map_, T_WB.translation());
  if (const std::optional<std::string> spent = BudgetSpent(now)) {
    task_.plan = Done(*spent);
  } else if (!GoOnAfterTurn(T_WB)) {
    if (homeward_.empty()) homeward_ = journey_.HomeIsDue(map_, T_WB.translation(), now).value_or("");
    if (homeward_.empty()) {
      task_.plan = Explore(T_WB, now);
      if (options_.return_home && task_.plan.kind == Plan::Kind::kDone) homeward_ = task_.plan.stop_reason;
    }
    if (!homeward_.empty()) task_.plan = GoHome(T_WB);
    if (task_.turn_first) task_.plan = TurnFirst();
  }
  timings_["plan"].Add(whole.Milliseconds());
  return task_.plan;
}

Plan Explorer::TurnFirst() {
  Plan turn;
  turn.kind = Plan::Kind::kLook;
  turn.T_WBs = {task_.plan.T_WBs.front()};
  turn.activity = "turning to the narrow way ahead, then " + task_.plan.activity;
  turn.target_W = task_.plan.target_W;
  after_turn_ = task_;
  task_.DropTarget();
  return turn;
}

bool Explorer::GoOnAfterTurn(const RigidTransform& T_WB) {
  if (!after_turn_) return false;
  task_ = *std::exchange(after_turn_, std::nullopt);
  task_.turn_first = false;
  const double off = (T_WB.translation() - task_.plan.T_WBs.front().translation()).norm();
  if (off <= kSamePosition && !CheckPlan(T_WB)) return true;
  task_ = {};
  return false;
}

Plan Explorer::Explore(const RigidTransform& T_WB, Time now) {
  if (!KnowsPlace(T_WB)) return LookForSpace(T_WB);
  blind_looks_ = 0;
  if (std::optional<Plan> look = LookAround(T_WB)) return *look;
  TakeIn(map_.Vacate(T_WB.translation(), options_.robot.radius));
  FindCandidates(T_WB, {options_.exemption}, now);
  if (candidates_.empty() && ShutIn()) {
    memory_.Release(AsideReason::kOutOfSight);  // what the narrow search set aside
    FindCandidates(T_WB, {options_.wide_exemption, true}, now);
  }
  // What no place saw then may be in sight now: asked again before the end is called.
  if (candidates_.empty() && memory_.Release(AsideReason::kOutOfSight) > 0) {
    FindCandidates(T_WB, {options_.exemption}, now);
  }
  const std::optional<std::string> too_far = LeaveOutTooFar(now);
  if (candidates_.empty()) {
    if (too_far) return Done(*too_far);
    return ShutIn() ? Done("nothing reachable") : NothingLeft();
  }
  const Situation situation{map_,        search_, T_WB.translation(),    clearance(),
                            candidates_, views_,  options_.sensor_range, options_.look_range};
  const Stopwatch choosing;
  task_.choice = strategy_->Choose(situation);
  timings_["choice"].Add(choosing.Milliseconds());
  has_left_start_ = true;
  Plan plan = GoTo(task_.choice, T_WB);
  if (journey_.TooFar(map_, PathLength(plan), plan.T_WBs.back().translation(), now)) {
    task_.choice = StraightTo(situation, NearestCandidate(situation));  // strategies may make detours
    plan = GoTo(task_.choice, T_WB);
  }
  return plan;
}

std::optional<std::string> Explorer::LeaveOutTooFar(Time now) {
  std::optional<std::string> too_far;
  std::erase_if(candidates_, [&](const Candidate& candidate) {
    auto reason = journey_.TooFar(map_, candidate.length, map_.CenterOf(candidate.goals.front()), now);
    if (!reason) return false;
    too_far = std::move(reason);
    return true;
  });
  return too_far;
}

Plan Explorer::GoHome(const RigidTransform& T_WB) {
  constexpr double kAtHome = 0.15;  // [m]
  const Eigen::Vector3d p_W = T_WB.translation();
  const Eigen::Vector3d& home_W = *journey_.way_home().home_W();
  task_.DropTarget();
  if ((p_W - home_W).norm() <= kAtHome) {
    return Done(Journey::IsBudget(homeward_) ? "home within the " + homeward_ : homeward_);
  }
  std::vector<Eigen::Vector3d> path_W = journey_.way_home().PathFrom(map_, p_W);
  if (path_W.empty()) return Done("no way home");
  path_W = MakeComfortable(map_, PullStraight(map_, path_W, clearance()), options_.comfort);
  Plan plan = Follow(path_W, T_WB.linear(), T_WB);
  char text[80];
  std::snprintf(text, sizeof text, "going home, %.1f m: ", PathLength(path_W));
  plan.activity = text + homeward_;
  plan.target_W = home_W;
  return plan;
}

Plan Explorer::LookForSpace(const RigidTransform& T_WB) {
  // One step on from the present heading each time, and each round higher or lower than the one before.
  constexpr std::size_t kHeadings = 6;
  constexpr double kElevations[] = {0.0, 0.25 * std::numbers::pi, -0.25 * std::numbers::pi};
  const std::size_t round = blind_looks_ / kHeadings;
  if (round == (options_.robot.drives ? 1 : std::size(kElevations))) return Done("no free space in sight");
  ++blind_looks_;
  const double yaw = YawOf(T_WB.linear()) + 2.0 * std::numbers::pi / kHeadings;
  const Eigen::Matrix3d R_WB = RotationFromYawPitch(yaw, kElevations[round]);
  task_.DropTarget();
  Plan plan;
  plan.kind = Plan::Kind::kLook;
  plan.T_WBs = {MakeTransform(R_WB, T_WB.translation())};
  plan.activity = "turning: nothing free is known about the robot yet";
  return plan;
}

std::optional<Plan> Explorer::LookAround(const RigidTransform& T_WB) {
  const Eigen::Vector3d eye_W = map_.EyeAt(T_WB.translation());
  const std::vector<Sighting> sightings = SightingsFrom(map_, eye_W, options_.look_range);
  std::vector<bool> fresh(sightings.size());
  for (std::size_t n = 0; n < sightings.size(); ++n) {
    const VoxelIndex& i = sightings[n].voxel;
    fresh[n] = memory_.Looks(i) == 0 && memory_.set_aside()[i] == 0;
  }
  const View view = views_.Best(sightings, fresh, {}, T_WB.linear());
  const std::size_t enough =
      has_left_start_ ? VoxelsOfArea(options_.look_around_min_area, map_.voxel_size()) : 1;
  if (view.count < enough) return std::nullopt;
  std::vector<VoxelIndex> target;
  for (std::size_t n = 0; n < sightings.size(); ++n) {
    if (fresh[n] && views_.Shows(view.R_WB, sightings[n])) target.push_back(sightings[n].voxel);
  }
  task_.Aim(std::move(target), map_);
  Plan plan;
  plan.kind = Plan::Kind::kLook;
  plan.T_WBs = {MakeTransform(view.R_WB, T_WB.translation())};
  plan.activity = "looking around: " + task_.TargetText() + " in view";
  plan.target_W = T_WB.translation() + view.R_WB.col(0);
  return plan;
}

void Explorer::FindCandidates(const RigidTransform& T_WB, const PathSearch::Exemption& exemption, Time now) {
  const std::vector<PathSearch::Start> parts = PathSearch::Parts(
      map_, PathSearch::StartAt(map_, T_WB.translation(), options_.robot.radius, exemption));
  FindCandidatesFrom(parts.front(), exemption.from_pocket, now);
  for (std::size_t n = 1; n < parts.size() && candidates_.empty(); ++n) {
    memory_.Release(AsideReason::kOutOfSight);  // what the part before set aside
    FindCandidatesFrom(parts[n], true, now);
  }
  // What there is to say about the end is said of the largest part.
  if (parts.size() > 1 && candidates_.empty()) search_.Flood(map_, parts.front());
}

void Explorer::FindCandidatesFrom(const PathSearch::Start& start, bool may_not_return, Time now) {
  candidates_.clear();
  const Stopwatch flood;
  search_.Flood(map_, start);
  timings_["flood"].Add(flood.Milliseconds());
  const Stopwatch finding;
  frontiers_ = FindFrontiers(map_, memory_.set_aside(), options_.frontier);
  timings_["frontiers"].Add(finding.Milliseconds());
  const Stopwatch goals_watch;
  for (const Cluster& cluster : frontiers_.clusters) {
    std::vector<VoxelIndex> goals = goal_finder_.GoalsOf(cluster, map_, search_, views_);
    if (may_not_return && options_.return_home) {
      std::erase_if(goals, [&](const VoxelIndex& goal) {
        return !journey_.way_home().LengthFrom(map_, map_.CenterOf(goal));
      });
    }
    if (goals.empty()) {
      for (const VoxelIndex& i : cluster.unknowns) memory_.SetAside(i, AsideReason::kOutOfSight, now);
      continue;
    }
    const double length = search_.Length(goals.front());
    candidates_.push_back({cluster, std::move(goals), length});
  }
  timings_["goals"].Add(goals_watch.Milliseconds());
}

bool Explorer::Sees(const Eigen::Vector3d& p_W, const VoxelIndex& i) const {
  const Eigen::Vector3d eye_W = map_.EyeAt(p_W);
  const Eigen::Vector3d offset_W = map_.CenterOf(i) - eye_W;
  return offset_W.norm() <= options_.look_range && views_.CanShow(offset_W) &&
         map_.InSight(eye_W, map_.CenterOf(i));
}

void Explorer::StopWhereSeen(std::vector<Eigen::Vector3d>& path_W,
                             const std::vector<VoxelIndex>& target) const {
  const auto seen_from = [&](const Eigen::Vector3d& p_W) {
    std::vector<VoxelIndex> seen;
    for (const VoxelIndex& i : target) {
      if (Sees(p_W, i)) seen.push_back(i);
    }
    return seen;
  };
  const std::vector<VoxelIndex> at_goal = seen_from(path_W.back());
  if (at_goal.empty()) return;
  for (std::size_t n = 1; n < path_W.size(); ++n) {
    const Eigen::Vector3d a = path_W[n - 1];
    const Eigen::Vector3d b = path_W[n];
    const int pieces = std::max(1, static_cast<int>(std::ceil((b - a).norm() / kPathSampling)));
    for (int piece = n == 1 ? 0 : 1; piece <= pieces; ++piece) {
      const Eigen::Vector3d p_W = a + (b - a) * (static_cast<double>(piece) / pieces);
      const auto seen =
          std::count_if(at_goal.begin(), at_goal.end(), [&](const VoxelIndex& i) { return Sees(p_W, i); });
      if (2 * static_cast<std::size_t>(seen) < at_goal.size()) continue;
      path_W.resize(n);
      path_W.push_back(p_W);
      return;
    }
  }
}

View Explorer::ViewOf(const std::vector<VoxelIndex>& target, const Eigen::Vector3d& p_W,
                      const Eigen::Matrix3d& R_WB) const {
  const std::vector<Sighting> sightings = SightingsFrom(map_, map_.EyeAt(p_W), options_.look_range);
  std::vector<bool> counts(sightings.size());
  std::vector<bool> required(sightings.size());
  const DenseGrid<std::uint8_t>& set_aside = memory_.set_aside();
  for (std::size_t n = 0; n < sightings.size(); ++n) {
    counts[n] = set_aside[sightings[n].voxel] == 0;
    required[n] = std::find(target.begin(), target.end(), sightings[n].voxel) != target.end();
  }
  return views_.Best(sightings, counts, required, R_WB);
}

Plan Explorer::Follow(const std::vector<Eigen::Vector3d>& path_W, const Eigen::Matrix3d& R_WB,
                      const RigidTransform& T_WB) {
  std::vector<Eigen::Vector3d> level_W = path_W;
  if (map_.plane()) {
    for (Eigen::Vector3d& p_W : level_W) p_W.z() = *map_.plane();
  }
  task_.plan = {};
  task_.plan.kind = Plan::Kind::kGo;
  task_.Follow(FaceNarrowWays(map_, level_W, T_WB, R_WB, options_.robot), map_, least_clearance());
  return task_.plan;
}

Plan Explorer::GoTo(const Choice& choice, const RigidTransform& T_WB) {
  const Candidate& candidate = candidates_[choice.candidate];
  task_.Aim(choice.target.empty() ? candidate.cluster.unknowns : choice.target, map_);
  std::vector<Eigen::Vector3d> path_W = choice.path_W;
  StopWhereSeen(path_W, task_.target);
  const Stopwatch comfort;
  path_W = MakeComfortable(map_, path_W, options_.comfort);
  timings_["comfort"].Add(comfort.Milliseconds());
  const View view = ViewOf(task_.target, path_W.back(), T_WB.linear());
  Plan plan = Follow(path_W, view.R_WB, T_WB);
  plan.target_W = candidate.cluster.center_W;
  char text[40] = "turning";
  const double length = PathLength(path_W);
  if (length >= 0.05) std::snprintf(text, sizeof text, "going %.1f m", length);
  plan.activity = text + (" to see " + task_.TargetText() + ", ") +
                  (candidates_.size() == 1 ? std::string("the last frontier known")
                                           : "one of " + std::to_string(candidates_.size()) + " frontiers");
  return plan;
}

std::vector<std::pair<std::string, std::vector<VoxelIndex>>> Explorer::SetAsideByReason() const {
  std::vector<std::pair<std::string, std::vector<VoxelIndex>>> aside;
  for (auto& [reason, voxels] : memory_.SetAsideVoxels()) {
    std::vector<VoxelIndex> unknown;
    std::vector<VoxelIndex> doubtful;
    for (const VoxelIndex& i : voxels) (map_.Doubtful(i) ? doubtful : unknown).push_back(i);
    if (!unknown.empty()) aside.emplace_back(TextOf(reason, false), std::move(unknown));
    if (!doubtful.empty()) aside.emplace_back(TextOf(reason, true), std::move(doubtful));
  }
  return aside;
}

std::vector<Explorer::FrontierReport> Explorer::frontier_reports() const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<FrontierReport> reports;
  for (std::size_t n = 0; n < candidates_.size(); ++n) {
    const Candidate& candidate = candidates_[n];
    reports.push_back(
        {.center_W = candidate.cluster.center_W,
         .voxels = candidate.cluster.unknowns.size(),
         .length = candidate.length,
         .score = n < task_.choice.scores.size() ? task_.choice.scores[n] : kNone,
         .fate = !task_.choice.path_W.empty() && n == task_.choice.candidate ? Fate::kChosen : Fate::kLeft,
         .reason = candidate.cluster.doubtful ? kDoubtful : ""});
  }
  for (const auto& [reason, voxels] : SetAsideByReason()) {
    for (const std::vector<VoxelIndex>& component : ConnectedComponents(voxels)) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const VoxelIndex& i : component) sum += map_.CenterOf(i);
      reports.push_back({.center_W = sum / static_cast<double>(component.size()),
                         .voxels = component.size(),
                         .length = kNone,
                         .score = kNone,
                         .fate = Fate::kSetAside,
                         .reason = reason});
    }
  }
  return reports;
}

Explorer::Status Explorer::status() const {
  Status status;
  status.frontiers_left = candidates_.size();
  for (const Candidate& candidate : candidates_)
    status.frontier_voxels_left += candidate.cluster.unknowns.size();
  for (const auto& [reason, voxels] : SetAsideByReason()) {
    status.set_aside.push_back({reason, ConnectedComponents(voxels).size(), voxels.size()});
  }
  if (frontiers_.small_clusters > 0) {
    status.set_aside.push_back({std::string(kTooSmall), frontiers_.small_clusters, frontiers_.small_voxels});
  }
  if (frontiers_.small_doubtful_clusters > 0) {
    status.set_aside.push_back(
        {DoubtfulAnd(kTooSmall), frontiers_.small_doubtful_clusters, frontiers_.small_doubtful_voxels});
  }
  status.plans = plans_;
  status.distance = journey_.distance();
  for (const auto& [stage, timing] : timings_) status.timings[stage] = timing.Summarize();
  return status;
}

}  // namespace thalweg::explorer
