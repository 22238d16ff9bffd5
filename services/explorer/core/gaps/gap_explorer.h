#pragma once

#include <optional>
#include <vector>

#include "services/explorer/core/gaps/point_robot.h"

namespace thalweg::explorer {

/// Explores a polygon as the source thesis' Algorithm 1 says [Shade: Choosing Where To Go, DPhil thesis,
/// Oxford 2011, after Tovar, Murrieta-Cid, LaValle 2007]: while a leaf of the gap navigation tree is not
/// primitive, choose one, chase it until a critical event, and update the tree.
///
/// Where the algorithm only says "choose one": the leaf chosen before, as long as it is there, which is what
/// makes the exploration end: chased to its end, a leaf disappears or splits, and a polygon allows finitely
/// many splits. Otherwise the leaf with the fewest gaps above it, of those the one seen first most recently.
/// Nothing metric is asked for. A leaf that lies within merged gaps is chased by chasing the one in sight,
/// which splits in time.
class GapExplorer {
 public:
  /// What happened, and where.
  struct Record {
    GapEvent event;
    Eigen::Vector2d position;  ///< Just after it.
    double length = 0.0;       ///< [m] The path's up to there.
  };

  /// Arguments and exceptions are those of PointRobot.
  GapExplorer(const Polygon& polygon, const Eigen::Vector2d& start, const PointRobot::Options& options = {});

  /// One turn of the loop. False, and nothing moves, once all leaves are primitive.
  bool Step();

  /// Brings a gap of the tree into sight by chasing the gaps above it, one after the other.
  void GoTo(GapTree::Node node);

  const PointRobot& robot() const { return robot_; }
  const GapTree& tree() const { return tree_; }
  const std::vector<Record>& log() const { return log_; }

 private:
  GapTree::Node Choose() const;
  void Chase(GapTree::Node node);

  PointRobot robot_;
  GapTree tree_;
  std::vector<Record> log_;
  std::optional<GapTree::Node> chosen_;
};

}  // namespace thalweg::explorer
