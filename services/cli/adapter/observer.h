#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "common/dds/bus.h"
#include "common/dds/map_replica.h"
#include "common/scenario/scenario.h"
#include "services/cli/adapter/truth_judge.h"
#include "services/cli/report/coverage_tally.h"
#include "services/cli/report/live_line.h"
#include "services/cli/report/run_record.h"

namespace thalweg::cli {

/// Listens to a run, changes nothing in it, and can tell at any time how far it is and what came of it.
/// Services may be restarted meanwhile: what they count is added up.
class Observer {
 public:
  /// @param name  Of the scenario, for the report.
  Observer(const Scenario& scenario, const std::string& name, dds::Bus& bus);

  /// The exploration is done and the map holds all that was seen until then (or none came in time).
  bool finished() const { return finished_; }
  /// What makes all that is observed worthless, when something does.
  std::optional<std::string> failure() const;
  const std::string& stop_reason() const { return exploration_.stop_reason(); }  ///< Empty until done.

  LiveState Live();
  /// Waits for the true map where there is one. @param stop_reason  Where the exploration gave none.
  RunRecord Record(const std::string& stop_reason);
  const OccupancyGrid* map() const { return map_.has_map() ? &map_.grid() : nullptr; }
  const std::string& truth_error() const { return truth_.error(); }

 private:
  using Steady = std::chrono::steady_clock;

  void OnMapUpdate(const thalweg_msgs::msg::MapUpdate& message);
  void OnOdometry(const nav_msgs::msg::Odometry& message);
  void OnExploration(const thalweg_msgs::msg::ExplorationStatus& message);
  void OnSimulation(const thalweg_msgs::msg::SimulationStatus& message);
  void OnHealth(const thalweg_msgs::msg::ServiceHealth& message);
  void RequestMap();
  void JudgeWhetherFinished();
  void BeginTruth();
  void Sample();
  double TimeNow() const;  ///< [s] since the first pose.
  double VoxelVolume() const;
  void AddMessages(RunRecord& record) const;

  Scenario scenario_;
  std::string name_;
  dds::Bus& bus_;
  dds::Bus::Publisher<dds::topics::MapRequests> requests_out_;

  dds::MapReplica map_;
  Time map_stamp_;  ///< Of the newest cloud in it.
  CoverageTally tally_;
  TruthJudge truth_;
  std::size_t judged_ = 0;      ///< Voxels of the tally that were compared with the truth,
  std::size_t observable_ = 0;  ///< and those of them that count.

  std::vector<TimedPose> trajectory_;  ///< In the run's time, which never goes back.
  Duration clock_offset_{0};           ///< The clock's time less the run's; never above 0.
  Steady::time_point clock_went_back_;
  int jumps_in_a_row_ = 0;
  Eigen::Vector3d counted_W_ = Eigen::Vector3d::Zero();  ///< Where distance_ was added up to.
  double distance_ = 0.0;

  bool heard_controller_ = false;
  std::optional<Steady::time_point> heard_explorer_;  ///< Last.
  thalweg_msgs::msg::ExplorationStatus exploration_;  ///< Latest.
  std::uint64_t plans_before_ = 0;                    ///< By explorers that were restarted since.
  std::uint64_t replans_before_ = 0;
  std::optional<thalweg_msgs::msg::SimulationStatus> simulation_;  ///< Latest.
  std::uint32_t collisions_before_ = 0;
  std::map<std::pair<std::string, std::uint32_t>, thalweg_msgs::msg::ServiceHealth> health_;

  Steady::time_point begun_ = Steady::now();
  std::optional<Time> done_;
  Steady::time_point done_wall_;
  double done_time_ = 0.0;
  bool finished_ = false;
};

}  // namespace thalweg::cli
