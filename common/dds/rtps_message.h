#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace thalweg::dds {

/// What a receiver accepts beyond a well-formed message.
struct RtpsRules {
  /// The largest sample that a fragment may claim to belong to [bytes], since a reader reserves memory for
  /// the whole sample when the first fragment arrives.
  std::uint32_t largest_sample = 1U << 20;
  /// Whether only encrypted submessages carry samples: Fast DDS 2.9.1 passes a plain one to a protected
  /// reader as if it had been decrypted. Exceptions are what peers without keys of each other yet have to
  /// exchange: the announcement of a participant, the handshake, and the greetings of the plain discovery
  /// endpoints, which carry nothing.
  bool secured = false;
};

/// The largest sequence number: a writer of 1000 samples a second takes 34 years to reach it.
inline constexpr std::int64_t kLargestSequenceNumber = 1LL << 40;
/// The most sequence numbers before the bitmap of a gap: a reader walks through each and may store it. The
/// histories of our writers hold at most 200.
inline constexpr std::int64_t kMostGapNumbers = 1024;
/// The most fragments in one submessage: Fast DDS sends 1, Cyclone DDS as many as fit in 14 kB.
inline constexpr std::uint32_t kMostFragments = 64;

/// Checks the structure of a datagram as an RTPS message: its header; that each submessage lies within the
/// datagram, is as long as its kind requires and aligned to 4 bytes; that sequence numbers, fragment numbers,
/// sets and sizes are in the ranges that the standard gives them, and in those that Fast DDS can process;
/// that parameter lists and fragments end within their submessage. Contents are not checked, nor are kinds of
/// submessages that the standard leaves to vendors, but for the one of Fast DDS statistics.
///
/// Fast DDS 2.9.1 asserts or assumes some of these instead of checking them, so that one datagram ends the
/// process, stops it for ever or fills its memory.
///
/// @return What is wrong; nothing if the message is well formed.
/// Source: OMG DDSI-RTPS 2.3 [formal/19-04-03], sections 8.3.7 and 9.4.5.
std::optional<std::string_view> FindRtpsError(std::span<const std::uint8_t> datagram,
                                              const RtpsRules& rules = {});

/// What else has to be known of a well-formed message; of what is encrypted in it, nothing.
struct RtpsContents {
  struct Heartbeat {
    std::array<std::uint8_t, 16> writer;  ///< Its GUID.
    std::int64_t first;                   ///< The first sequence number that it still has.
  };
  std::array<std::uint8_t, 12> sender{};  ///< The prefix of its GUID.
  bool has_fragments = false;             ///< Whether fragments of samples are among them.
  bool introduces = false;                ///< Whether it announces a participant or is part of a handshake.
  /// If it says that the participant that sent it ends: how many bytes of it lead to the end of that.
  std::optional<std::size_t> farewell;
  std::vector<Heartbeat> heartbeats;
};
/// Returns what precedes the fault if the message is not well formed.
RtpsContents ContentsOf(std::span<const std::uint8_t> datagram);

}  // namespace thalweg::dds
