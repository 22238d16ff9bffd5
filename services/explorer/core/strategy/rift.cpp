#include "services/explorer/core/strategy/rift.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/base/check.h"
#include "common/base/require.h"
#include "common/geometry/polyline.h"

namespace thalweg::explorer {
namespace {

using Obstacles = PlanningMap::Obstacles;

/// Any serves: the graph has the points, and these do not depend on it.
constexpr double kNominalBaseline = 0.12;  // [m]

const Rift::Options& CheckedRift(const Rift::Options& options) {
  Require(options.views_per_move >= 1, "views_per_move", options.views_per_move, ">= 1");
  Require(options.most_views >= 1, "most_views", options.most_views, ">= 1");
  return options;
}

/// The disparities that a stereo camera would have measured.
surface::View ViewFrom(const CameraView& seen) {
  DepthImage depth{seen.cloud.width_px, seen.cloud.height_px, {}};
  depth.depths.reserve(seen.cloud.points_C.size());
  for (const Eigen::Vector3f& p_C : seen.cloud.points_C) {
    depth.depths.push_back(p_C.allFinite() ? p_C.z() : std::numeric_limits<float>::quiet_NaN());
  }
  const StereoGeometry rig{seen.camera, kNominalBaseline};
  return {.rig = rig,
          .disparities = surface::DisparitiesOf(depth, rig),
          .colors = {},
          .T_WC = seen.T_WB * seen.T_BC};
}

/// Whether the body can stand in what is known to be free.
bool IsFreeAt(const Surroundings& surroundings, const Eigen::Vector3d& p_W) {
  return surroundings.map.SegmentClear(p_W, p_W, Obstacles::kOccupiedAndUnknown, surroundings.clearance);
}

/// Whether it can move between two points. Half of the margin is enough, as it is for a path that is being
/// followed: where the robot begins, or has stopped, is never exact.
bool IsFreeBetween(const Surroundings& surroundings, const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W) {
  return surroundings.map.SegmentClear(a_W, b_W, Obstacles::kOccupiedAndUnknown,
                                       0.5 * (surroundings.radius + surroundings.clearance));
}

/// Why the body cannot stand there; nothing if it can.
std::optional<std::string> WhyNotThere(const Surroundings& surroundings, const Eigen::Vector3d& p_W) {
  const PlanningMap& map = surroundings.map;
  if (!map.InBounds(map.IndexOf(p_W))) return "it is outside of what is to be explored";
  if (IsFreeAt(surroundings, p_W)) return std::nullopt;
  return map.SegmentClear(p_W, p_W, Obstacles::kOccupied, surroundings.clearance)
             ? "the body would reach into what is not known"
             : "the body would touch something";
}

/// Where the robot can go from where it stands too near to an obstacle, or to what is unknown, nearest first;
/// where it stands, if it stands free.
std::vector<Eigen::Vector3d> PlacesToSetOutFrom(const Surroundings& surroundings) {
  const Eigen::Vector3d& robot_W = surroundings.robot_W;
  if (IsFreeBetween(surroundings, robot_W, robot_W)) return {robot_W};
  std::vector<Eigen::Vector3d> places_W;
  for (const PathSearch::Exemption& exemption : surroundings.exemptions) {
    for (const PathSearch::Entry& entry :
         PathSearch::StartAt(surroundings.map, robot_W, surroundings.radius, exemption)) {
      places_W.push_back(surroundings.map.CenterOf(entry.voxel));
    }
    if (!places_W.empty()) break;
  }
  std::ranges::stable_sort(places_W, {}, [&](const Eigen::Vector3d& p_W) { return (p_W - robot_W).norm(); });
  return places_W;
}

std::string PositionOf(std::size_t stop, std::size_t stops, std::size_t move) {
  return "view " + std::to_string(stop + 1) + " of " + std::to_string(stops) + " of move " +
         std::to_string(move);
}

}  // namespace

Rift::Rift(const Options& options) : options_(CheckedRift(options)), surface_(options.surface) {}

void Rift::See(const CameraView& seen) {
  surface::View view = ViewFrom(seen);
  THALWEG_CHECK(!surface::MistakeIn(view));
  saw_nothing_ = std::ranges::none_of(view.disparities, [](float d) { return d > 0.0F; });
  if (!saw_nothing_) surface_.Add(std::move(view));
  T_BC_ = seen.T_BC;
  if (!std::exchange(underway_, false)) return;
  if (saw_nothing_) notes_.push_back(PositionOf(next_, stops_.size(), move_) + " shows nothing");
  passed_ = stops_[next_] + 1;
  ++next_;
  if (!saw_nothing_) ++seen_on_move_;
  tries_ = 0;
}

std::optional<std::vector<Candidate>> Rift::FindCandidates(const Surroundings& surroundings) {
  end_.reset();
  underway_ = false;
  const auto most = static_cast<std::size_t>(options_.most_views);
  if (surface_.views().empty()) {
    end_ = {.why = "the camera sees nothing from where the robot starts"};
    return std::vector<Candidate>();
  }
  while (true) {
    if (surface_.views().size() >= most) {
      end_ = {.why = "it keeps " + std::to_string(most) + " views, as many as it may (rift.most_views)"};
      return std::vector<Candidate>();
    }
    if (stops_.empty() && !PlanMove()) return std::vector<Candidate>();
    for (; next_ < stops_.size(); ++next_, tries_ = 0) {
      std::optional<std::string> why =
          tries_ < kMostTries ? FindWay(surroundings)
                              : "the robot did not get there in " + std::to_string(tries_) + " tries";
      if (why) {
        LeaveOut(*why);
        continue;
      }
      // A robot that was stopped on its way has got nearer.
      const double length = PathLength(way_W_);
      tries_ = tries_ > 0 && length > nearest_ - surroundings.map.voxel_size() ? tries_ + 1 : 1;
      nearest_ = tries_ > 1 ? std::min(nearest_, length) : length;
      const Pose& pose = poses_[stops_[next_]];
      std::vector<Candidate> only(1);
      only[0].cluster.center_W = pose.above_W;
      only[0].goals.push_back(surroundings.map.IndexOf(pose.T_WB.translation()));
      only[0].length = length;
      return only;
    }
    stops_.clear();
    if (seen_on_move_ > 0) continue;
    end_ = {.why = saw_nothing_ ? "the camera sees nothing from any pose of the way to the dominant rift"
                                : "no pose of the way to the dominant rift is possible"};
    return std::vector<Candidate>();
  }
}

Choice Rift::Choose(const Situation& /*situation*/) {
  underway_ = true;
  return {.candidate = 0, .path_W = way_W_, .R_WB = poses_[stops_[next_]].T_WB.linear()};
}

bool Rift::PlanMove() {
  const surface::Move move = surface_.PlanMove();
  if (move.poses.empty()) {
    end_ = move.rifts.empty()    ? StrategyEnd{.completes = true, .why = "no rift is left"}
           : move.ranked.empty() ? StrategyEnd{.why = "no path over the surface leads to a rift"}
                                 : StrategyEnd{.why = "the dominant rift has no normal along which to look"};
    return false;
  }
  poses_.clear();
  for (const surface::CameraPose& pose : move.poses)
    poses_.push_back({pose.T_WC * T_BC_.inverse(), pose.above_W});
  stops_ = surface::PlacesToLookFrom(poses_.size(), options_.views_per_move);
  stops_.erase(std::unique(stops_.begin(), stops_.end()), stops_.end());
  next_ = 0;
  passed_ = 0;
  ++move_;
  seen_on_move_ = 0;
  saw_nothing_ = false;
  tries_ = 0;
  return true;
}

std::optional<std::string> Rift::FindWay(const Surroundings& surroundings) {
  const std::size_t goal = stops_[next_];
  if (auto why = WhyNotThere(surroundings, poses_[goal].T_WB.translation())) return why;
  const std::vector<Eigen::Vector3d> starts_W = PlacesToSetOutFrom(surroundings);
  if (starts_W.empty()) return "the robot cannot leave where it stands";
  // Each pose is reached from the last of those before it from which it can be, else from the robot.
  struct Reached {
    Eigen::Vector3d p_W;
    std::size_t pose;
    std::optional<std::size_t> from;  ///< Nothing: from a start.
    std::size_t start = 0;
  };
  std::vector<Reached> reached;
  for (std::size_t i = std::min(passed_, goal); i <= goal; ++i) {
    const Eigen::Vector3d p_W = poses_[i].T_WB.translation();
    if (i < goal && WhyNotThere(surroundings, p_W)) continue;
    const auto enough = reached.rbegin() + static_cast<std::ptrdiff_t>(std::min(kMostBefore, reached.size()));
    const auto from = std::find_if(reached.rbegin(), enough, [&](const Reached& before) {
      return IsFreeBetween(surroundings, before.p_W, p_W);
    });
    if (from != enough) {
      reached.push_back({p_W, i, static_cast<std::size_t>(reached.rend() - from) - 1});
      continue;
    }
    const auto start = std::ranges::find_if(
        starts_W, [&](const Eigen::Vector3d& start_W) { return IsFreeBetween(surroundings, start_W, p_W); });
    if (start != starts_W.end())
      reached.push_back({p_W, i, std::nullopt, static_cast<std::size_t>(start - starts_W.begin())});
  }
  if (reached.empty() || reached.back().pose != goal)
    return "no part of the trajectory leads there through what is known to be free";
  way_W_.clear();
  std::optional<std::size_t> at = reached.size() - 1;
  std::size_t start = 0;
  for (; at; at = reached[*at].from) {
    way_W_.push_back(reached[*at].p_W);
    start = reached[*at].start;
  }
  if (starts_W[start] != surroundings.robot_W) way_W_.push_back(starts_W[start]);
  way_W_.push_back(surroundings.robot_W);
  std::ranges::reverse(way_W_);
  if (surroundings.pull_straight) way_W_ = PullStraight(surroundings.map, way_W_, surroundings.clearance);
  return std::nullopt;
}

void Rift::LeaveOut(const std::string& why) {
  ++left_out_;
  notes_.push_back(PositionOf(next_, stops_.size(), move_) + " is left out: " + why);
}

void Visit(OptionVisitor& visitor, Rift::Options& options) {
  visitor.Block("rift", [&](OptionVisitor& rift) {
    rift.Number("rift_edge_m", options.surface.rift_edge);
    rift.Number("merge_distance_m", options.surface.merge_distance);
    rift.Number("seen_through", options.surface.seen_through);
    rift.Number("height_m", options.surface.height);
    rift.Whole("views_per_move", options.views_per_move);
    rift.Whole("most_views", options.most_views);
  });
}

}  // namespace thalweg::explorer
