#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/dds/bus.h"
#include "common/dds/map_replica.h"
#include "common/scenario/scenario.h"
#include "services/cli/adapter/truth_judge.h"
#include "services/cli/report/coverage_tally.h"
#include "services/cli/report/decision_log.h"
#include "services/cli/report/live_line.h"
#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// Observes a run without influencing it, and reports its progress and its result at any time. Services may
/// be restarted meanwhile; their counts are added up. Text in messages is cleaned, and lists are limited,
/// where they arrive, so that nothing a peer sends reaches the terminal, the log or the report as it is.
class Observer {
 public:
  /// @param name  Name of the scenario, for the report.
  Observer(const Scenario& scenario, const std::string& name, dds::Bus& bus);

  /// Whether the exploration is done and the map contains everything seen until then (or did not arrive in
  /// time).
  bool finished() const { return finished_; }
  /// Why the observations are worthless, if they are.
  std::optional<std::string> failure() const;
  /// What is wrong with the run's files and figures, without ending the run; one line each.
  std::vector<std::string> warnings() const;
  /// Whether the mapper has resumed its map from a checkpoint, so that more counts as explored than was seen.
  bool map_was_resumed() const;
  const std::string& stop_reason() const { return exploration_.stop_reason(); }  ///< Empty until done.

  LiveState Live();
  /// Waits for the true map if there is one.
  /// @param stop_reason  Used if the exploration gave none.
  RunRecord Record(const std::string& stop_reason);
  const OccupancyGrid* map() const { return map_.has_map() ? &map_.grid() : nullptr; }
  const CoverageTally& tally() const { return tally_; }
  const std::string& truth_error() const { return truth_.error(); }

 private:
  using Steady = std::chrono::steady_clock;

  void OnMapUpdate(const thalweg_msgs::msg::MapUpdate& message);
  void OnOdometry(const nav_msgs::msg::Odometry& message);
  void OnPath(const nav_msgs::msg::Path& message);
  void OnFrontiers(const thalweg_msgs::msg::FrontierList& message);
  void OnExploration(const thalweg_msgs::msg::ExplorationStatus& message);
  void OnSimulation(const thalweg_msgs::msg::SimulationStatus& message);
  void OnSurface(const thalweg_msgs::msg::SurfaceStatus& message);
  void OnMotion(const thalweg_msgs::msg::MotionStatus& message);
  void OnHealth(const thalweg_msgs::msg::ServiceHealth& message);
  void NoteTrouble(const thalweg_msgs::msg::ServiceHealth& before,
                   const thalweg_msgs::msg::ServiceHealth& now);
  bool LacksClock() const;
  bool LacksOdometry() const;
  bool IsRecent(const std::optional<Steady::time_point>& at) const;
  void RequestMap();
  void JudgeWhetherFinished();
  void BeginTruth();
  void Sample();
  void MeasureFloor();
  double TimeNow() const;  ///< [s] Since the first pose.
  double VoxelVolume() const;
  /// Nothing before the explorer has looked for any, when its status says 0.
  std::optional<unsigned> FrontiersLeft() const;
  void AddMessages(RunRecord& record) const;
  void AddServices(RunRecord& record) const;

  Scenario scenario_;
  std::string name_;
  dds::Bus& bus_;
  dds::Bus::Publisher<dds::topics::MapRequests> requests_out_;

  dds::MapReplica map_;
  Time map_stamp_;  ///< Stamp of the newest cloud in it.
  CoverageTally tally_;
  TruthJudge truth_;
  std::size_t judged_ = 0;      ///< Number of voxels of the tally compared with the truth.
  std::size_t observable_ = 0;  ///< Number of those that count.

  std::vector<TimedPose> trajectory_;  ///< In the run's time, which never goes back.
  Duration clock_offset_{0};           ///< The clock's time minus the run's time; never above 0.
  Steady::time_point clock_went_back_;
  int jumps_in_a_row_ = 0;
  Eigen::Vector3d counted_W_ = Eigen::Vector3d::Zero();  ///< Position up to which distance_ has been summed.
  double distance_ = 0.0;

  bool heard_controller_ = false;
  std::optional<Steady::time_point> stopped_since_;
  std::string stop_;                                  ///< Why, as the controller says.
  std::optional<Steady::time_point> heard_explorer_;  ///< Time of the latest status.
  thalweg_msgs::msg::ExplorationStatus exploration_;  ///< Latest status.
  std::uint64_t plans_before_ = 0;                    ///< Plans of explorers that have since been restarted.
  std::uint64_t replans_before_ = 0;
  DecisionLog decisions_;
  std::vector<FrontierMark> frontiers_;                            ///< Latest.
  std::optional<thalweg_msgs::msg::SimulationStatus> simulation_;  ///< Latest status.
  std::optional<thalweg_msgs::msg::SurfaceStatus> surface_;        ///< Likewise; empty if there is none.
  std::uint32_t collisions_before_ = 0;
  std::map<std::pair<std::string, std::uint32_t>, thalweg_msgs::msg::ServiceHealth> health_;

  std::string floating_;  ///< What is wrong with the robot's height; empty if nothing is.
  std::string trouble_;   ///< The latest refusal that a service reported,
  std::optional<Steady::time_point> trouble_at_;  ///< and when.
  std::optional<Steady::time_point> unusable_pose_at_;

  Steady::time_point begun_ = Steady::now();
  std::optional<Time> done_;
  Steady::time_point done_wall_;
  double done_time_ = 0.0;
  bool finished_ = false;
};

}  // namespace thalweg::cli
