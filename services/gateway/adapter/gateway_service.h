#pragma once

#include <chrono>
#include <optional>
#include <span>
#include <string>

#include "common/dds/bus.h"
#include "common/dds/map_replica.h"
#include "common/dds/operator_client.h"
#include "common/dds/replay_client.h"
#include "common/scenario/scenario.h"
#include "services/gateway/adapter/surface_copy.h"
#include "services/gateway/adapter/web_server.h"
#include "services/gateway/core/inbox.h"

namespace thalweg::gateway {

/// Connects the bus to the web server.
///
/// Two buses, since a topic cannot be used both decoded and undecoded on one: `bus` follows the map, the pose
/// and the clock, for the gateway's own two channels; `channels` passes samples of any topic undecoded,
/// while a client wants them. Each spins on a thread of its own, so that neither waits for the other.
class GatewayService {
 public:
  /// @param with_time  Whether the run has a clock of its own, which clients then follow.
  /// @param bus  Made with `bus_options`, with surveys.
  GatewayService(const ListenOptions& options, bool with_time, const Scenario& scenario, PageFiles page,
                 const dds::BusOptions& bus_options, dds::Bus& bus, dds::Bus& channels);

  int port() const { return server_.port(); }

 private:
  void OnMapUpdate(const thalweg_msgs::msg::MapUpdate& message);
  void OnOdometry(const nav_msgs::msg::Odometry& message);
  void OnExploration(const thalweg_msgs::msg::ExplorationStatus& message);
  void OnWanted(const Hub::WantedChanges& changes);
  void OnCommand(Hub::ClientId client, const ClientInfo& info, const ClientCommand& command);
  void Obey(Hub::ClientId client, const std::string& sender, const ClientCommand& command);
  void ObeyForReplay(Hub::ClientId client, const std::string& sender, const ClientCommand& command);
  void Answer(Hub::ClientId client, const CommandTicket& ticket, const CommandAnswer& answer);
  void AnswerInvalid(Hub::ClientId client, const CommandTicket& ticket, const std::string& reason);
  void OnReplay(const thalweg_msgs::msg::ReplayStatus& status);
  void OnSample(std::size_t topic, const dds::RawSample& sample);
  void OnSurface(std::span<const std::uint8_t> bytes);
  void PassInbox();
  void AddToHistory();
  void PassGraph();
  void Report(const Hub::Counts& counts);

  const dds::Names names_;
  const std::string partition_;
  dds::Bus& bus_;
  dds::Bus& channels_;
  dds::Bus::Publisher<dds::topics::MapRequests> requests_out_;
  dds::Bus::Publisher<dds::topics::SurfaceRequests> surface_requests_out_;
  std::optional<dds::OperatorClient> operator_;  ///< None where nobody may steer.
  dds::ReplayClient replay_;
  std::optional<Time> replayed_;                       ///< Where a replay was last, by log time,
  std::chrono::steady_clock::time_point replayed_at_;  ///< and when.
  std::chrono::steady_clock::time_point settled_;  ///< After a jump of the replay, all is of one time again.
  dds::MapReplica map_;
  HistoryFeed::Row row_;
  bool has_pose_ = false;
  std::string strategy_;  ///< The one that the explorer says it follows.
  Hub::Counts reported_;
  // Used on the thread of the channels' bus.
  std::uint64_t samples_ = 0;    ///< How many have arrived so far.
  SurfaceCopy surface_;          ///< Followed while
  bool surface_wanted_ = false;  ///< a client wants it; its updates are passed as they are
  bool surface_passed_ = false;  ///< while one wants these.
  Inbox inbox_;                  ///< What the server has yet to take from the buses.
  WebServer server_;             ///< Last: its thread uses the rest.
};

}  // namespace thalweg::gateway
