#include "services/explorer/core/path/steered_path.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <queue>
#include <unordered_map>

#include "common/base/check.h"
#include "common/geometry/attitude.h"
#include "services/explorer/core/path/path_search.h"

namespace thalweg::explorer {
namespace {

constexpr double kCurveSpare = 1.1;  // Radius of the tightest arcs driven, relative to what the robot can.
constexpr double kWider = 3.0;       // Radius of the wide arcs, relative to the tightest.
constexpr double kPiece = 1.5;       // [voxel] Length of a piece: more than the diagonal, to leave a voxel.
constexpr int kSamples = 3;          // Points of a piece at which the body is checked.
constexpr double kCorner = 0.1;      // [rad] Between the poses of an arc.
constexpr double kBack = 2.0;        // Cost of driving back, relative to forward.
constexpr double kChange = 0.3;      // [m] Cost of changing between forward and back.
constexpr double kSteer = 0.02;      // [m] Cost of another curve, so that paths do not weave.
constexpr double kLeave = 4.0;       // Cost of driving where it is not clear, added to that of the way.
// The rest of the way counts so much more than the way so far. Where the robot has to turn about first, every
// detour up to that length would be searched otherwise.
constexpr double kGreed = 1.7;
constexpr int kHeadings = 64;  // A full turn has so many.
constexpr std::size_t kMostStates = 400'000;
constexpr std::uint32_t kNoParent = ~std::uint32_t{0};

struct PlanarPose {
  double x = 0.0;    // [m]
  double y = 0.0;    // [m]
  double yaw = 0.0;  // [rad] Not wrapped.
};

/// @param along  [m] Negative: back.
PlanarPose Driven(const PlanarPose& from, double curvature, double along) {
  const double yaw = from.yaw + curvature * along;
  if (curvature == 0.0) return {from.x + along * std::cos(yaw), from.y + along * std::sin(yaw), yaw};
  return {from.x + (std::sin(yaw) - std::sin(from.yaw)) / curvature,
          from.y - (std::cos(yaw) - std::cos(from.yaw)) / curvature, yaw};
}

struct Piece {
  double curvature = 0.0;  // [1/m] Positive: to the left of where it faces.
  bool back = false;
  bool operator==(const Piece&) const = default;
};

/// How a robot may leave the place where it stands.
struct Leaving {
  double reach = 0.0;    // [m] As far as this.
  bool touches = false;  // Touching unknown space, and what it touches already.
  double margin = 1.0;   // Share of its margin that it keeps, if it touches nothing.
};
// It may stand between the points that were checked, or where it came with less than its margin.
constexpr double kLessMargins[] = {0.8, 0.4, 0.0};

class SteeringSearch {
 public:
  SteeringSearch(const PlanningMap& map, const RigidTransform& T_WB, const SteeringGoal& goal,
                 const SteeringModel& model)
      : map_(map),
        start_W_(T_WB.translation()),
        goal_(goal),
        model_(model),
        z_(*map.plane()),
        length_(kPiece * map.voxel_size()),
        turning_radius_(kCurveSpare * model.min_turning_radius) {
    for (const bool back : {false, true}) {
      for (const double share : {0.0, 1.0, -1.0, 1.0 / kWider, -1.0 / kWider})
        pieces_.push_back({share / turning_radius_, back});
    }
    to_goal_.Flood(map, {{map.IndexOf({goal.p_W.x(), goal.p_W.y(), z_}), 0}});
    start_ = {start_W_.x(), start_W_.y(), YawOf(T_WB.linear())};
  }

  bool StandsClear() const { return IsClear(start_W_); }
  /// Whether a robot that turns anywhere could come to the goal, as far as the map says.
  bool MayBeReached() const { return to_goal_.Reached(map_.IndexOf(start_W_)); }
  /// [m] How far from the start the last run came.
  double farthest() const { return farthest_; }

  std::optional<std::vector<RigidTransform>> Run(const Leaving& leaving) {
    leaving_ = leaving;
    farthest_ = 0.0;
    states_.clear();
    found_.clear();
    open_ = {};
    Enter({.pose = start_});
    while (!open_.empty() && states_.size() < kMostStates) {
      const auto [estimate, index] = open_.top();
      open_.pop();
      if (states_[index].closed) continue;
      states_[index].closed = true;
      if (IsThere(states_[index].pose)) return PathTo(index);
      for (const Piece& piece : pieces_) Extend(index, piece);
    }
    return std::nullopt;
  }

