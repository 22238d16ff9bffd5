#include <algorithm>

#include "common/compression/compression.h"
#include "services/recorder/core/mcap_parse.h"
#include "services/recorder/core/mcap_reader.h"

namespace thalweg::recorder {

// A file opened by its summary.

bool McapReader::OpenBySummary() {
  const std::uint64_t tail = kFooterBytes + kMagic.size();
  if (file_.size() < 2 * kMagic.size() + kFooterBytes || !IsMagic(file_.last(kMagic.size()))) {
    problems_.Add(At(file_.size()) +
                  "the file does not end as an MCAP file does: its recorder was stopped or "
                  "the file is cut");
    return false;
  }
  const std::uint64_t footer_offset = file_.size() - tail;
  const auto footer = RecordAt(file_, footer_offset);
  if (!footer || footer->op != Op::kFooter || footer->end != file_.size() - kMagic.size()) {
    problems_.Add(At(footer_offset) + "no footer");
    return false;
  }
  ByteReader in(footer->content);
  const std::uint64_t start = in.U64();
  in.U64();  // where the offsets of the summary's groups begin
  const std::uint32_t crc = in.U32();
  is_without_summary_ = start == 0;
  if (is_without_summary_) return false;
  if (start < kMagic.size() || start > footer_offset) {
    problems_.Add(At(footer_offset) + "the footer says that the summary begins at byte " +
                  std::to_string(start) + ", which is not before the footer");
    return false;
  }
  const std::uint64_t covered = file_.size() - kMagic.size() - sizeof(crc) - start;
  if (crc != 0 && Crc32(file_.subspan(start, covered)) != crc) {
    problems_.Add(At(start) + "the summary's CRC is wrong");
    return false;
  }
  return ReadSummary(start);
}

bool McapReader::ReadSummary(std::uint64_t start) {
  if (const auto header = RecordAt(file_, kMagic.size()); header && header->op == Op::kHeader) {
    ByteReader in(header->content);
    profile_ = in.String();
    library_ = in.String();
  } else {
    problems_.Add(At(kMagic.size()) + "no header");
    return false;
  }
  std::map<std::uint16_t, Channel> schemas;
  Totals totals;
  std::uint64_t offset = start;
  for (;;) {
    const auto record = RecordAt(file_, offset);
    if (record && record->op == Op::kFooter) break;
    if (!record || !ReadSummaryRecord(*record, schemas, totals)) {
      problems_.Add(At(offset) + "the summary has a record that makes no sense");
      return false;
    }
    offset = record->end;
  }
  // A summary may leave parts out; then the file is scanned as if it had none. Without message indexes
  // nothing says which channels a chunk has.
  const auto is_known = [&](std::uint16_t channel) { return channels_.contains(channel); };
  const bool complete = std::ranges::all_of(chunks_, [&](const Chunk& chunk) {
    return !chunk.channels.empty() && std::ranges::all_of(chunk.channels, is_known);
  });
  is_without_summary_ = !complete || !totals.stated || totals.chunks != chunks_.size() ||
                        totals.metadata != metadata_.size() || totals.attachments != attachments_.size() ||
                        (totals.chunks == 0 && totals.messages > 0);
  if (is_without_summary_) return false;
  has_summary_ = true;
  whole_until_ = file_.size();
  return true;
}

bool McapReader::ReadSummaryRecord(const Record& record, std::map<std::uint16_t, Channel>& schemas,
                                   Totals& totals) {
  switch (record.op) {
    case Op::kSchema:
      return AddSchema(record.content, schemas);
    case Op::kChannel:
      return AddChannel(record.content, schemas);
    case Op::kStatistics:
      return ReadStatistics(record.content, totals);
    case Op::kChunkIndex:
      return AddChunkIndex(record.content);
    case Op::kMetadataIndex: {
      const auto target = RecordAt(file_, ByteReader(record.content).U64());
      return target && target->op == Op::kMetadata && AddMetadata(target->content);
    }
    case Op::kAttachmentIndex: {
      const auto target = RecordAt(file_, ByteReader(record.content).U64());
      return target && target->op == Op::kAttachment && AddAttachment(target->content);
    }
    default:
      return true;
  }
}

bool McapReader::ReadStatistics(Bytes content, Totals& totals) {
  ByteReader in(content);
  totals.stated = true;
  totals.messages = in.U64();
  in.U16();  // schemas
  in.U32();  // channels
  totals.attachments = in.U32();
  totals.metadata = in.U32();
  totals.chunks = in.U32();
  const std::uint64_t first = in.U64();
  const std::uint64_t last = in.U64();
  ByteReader counts(in.Take(in.U32()));
  while (counts.good() && !counts.rest().empty()) {
    const std::uint16_t channel = counts.U16();
    message_counts_[channel] = counts.U64();
  }
  if (!in.good() || !counts.good() || !FitsTime(first) || !FitsTime(last)) return false;
  if (totals.messages > 0) {
    start_ = TimeFrom(first);
    end_ = TimeFrom(last);
  }
  return true;
}

bool McapReader::AddChunkIndex(Bytes content) {
  ByteReader in(content);
  Chunk chunk{};
  const std::uint64_t first = in.U64();
  const std::uint64_t last = in.U64();
  chunk.offset = in.U64();
  chunk.length = in.U64();
  ByteReader indexes(in.Take(in.U32()));
  while (indexes.good() && !indexes.rest().empty()) {
    chunk.channels.push_back(indexes.U16());
    indexes.U64();
  }
  std::ranges::sort(chunk.channels);
  in.U64();  // length of all message indexes
  chunk.compression = in.String();
  chunk.compressed = in.U64();
  chunk.uncompressed = in.U64();
  if (!in.good() || !indexes.good() || !FitsTime(first) || !FitsTime(last)) return false;
  chunk.start = TimeFrom(first);
  chunk.end = TimeFrom(last);
  chunks_.push_back(std::move(chunk));
  return true;
}

}  // namespace thalweg::recorder
