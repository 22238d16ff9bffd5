#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/dds/topic_table.h"
#include "services/recorder/adapter/update_follower.h"
#include "services/recorder/core/mcap_reader.h"

namespace thalweg::recorder {

/// A channel of a recording, and the topic on the bus on which it is played.
struct PlayedChannel {
  std::uint16_t channel = 0;
  dds::TopicInfo topic;
};

/// What readers have to be sent so that they hold what they would hold if a recording had been played from
/// its beginning to some time:
///   map/updates, surface/updates: one full copy, to which later updates fit;
///   tf, tf_static: the last transform of each frame, in one message;
///   rosout: the last lines, as many as a late joiner gets;
///   any other topic: its last message.
/// Where a topic is played only if it is named (dds::Replay) nothing but the last state, since a command
/// that is repeated would be obeyed again; paths and set points, which expire, not at all.
struct Moment {
  struct Item {
    std::size_t channel;  ///< Index in the channels given.
    std::vector<std::uint8_t> sample;
  };
  std::vector<Item> items;  ///< Full copies first, then by log time.
  /// By name of the topic: what they follow up to this time, under the sessions' new numbers.
  std::map<std::string, std::unique_ptr<UpdateFollower>> followers;
  Problems problems;  ///< What could not be read.
};

/// Reads what stands before `time`; takes as long as decompressing the recording up to there.
/// @param token      Renames the sessions of numbered updates, see RenamedSession. If it is not 0, readers
///                   may hold a later state: of a map without a full copy yet they get an empty one, and of
///                   any other topic that has said nothing yet its first message after `time`, unless that
///                   comes by itself within `soon`.
/// @param canceled   Asked often; if it returns true, nothing is returned.
std::optional<Moment> ReadMoment(const McapReader& reader, const std::vector<PlayedChannel>& channels,
                                 Time time, std::uint64_t token, Duration soon,
                                 const std::function<bool()>& canceled);

}  // namespace thalweg::recorder
