#pragma once

#include <cstdint>
#include <optional>

#include "common/base/time.h"
#include "services/link/core/packing.h"

namespace thalweg::link {

/// Largest payload of a frame. With the headers of RTPS, UDP and IP a frame is one packet on any link of 1400
/// bytes (common/dds/qos.cpp).
inline constexpr std::size_t kFrameBytes = 1200;

/// What crosses in one packet. The frames of a session are numbered from 1.
struct Frame {
  std::uint64_t session = 0;
  std::uint64_t sequence = 0;
  Buffer payload;
};

/// A part of a message in a frame. The messages of a channel cross one after the other, each in order; those
/// of several channels interleave.
struct Piece {
  std::size_t channel = 0;
  bool first = false;
  bool last = false;
  std::size_t total = 0;  ///< [byte] Size of the message; only in the first piece.
  Bytes bytes;
};

/// Upper bound of what a piece costs beyond its bytes.
inline constexpr std::size_t kPieceHeaderBytes = 9;
inline constexpr std::size_t kMostChannels = 64;
inline constexpr std::uint8_t kReportChannel = 255;

void Put(ByteWriter& out, const Piece& piece);
/// Error: bytes that hold no sound piece.
Result<Piece> TakePiece(ByteReader& in);

/// What one side says to the other about the link itself.
struct Report {
  static constexpr std::uint8_t kVersion = 1;
  std::uint64_t topics = 0;              ///< Hash of the table of channels: both sides must have the same.
  std::uint64_t wanted = 0;              ///< Bit k: somebody here reads channel k.
  std::uint64_t session = 0;             ///< The other side's, as heard; 0 = not heard yet.
  std::uint64_t received = 0;            ///< The last frame of that session which arrived in order.
  bool restart = false;                  ///< The session cannot be followed: begin another.
  std::int64_t sent = 0;                 ///< [ns] By the sender's steady clock.
  std::int64_t system_minus_steady = 0;  ///< [ns] Difference of the sender's clocks.
  std::int64_t echo_sent = 0;            ///< [ns] `sent` of the last report from the other side; 0 = none.
  std::int64_t echo_received = 0;        ///< [ns] When that arrived, by the sender's steady clock.
};

void Put(ByteWriter& out, const Report& report);
/// Error: bytes of another version, or too few. The channel's number has been read.
Result<Report> TakeReport(ByteReader& in);

}  // namespace thalweg::link
