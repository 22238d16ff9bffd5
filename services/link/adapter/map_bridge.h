#pragma once

#include <optional>
#include <string>

#include "common/dds/map_log.h"
#include "common/dds/map_replica.h"
#include "services/link/core/map_feed.h"

namespace thalweg::link {

/// The map of a mapper on this side, for the other.
///
/// Threading: one thread at a time.
class MapSender {
 public:
  /// Takes an update of the mapper. Returns what is wrong with it.
  std::optional<std::string> OnUpdate(const thalweg_msgs::msg::MapUpdate& update);
  /// What to request of the mapper, if anything is missing.
  std::optional<thalweg_msgs::msg::MapRequest> Request(Time now) const;
  /// The next change to cross; nothing if the other side has everything.
  /// @param session  Session of the link: in another the other side has nothing.
  std::optional<Buffer> Next(std::uint64_t session);

 private:
  dds::MapReplica replica_;
  std::optional<MapFeed> feed_;
  Time stamp_{};
  std::uint64_t session_ = 0;
};

/// The map that arrives from the other side, as a mapper here would publish it: in updates with a session and
/// numbers of its own, and full copies.
///
/// Threading: one thread.
class MapReceiver {
 public:
  /// Takes a change. Returns the update for the readers on this side.
  Result<thalweg_msgs::msg::MapUpdate> OnChange(Bytes bytes);
  /// The whole map; nothing before the first change.
  std::optional<thalweg_msgs::msg::MapUpdate> FullCopy() const;

 private:
  std::optional<OccupancyGrid> grid_;
  std::optional<dds::MapLog> log_;
};

}  // namespace thalweg::link