 private:
  struct State {
    PlanarPose pose;
    double cost = 0.0;  // [m]
    std::uint32_t parent = kNoParent;
    Piece piece = {};     // That led here,
    double length = 0.0;  // [m] as far as this.
    bool closed = false;
  };

  Eigen::Vector3d At(const PlanarPose& pose) const { return {pose.x, pose.y, z_}; }

  std::uint64_t KeyOf(const State& state) const {
    const VoxelIndex i = map_.IndexOf(At(state.pose));
    const double turns = state.pose.yaw / (2.0 * std::numbers::pi);
    const auto heading =
        static_cast<std::uint64_t>(std::lround((turns - std::floor(turns)) * kHeadings)) % kHeadings;
    const auto bits = [](int coordinate) {
      return static_cast<std::uint64_t>(static_cast<std::uint32_t>(coordinate) & 0xFFFFFFU);
    };
    return ((bits(i.x) << 24U | bits(i.y)) * kHeadings + heading) * 2 + (state.piece.back ? 1 : 0);
  }

  double TurnLeft(const PlanarPose& pose) const {
    return goal_.yaw ? std::max(0.0, std::abs(WrappedAngle(*goal_.yaw - pose.yaw)) - goal_.angle) : 0.0;
  }

  bool IsThere(const PlanarPose& pose) const {
    return std::hypot(pose.x - goal_.p_W.x(), pose.y - goal_.p_W.y()) <= goal_.distance &&
           TurnLeft(pose) == 0.0;
  }

  double Left(const PlanarPose& pose) const {
    const double straight = std::hypot(pose.x - goal_.p_W.x(), pose.y - goal_.p_W.y());
    const VoxelIndex i = map_.IndexOf(At(pose));
    const double length = to_goal_.Reached(i) ? std::max(straight, to_goal_.Length(i)) : straight;
    return std::max(std::max(0.0, length - goal_.distance), turning_radius_ * TurnLeft(pose));
  }

  /// Whether every point of the voxel that a body is in, and of those around, is clear.
  bool IsWellClear(const VoxelIndex& i) const {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (!map_.Traversable({i.x + dx, i.y + dy, i.z})) return false;
      }
    }
    return true;
  }

  bool IsClear(const Eigen::Vector3d& p_W) const {
    const VoxelIndex i = map_.IndexOf(p_W);
    if (IsWellClear(i)) return true;
    const double clearance = map_.options().clearance;
    return map_.Traversable(i) &&
           map_.ClearanceAt(p_W, PlanningMap::Obstacles::kOccupiedAndUnknown, clearance) >= clearance;
  }

  bool MayLeave(const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W) const {
    if ((to_W - start_W_).norm() > leaving_.reach) return false;
    if (leaving_.touches) return MovesFreely(from_W, to_W);
    return map_.SegmentClear(
        from_W, to_W, PlanningMap::Obstacles::kOccupiedAndUnknown,
        model_.body_radius + leaving_.margin * (map_.options().clearance - model_.body_radius));
  }

  bool MayCome(const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W) const {
    return goal_.was_there && (to_W.head<2>() - goal_.p_W.head<2>()).norm() <= model_.exemption &&
           MovesFreely(from_W, to_W);
  }

  /// Through what is free, touching nothing occupied that the body does not touch already.
  bool MovesFreely(const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W) const {
    return map_.State(map_.IndexOf(to_W)) == VoxelState::kFree &&
           map_.ClearToLeave(from_W, to_W, PlanningMap::Obstacles::kOccupied, model_.body_radius);
  }

