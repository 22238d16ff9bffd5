#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace thalweg::dds {

/// The largest sample that a fragment may claim to belong to, since a reader reserves memory for the whole
/// sample when the first fragment arrives. A full copy of a map with 20 million voxels is smaller.
inline constexpr std::uint32_t kLargestSampleBytes = 128U << 20;

/// Checks the structure of a datagram as an RTPS message: its header; that each submessage lies within the
/// datagram, is as long as its kind requires and aligned to 4 bytes; that sequence numbers, fragment numbers,
/// sets and sizes are in the ranges that the standard gives them; that parameter lists end within their
/// submessage. Contents are not checked, nor are kinds of submessages that the standard leaves to vendors,
/// but for the one of Fast DDS statistics.
///
/// Fast DDS 2.9.1 asserts some of these instead of checking them, so that one datagram ends the process.
///
/// @return What is wrong; nothing if the message is well formed.
/// Source: OMG DDSI-RTPS 2.3 [formal/19-04-03], sections 8.3.7 and 9.4.5.
std::optional<std::string_view> FindRtpsError(std::span<const std::uint8_t> datagram);

}  // namespace thalweg::dds
