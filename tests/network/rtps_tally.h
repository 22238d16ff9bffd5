#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace thalweg::network {

/// What crossed a link under one name.
struct TopicCount {
  std::uint64_t bytes = 0;    ///< Ethernet frames, with all headers, repetitions and acknowledgments.
  std::uint64_t packets = 0;  ///< Ethernet frames.
  /// Samples that were sent, each once, however many packets and repetitions it took; 0 for what is not a
  /// topic. Sequence numbers that a writer skips are not counted.
  std::uint64_t samples = 0;
};

/// Counts the traffic of a link by DDS topic, from the Ethernet frames that enter it.
///
/// Follows RTPS 2.2 [OMG formal/2014-09-01, Sec. 8.3 and 9.4]. Topics are known from the discovery messages
/// of their writers, which cross the same link first. Frames that belong to none count under "discovery",
/// "arp", "other udp" or "other"; RTPS about writers that were never announced under "unknown". The later IP
/// fragments of a datagram belong to the topic that its first fragment ends with; only of discovery, which
/// announces several writers in one datagram, are they put together and read.
/// Threading: one thread. One object serves both directions, since acknowledgments name writers of the other
/// side.
class RtpsTally {
 public:
  enum Direction { kFirst = 0, kSecond = 1 };

  void Count(Direction direction, std::span<const std::uint8_t> frame);
  /// By topic, without the "rt/" of ROS 2 names.
  const std::map<std::string, TopicCount>& topics(Direction direction) const { return topics_.at(direction); }

 private:
  using GuidPrefix = std::array<std::uint8_t, 12>;
  using EntityId = std::uint32_t;
  struct Guid {
    GuidPrefix prefix;
    EntityId entity;
    auto operator<=>(const Guid&) const = default;
  };
  /// Identifies the fragments of one datagram.
  struct Datagram {
    std::uint32_t source;
    std::uint32_t destination;
    std::uint16_t id;
    auto operator<=>(const Datagram&) const = default;
  };
  /// A datagram of which fragments are still to come.
  struct Unfinished {
    std::string name;                   ///< What they count under.
    std::vector<std::uint8_t> message;  ///< So far, without the header of UDP; only of discovery.
  };
  struct Submessage;

  template <class Handle>
  static void ForEachSubmessage(std::span<const std::uint8_t> message, Handle&& handle);
  /// @return  The name that the message ends with.
  std::string CountRtps(Direction direction, std::span<const std::uint8_t> message, std::size_t frame_bytes);
  void CountLaterFragment(Direction direction, const Datagram& datagram, std::span<const std::uint8_t> ip,
                          std::size_t frame_bytes);
  void CountSample(const Submessage& submessage, const Guid& writer, TopicCount& count);
  void LearnWriters(std::span<const std::uint8_t> message);
  void LearnWriter(const Submessage& submessage, const GuidPrefix& announcer);
  const std::string& NameOf(const Guid& writer) const;

  std::array<std::map<std::string, TopicCount>, 2> topics_;
  std::map<Guid, std::string> writers_;
  std::map<Guid, std::int64_t> newest_sample_;
  std::map<Datagram, Unfinished> unfinished_;
};

}  // namespace thalweg::network
