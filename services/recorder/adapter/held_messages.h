#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/time.h"
#include "common/dds/topic_table.h"
#include "services/recorder/adapter/update_follower.h"

namespace thalweg::recorder {

/// What was said once on some topics and holds until it is said again: that with which a recording has to
/// begin if it begins later than its topics do.
///   Topics that the middleware keeps for late joiners (Delivery::kState): their newest message, and of
///   transforms, which many publish, the newest messages that have the last transform of each frame.
///   map/updates, surface/updates: one full copy, to which later updates fit.
///
/// Threading: one thread.
class HeldMessages {
 public:
  struct Item {
    std::size_t channel;  ///< Whatever the caller numbers.
    std::uint32_t sequence;
    Time log_time, publish_time;  ///< For a full copy, those of the last update in it.
    std::vector<std::uint8_t> payload;
  };

  static bool IsHeld(const dds::TopicInfo& topic);

  /// Holds what Take is given of the channel from now on; does nothing if the topic is not held.
  void Hold(std::size_t channel, const dds::TopicInfo& topic);
  /// Messages of other channels are ignored.
  void Take(std::size_t channel, std::uint32_t sequence, Time log_time, Time publish_time, Bytes payload);
  /// Whether this very message is held already: the same bytes, sent at the same time. Never for updates.
  bool Has(std::size_t channel, std::uint32_t sequence, Time publish_time, Bytes payload) const;
  std::vector<Item> Items()
      const;  ///< In order of their log time; messages as they were taken, byte for byte.

 private:
  struct Stored {
    Item item;
    std::set<std::string> frames;  ///< Those whose last transform is in it.
  };
  struct Topic {
    bool has_transforms = false;
    std::deque<Stored> newest = {};
    std::unique_ptr<UpdateFollower> follower = {};  ///< Null if the topic has no updates; then newest counts.
    Item last_update = {};                          ///< Without its payload.
  };
  std::map<std::size_t, Topic> topics_;  ///< By channel.
};

}  // namespace thalweg::recorder
