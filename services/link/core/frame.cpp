#include "services/link/core/frame.h"

#include <string>

namespace thalweg::link {
namespace {

enum Flags : std::uint8_t { kFirst = 1, kLast = 2, kAllFlags = 3 };

}  // namespace

void Put(ByteWriter& out, const Piece& piece) {
  out.U8(static_cast<std::uint8_t>(piece.channel));
  out.U8(static_cast<std::uint8_t>((piece.first ? kFirst : 0) | (piece.last ? kLast : 0)));
  if (piece.first) out.Varint(piece.total);
  out.U16(static_cast<std::uint16_t>(piece.bytes.size()));
  out.Append(piece.bytes);
}

Result<Piece> TakePiece(ByteReader& in) {
  Piece piece;
  piece.channel = in.U8();
  const std::uint8_t flags = in.U8();
  piece.first = (flags & kFirst) != 0;
  piece.last = (flags & kLast) != 0;
  if (piece.first) piece.total = in.Varint();
  piece.bytes = in.Take(in.U16());
  if (!in.good()) return Error{"a piece is cut off"};
  if ((flags & ~kAllFlags) != 0) return Error{"a piece has unknown flags " + std::to_string(flags)};
  if (piece.bytes.empty()) return Error{"a piece is empty"};
  return piece;
}

void Put(ByteWriter& out, const Report& report) {
  out.U8(kReportChannel);
  out.U8(Report::kVersion);
  out.U64(report.topics);
  out.U64(report.wanted);
  out.U64(report.session);
  out.U64(report.received);
  out.U8(report.restart ? 1 : 0);
  for (const std::int64_t time :
       {report.sent, report.system_minus_steady, report.echo_sent, report.echo_received}) {
    out.U64(static_cast<std::uint64_t>(time));
  }
}

Result<Report> TakeReport(ByteReader& in) {
  const std::uint8_t version = in.U8();
  if (version != Report::kVersion) {
    return Error{"the other side speaks version " + std::to_string(version) + " of the link, this one " +
                 std::to_string(Report::kVersion)};
  }
  Report report;
  report.topics = in.U64();
  report.wanted = in.U64();
  report.session = in.U64();
  report.received = in.U64();
  report.restart = in.U8() != 0;
  for (std::int64_t* const time :
       {&report.sent, &report.system_minus_steady, &report.echo_sent, &report.echo_received}) {
    *time = static_cast<std::int64_t>(in.U64());
  }
  if (!in.good()) return Error{"a report is cut off"};
  // Nine years, or a century since the epoch: sums of such times do not overflow.
  constexpr auto kMostSteady = std::int64_t{1} << 58;
  constexpr auto kMostSystem = std::int64_t{1} << 62;
  const auto is_within = [](std::int64_t time, std::int64_t most) { return time > -most && time < most; };
  if (!is_within(report.sent, kMostSteady) || !is_within(report.echo_sent, kMostSteady) ||
      !is_within(report.echo_received, kMostSteady) || !is_within(report.system_minus_steady, kMostSystem)) {
    return Error{"a report has times that no clock shows"};
  }
  return report;
}

}  // namespace thalweg::link
