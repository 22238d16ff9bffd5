#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "common/base/stopwatch.h"
#include "common/dds/bus.h"
#include "common/dds/command_ledger.h"
#include "common/dds/map_replica.h"
#include "common/dds/placed_views.h"
#include "services/explorer/adapter/exploration_file.h"
#include "services/explorer/adapter/planner_inbox.h"
#include "services/explorer/core/exploration_loop.h"

namespace thalweg::explorer {

/// Runs the exploration loop on the bus: reads map updates, odometry, motion status and operators' commands,
/// and publishes path, status and replies.
///
/// Where the strategy goes by views, it also reads organized clouds or depth images, and hands over the
/// newest with the pose that the odometry has at its stamp; see dds::PlacedViews for what is refused.
///
/// Planning takes too long for the bus's thread, which must keep repeating the path or the controller would
/// stop. The loop therefore runs on a thread of its own: events from the bus reach it through an inbox, and
/// its orders return through Bus::Post. Where the inbox has no room for a map update, the planner gets the
/// whole map once it has caught up; other events are dropped. Both are counted.
class ExplorerService {
 public:
  enum class ViewSource : std::uint8_t { kClouds, kDepthImages };

  /// @param file  Where to keep what the next process needs, should this one die (SavedExploration); what is
  /// there is continued. Empty = nowhere. A file that cannot be read or written is reported in the log.
  /// @param views  From where views come, for a strategy that goes by them.
  ExplorerService(const Explorer::Options& options, dds::Bus& bus, ExplorationFile file = {},
                  ViewSource views = ViewSource::kClouds);
  /// Removes the file, because this process ends as it should.
  void Forget();

 private:
  // On the bus's thread.
  void OnMapUpdate(const thalweg_msgs::msg::MapUpdate& message);
  void OnOdometry(const nav_msgs::msg::Odometry& message);
  /// @param message  A cloud, a depth image, or its calibration.
  template <class Message>
  void OnDepth(const Message& message);
  void HandOverViews();
  void OnOdometryStatus(const thalweg_msgs::msg::OdometryStatus& message);
  void OnMotionStatus(const thalweg_msgs::msg::MotionStatus& message);
  void OnCommand(const thalweg_msgs::msg::OperatorCommand& message);
  void Reply(const dds::CommandId& id, const Answer& answer);
  void AskForMap();
  void Repeat();
  void PublishOrder();
  /// Publishes the loop's order as soon as the bus comes to it. For the planner's thread.
  void PostOrder();
  void PublishStatus();
  void PublishMarkers();
  bool HandOver(MapNews news);
  void HandOverWholeMap();
  template <class Topic>
  bool HandOver(PlannerInbox::Event event);

  // On the planner's thread.
  void RunPlanner(std::stop_token stop);
  void CountBeyondLimit();
  void PublishThoughts();
  void LogInterruptions();
  void Continue();
  void SaveWhenDue();
  thalweg_msgs::msg::ExplorationStatus MakeStatus() const;

  dds::Bus& bus_;
  const double sensor_range_;  ///< [m]
  const RigidTransform T_BC_;
  dds::Bus::Publisher<dds::topics::Path> path_out_;
  dds::Bus::Publisher<dds::topics::ExplorationStatus> status_out_;
  dds::Bus::Publisher<dds::topics::MapRequests> request_out_;
  dds::Bus::Publisher<dds::topics::Frontiers> frontiers_out_;
  dds::Bus::Publisher<dds::topics::FrontierMarkers> markers_out_;
  dds::Bus::Publisher<dds::topics::Field> field_out_;
  dds::Bus::Publisher<dds::topics::Sealed> sealed_out_;
  dds::Bus::Publisher<dds::topics::Streamline> streamline_out_;
  dds::Bus::Publisher<dds::topics::CommandReplies> replies_out_;
  dds::CommandLedger commands_;
  std::optional<dds::PlacedViews> views_;  ///< If the strategy goes by them.
  dds::MapReplica replica_;
  Time map_stamp_;                  ///< The stamp of the newest cloud in it.
  bool planner_lacks_map_ = false;  ///< Whether an update did not fit into the inbox.
  std::optional<ExplorationLoop::Order> order_;
  thalweg_msgs::msg::ExplorationStatus status_;
  thalweg_msgs::msg::FrontierList frontiers_;  ///< As of the last plan.
  bool markers_due_ = false;                   ///< Whether they have not been published as markers.

  std::mutex newest_view_mutex_;
  /// What the planner has yet to take: a newer view replaces an older one, however long a plan takes.
  std::optional<ViewNews> newest_view_;

  // Used by the planner's thread only.
  ExplorationLoop loop_;
  std::string activity_;  ///< As last published.
  std::size_t beyond_limit_ = 0;
  std::size_t plans_published_ = 0;
  std::size_t plans_noted_ = 0;  ///< In the log.
  std::map<Interruption, std::size_t> interruptions_logged_;
  const ExplorationFile file_;
  std::string saved_commands_;            ///< What of the operator's commands the file holds.
  std::optional<Stopwatch> since_saved_;  ///< Since the last attempt to write it.
  bool save_fails_ = false;

  PlannerInbox inbox_;
  std::jthread planner_;  ///< Declared last, because it uses everything above.
};

}  // namespace thalweg::explorer
