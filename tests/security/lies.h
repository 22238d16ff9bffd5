#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/time.h"
#include "common/dds/topic_table.h"
#include "common/geometry/rigid_transform.h"

namespace thalweg::test {

/// What an attacker heard of a run, so that its lies fit.
struct Heard {
  Time now;
  RigidTransform T_WB = RigidTransform::Identity();
  std::uint64_t session = 1;  ///< The session of the map.
  std::uint64_t number = 1;   ///< The number of the map's last update.
  double voxel_size = 0.1;    ///< [m]

  /// Learns from a sample, if its topic carries any of this.
  void Note(const dds::TopicInfo& topic, std::span<const std::uint8_t> sample);
};

/// A false message, as it travels.
struct Lie {
  std::string what;
  std::vector<std::uint8_t> bytes;
};

/// What clears a terminal, colors it and names its window, reverses text, and is no UTF-8.
std::string TerminalEscapes();

/// False messages of a topic: of any type with zeros, the largest and the smallest numbers, NaN, terminal
/// escapes and long texts in every string, and frames and stamps that fit; of types with a meaning those that
/// would do harm.
std::vector<Lie> LiesFor(const dds::TopicInfo& topic, const Heard& heard);

}  // namespace thalweg::test
