#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/option_visitor.h"
#include "common/surface_graph/surface.h"
#include "services/explorer/core/strategy/strategy.h"

namespace thalweg::explorer {

/// Exploration by the rifts of the surface graph, as it is printed [Shade: Choosing Where To Go, DPhil
/// thesis, Oxford 2011, Ch. 5; Shade, Newman, ICRA 2010]: surface::Surface, for a robot in a map.
///
/// A move leads to the dominant rift, on the camera's trajectory above the path over the surface. The robot
/// stops at `views_per_move` of its poses, looks from each, and adds the view to the graph. The printed path
/// ignores the body and the world; here the map forbids. A pose in which the body would not stand in space
/// that is known to be free is left out, and so is one to which no part of the trajectory leads through such
/// space; each is counted. What is left of the trajectory is the way from one stop to the next.
///
/// It ends when no rift is left, which is the method's own end; when no path over the surface leads to one;
/// when the dominant rift has no normal; when every pose of a move is left out or shows nothing, since the
/// next move would be the same; and when as many views are kept as may be.
///
/// Departures: a pose from which the robot has just looked is not looked from again where a trajectory has
/// fewer poses than there are views. A pose that the robot set out for kMostTries times without getting any
/// nearer is left out. A view in which nothing was measured is not kept. The way to a pose is sought from the
/// kMostBefore poses before it at most.
class Rift final : public Strategy {
 public:
  struct Options {
    surface::SurfaceOptions surface;
    /// The thesis's experiments have four intermediate poses a move; the last one above the rift is taken to
    /// be the fourth.
    int views_per_move = 4;
    /// Images are kept, so that memory grows with their number, about 130 bytes a pixel. The first and those
    /// of twenty moves are 81: at 640 x 480 pixels below 4 GB.
    int most_views = 81;
  };
  static constexpr int kMostTries = 3;
  static constexpr std::size_t kMostBefore = 50;  ///< A move may have thousands.

  /// Throws std::invalid_argument naming the invalid option.
  explicit Rift(const Options& options);

  bool goes_by_views() const override { return true; }
  bool lacks_view() const override { return surface_.views().empty() && !saw_nothing_; }
  void See(const CameraView& seen) override;
  /// The next pose to look from, as the only candidate; what it looks at stands for the cluster.
  std::optional<std::vector<Candidate>> FindCandidates(const Surroundings& surroundings) override;
  Choice Choose(const Situation& situation) override;
  const std::optional<StrategyEnd>& end() const override { return end_; }
  std::size_t left_out() const override { return left_out_; }
  std::vector<std::string> TakeNotes() override { return std::exchange(notes_, {}); }

  const surface::Surface& surface() const { return surface_; }

 private:
  /// A pose of the camera's trajectory.
  struct Pose {
    RigidTransform T_WB;
    Eigen::Vector3d above_W;  ///< [m]
  };
  /// Plans the next move. @return Whether there is one; otherwise end_ says why not.
  bool PlanMove();
  /// Finds way_W_ to the next stop. @return Why there is none.
  std::optional<std::string> FindWay(const Surroundings& surroundings);
  void LeaveOut(const std::string& why);

  Options options_;
  surface::Surface surface_;
  RigidTransform T_BC_ = RigidTransform::Identity();  ///< As of the last view.
  std::vector<Pose> poses_;                           ///< The present move's.
  std::vector<std::size_t> stops_;                    ///< Those to look from,
  std::size_t next_ = 0;                              ///< and the next of them.
  std::size_t passed_ = 0;                            ///< Poses before it lie behind the robot.
  std::size_t move_ = 0;                              ///< Number of the present move, from 1.
  int seen_on_move_ = 0;                              ///< Views that were kept.
  bool saw_nothing_ = false;                          ///< Whether the last view shows nothing.
  int tries_ = 0;          ///< Times that the robot was sent to the next stop and got no nearer,
  double nearest_ = 0.0;   ///< [m] than this.
  bool underway_ = false;  ///< Whether the robot was sent to it.
  std::size_t left_out_ = 0;
  std::vector<std::string> notes_;
  std::vector<Eigen::Vector3d> way_W_;  ///< [m] To the next stop.
  std::optional<StrategyEnd> end_;
};

void Visit(OptionVisitor& visitor, Rift::Options& options);  ///< Block `rift`.

}  // namespace thalweg::explorer