  /// Drives a piece, or as much of it as leads to the goal.
  void Extend(std::uint32_t index, const Piece& piece) {
    const State from = states_[index];
    State state{.pose = from.pose, .parent = index, .piece = piece};
    double added = 0.0;  // [m] To the cost of the way.
    Eigen::Vector3d before_W = At(from.pose);
    for (int n = 1; n <= kSamples; ++n) {
      state.length = length_ * n / kSamples;
      state.pose = Driven(from.pose, piece.curvature, piece.back ? -state.length : state.length);
      const Eigen::Vector3d p_W = At(state.pose);
      if (!IsClear(p_W)) {
        if (!MayCome(before_W, p_W) && !MayLeave(before_W, p_W)) return;
        added += kLeave * length_ / kSamples;
      }
      if (IsThere(state.pose)) break;
      before_W = p_W;
    }
    state.cost = from.cost + state.length * (piece.back ? kBack : 1.0) + added;
    if (from.parent != kNoParent && from.piece.back != piece.back) state.cost += kChange;
    if (from.parent != kNoParent && from.piece.curvature != piece.curvature) state.cost += kSteer;
    // It may be in the same voxel as the state before.
    if (IsThere(state.pose)) return Open(state);
    const auto known = found_.find(KeyOf(state));
    if (known == found_.end() || states_[known->second].cost > state.cost) Enter(state);
  }

  /// Notes the best way to a state so far.
  void Enter(const State& state) {
    const auto index = static_cast<std::uint32_t>(states_.size());
    std::uint32_t& best = found_.try_emplace(KeyOf(state), index).first->second;
    if (best != index) states_[best].closed = true;
    best = index;
    Open(state);
  }

  void Open(const State& state) {
    const auto index = static_cast<std::uint32_t>(states_.size());
    states_.push_back(state);
    farthest_ = std::max(farthest_, std::hypot(state.pose.x - start_.x, state.pose.y - start_.y));
    open_.emplace(state.cost + kGreed * Left(state.pose), index);
  }

  std::vector<RigidTransform> PathTo(std::uint32_t index) const {
    std::vector<std::uint32_t> chain;
    for (; states_[index].parent != kNoParent; index = states_[index].parent) chain.push_back(index);
    std::vector<RigidTransform> T_WBs = {Posed(start_)};
    std::optional<Piece> before;
    for (auto at = chain.rbegin(); at != chain.rend(); ++at) {
      const State& state = states_[*at];
      const PlanarPose& from = states_[state.parent].pose;
      const double turn = std::abs(state.piece.curvature) * state.length;
      const int samples = std::max(1, static_cast<int>(std::ceil(turn / kCorner)));
      // What goes straight on needs no pose in between.
      if (state.piece.curvature == 0.0 && before == state.piece) T_WBs.pop_back();
      for (int n = 1; n <= samples; ++n) {
        const double along = state.length * n / samples;
        T_WBs.push_back(Posed(Driven(from, state.piece.curvature, state.piece.back ? -along : along)));
      }
      before = state.piece;
    }
    return T_WBs;
  }

  RigidTransform Posed(const PlanarPose& pose) const {
    return MakeTransform(RotationFromYawPitch(pose.yaw, 0.0), At(pose));
  }

  using Estimate = std::pair<double, std::uint32_t>;  // [m] The whole path, by way of a state.

  const PlanningMap& map_;
  Eigen::Vector3d start_W_;
  const SteeringGoal& goal_;
  const SteeringModel& model_;
  double z_;               // [m]
  double length_;          // [m] The longest piece.
  double turning_radius_;  // [m] The tightest arc's.
  std::vector<Piece> pieces_;
  Leaving leaving_ = {};
  double farthest_ = 0.0;  // [m]
  PathSearch to_goal_;
  PlanarPose start_;
  std::vector<State> states_;
  std::unordered_map<std::uint64_t, std::uint32_t> found_;
  std::priority_queue<Estimate, std::vector<Estimate>, std::greater<>> open_;
};

}  // namespace

std::optional<std::vector<RigidTransform>> SteerTo(const PlanningMap& map, const RigidTransform& T_WB,
                                                   const SteeringGoal& goal, const SteeringModel& model) {
  THALWEG_CHECK(map.plane() && model.min_turning_radius > 0.0);
  SteeringSearch search(map, T_WB, goal, model);
  std::optional<std::vector<RigidTransform>> path;
  if (search.StandsClear()) {
    if (search.MayBeReached() || goal.was_there) path = search.Run({});
    // A robot that comes farther lacks nothing where it stands.
    for (const double margin : kLessMargins) {
      if (!path && search.farthest() < model.wide_exemption)
        path = search.Run({.reach = model.wide_exemption, .margin = margin});
    }
    if (path || search.farthest() >= model.wide_exemption) return path;
  }
  for (const double reach : {model.exemption, model.wide_exemption}) {
    if (!path) path = search.Run({.reach = reach, .touches = true});
  }
  return path;
}

}  // namespace thalweg::explorer
