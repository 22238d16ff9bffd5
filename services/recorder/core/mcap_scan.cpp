#include <algorithm>
#include <set>

#include "services/recorder/core/mcap_parse.h"
#include "services/recorder/core/mcap_reader.h"

namespace thalweg::recorder {

// A file read from its beginning, because its summary is missing or damaged.

namespace {

/// The messages of a channel.
struct Tally {
  std::uint64_t count = 0;
  std::uint64_t offset = 0;  ///< [byte] The record in which the first one is.
  Time start = Time::max(), end = Time::min();
};

/// Opcode 0 is invalid, which makes sure that zeros are no records; others that are not known may be used by
/// later versions and by applications.
bool MayBeRecord(Op op) {
  return op != Op{};
}

bool IsKnown(Op op) {
  return MayBeRecord(op) && op <= Op::kDataEnd;
}

/// Whether nothing stands behind a chunk's records. A later version may add fields; a wrong length as well.
bool EndsWith(Bytes content, Bytes records) {
  return content.data() + content.size() == records.data() + records.size();
}

}  // namespace

struct McapReader::Found {
  std::map<std::uint16_t, Channel> schemas = {};
  std::map<std::uint16_t, Tally> tallies = {};  ///< By channel, whether or not it is announced.
  std::vector<std::vector<std::uint8_t>> without_schema =
      {};  ///< Announcements whose schema is still missing.
  std::size_t without_schema_bytes = 0;
  std::uint64_t tried_bytes = 0;  ///< [byte] Decompressed of what then was no whole chunk.

  void Count(const Message& message, std::uint64_t offset) {
    Tally& tally = tallies[message.channel];
    if (tally.count++ == 0) tally.offset = offset;
    tally.start = std::min(tally.start, message.log_time);
    tally.end = std::max(tally.end, message.log_time);
  }
};

void McapReader::Scan() {
  Found found;
  std::uint64_t offset = kMagic.size();
  std::optional<std::uint64_t> damage;
  for (;;) {
    const auto record = RecordAt(file_, offset);
    const bool is_last = record && ((record->op == Op::kDataEnd && record->content.size() == 4) ||
                                    (record->op == Op::kFooter && record->content.size() == 20));
    if (is_last) {
      whole_until_ = damage.value_or(file_.size());
      ScanAnnouncements(record->end, found);
      return Finish(found);
    }
    if (record && ScanRecord(*record, found)) {
      offset = record->end;
      continue;
    }
    if (offset == file_.size()) break;
    const bool is_first = !damage;
    if (!damage) damage = offset;
    const auto next = NextWholeChunk(offset + 1, found);
    const std::uint64_t left_out = next.value_or(file_.size()) - offset;
    std::string problem = At(offset) + "no whole record: " + std::to_string(left_out);
    if (next) {
      problem += " bytes are left out, up to the next whole chunk";
    } else {
      problem += " bytes follow, to the end of the file";
      if (is_first) problem += "; everything before them is read";
    }
    problems_.Add(std::move(problem));
    if (!next) break;
    offset = *next;
  }
  whole_until_ = damage.value_or(offset);
  Finish(found);
}

/// @return  Whether the next record can be expected at its end.
bool McapReader::ScanRecord(const Record& record, Found& found) {
  bool good = true;
  switch (record.op) {
    case Op::kHeader: {
      ByteReader in(record.content);
      profile_ = in.String();
      library_ = in.String();
      good = in.good();
      break;
    }
    case Op::kSchema:
      good = AddSchema(record.content, found.schemas);
      break;
    case Op::kChannel:
      good = ScanChannel(record.content, found);
      break;
    case Op::kMetadata:
      good = AddMetadata(record.content);
      break;
    case Op::kAttachment:
      good = AddAttachment(record.content);
      break;
    case Op::kChunk: {
      Bytes compressed;
      std::uint32_t crc = 0;
      const Result<Chunk> chunk = ParseChunk(record, compressed, crc);
      const bool is_exact = chunk && EndsWith(record.content, compressed);
      if (!is_exact && !CanFollow(record.end)) return false;
      ScanChunk(record, found);
      return true;
    }
    case Op::kMessage: {
      const auto message = ParseMessage(record.content);
      good = message.has_value();
      if (!good) break;
      found.Count(*message, record.offset);
      loose_.push_back({message->log_time, record.offset});
      break;
    }
    case Op::kMessageIndex: {
      ByteReader in(record.content);
      in.U16();  // the channel
      const bool is_exact = in.U32() == in.rest().size() && in.good();
      return is_exact || CanFollow(record.end);
    }
    default:
      if (!IsKnown(record.op)) return MayBeRecord(record.op) && CanFollow(record.end);
      return true;
  }
  if (good) return true;
  if (!CanFollow(record.end)) return false;  // its length is not right either
  problems_.Add(At(record.offset) + "record " + std::to_string(static_cast<int>(record.op)) +
                " makes no sense, left out");
  return true;
}

void McapReader::ScanChunk(const Record& record, Found& found) {
  Bytes compressed;
  std::uint32_t crc = 0;
  Result<Chunk> chunk = ParseChunk(record, compressed, crc);
  if (!chunk) return problems_.Add(chunk.error());
  const auto records = Load(*chunk);
  if (!records) return problems_.Add(records.error());
  std::set<std::uint16_t> present;
  std::uint64_t offset = 0;
  for (auto inner = RecordAt(*records, 0); inner; inner = RecordAt(*records, offset)) {
    offset = inner->end;
    bool good = true;
    if (inner->op == Op::kSchema) good = AddSchema(inner->content, found.schemas);
    if (inner->op == Op::kChannel) good = ScanChannel(inner->content, found);
    if (inner->op == Op::kMessage) {
      const auto message = ParseMessage(inner->content);
      good = message.has_value();
      if (good) {
        found.Count(*message, record.offset);
        present.insert(message->channel);
        // Neither start nor end is covered by a CRC.
        chunk->start = std::min(chunk->start, message->log_time);
        chunk->end = std::max(chunk->end, message->log_time);
      }
    }
    if (!good) {
      problems_.Add(At(record.offset) + "the chunk's record at " + std::to_string(inner->offset) +
                    " makes no sense, left out");
    }
  }
  if (offset != records->size()) problems_.Add(At(record.offset) + "the chunk's last record is not whole");
  chunk->channels.assign(present.begin(), present.end());
  if (!present.empty()) chunks_.push_back(std::move(*chunk));
}

/// A chunk that is damaged may have had the schema, and another one may have it as well.
bool McapReader::ScanChannel(Bytes content, Found& found) {
  ByteReader in(content);
  in.U16();  // its number
  const std::uint16_t schema = in.U16();
  if (!in.good() || schema == 0 || found.schemas.contains(schema)) return AddChannel(content, found.schemas);
  constexpr std::size_t kMostBytes = 256'000'000;
  found.without_schema_bytes += content.size();
  if (found.without_schema_bytes > kMostBytes) return false;
  found.without_schema.emplace_back(content.begin(), content.end());
  return true;
}

/// The summary repeats schemas and channels: they count where the chunks that had them are damaged.
void McapReader::ScanAnnouncements(std::uint64_t offset, Found& found) {
  const auto is_known = [&](const auto& tally) { return channels_.contains(tally.first); };
  if (std::ranges::all_of(found.tallies, is_known)) return;
  for (auto record = RecordAt(file_, offset); record && record->op != Op::kFooter;
       record = RecordAt(file_, record->end)) {
    if (record->op == Op::kSchema) AddSchema(record->content, found.schemas);
    if (record->op == Op::kChannel) ScanChannel(record->content, found);
  }
}

void McapReader::Finish(Found& found) {
  for (const std::vector<std::uint8_t>& content : found.without_schema) AddChannel(content, found.schemas);
  for (const auto& [channel, tally] : found.tallies) {
    if (!channels_.contains(channel)) {
      problems_.Add(At(tally.offset) + "from here on " + std::to_string(tally.count) +
                    " messages of channel " + std::to_string(channel) +
                    " are left out: what says its topic and type is damaged");
      continue;
    }
    message_counts_[channel] = tally.count;
    start_ = start_ ? std::min(*start_, tally.start) : tally.start;
    end_ = end_ ? std::max(*end_, tally.end) : tally.end;
  }
  for (Chunk& chunk : chunks_) {
    std::erase_if(chunk.channels, [&](std::uint16_t channel) { return !channels_.contains(channel); });
  }
  std::erase_if(chunks_, [](const Chunk& chunk) { return chunk.channels.empty(); });
}

/// Whether the file ends here, or has another record.
bool McapReader::CanFollow(std::uint64_t offset) const {
  if (offset == file_.size()) return true;
  const auto record = RecordAt(file_, offset);
  return record && IsKnown(record->op);
}

bool McapReader::IsWholeChunk(const Record& record, Found& found) const {
  Bytes compressed;
  std::uint32_t crc = 0;
  const Result<Chunk> chunk = ParseChunk(record, compressed, crc);
  if (!chunk || !EndsWith(record.content, compressed)) return false;
  if (chunk->start > chunk->end || chunk->uncompressed > limits_.chunk_bytes) return false;
  const auto records = Load(*chunk);
  found.tried_bytes += compressed.size() + (records ? records->size() : chunk->uncompressed);
  if (!records) return false;
  std::uint64_t offset = 0;
  for (auto inner = RecordAt(*records, 0); inner; inner = RecordAt(*records, offset)) {
    offset = inner->end;
    if (inner->op != Op::kMessage) continue;
    const auto message = ParseMessage(inner->content);
    if (message && (message->log_time < chunk->start || message->log_time > chunk->end)) return false;
  }
  return offset > 0 && offset == records->size();
}

/// @return  Where the next chunk begins whose lengths, times and CRC agree, if there is any.
std::optional<std::uint64_t> McapReader::NextWholeChunk(std::uint64_t offset, Found& found) const {
  // Bytes could be arranged so that each of them seems to begin a chunk, up to its CRC.
  while (offset < file_.size() && found.tried_bytes <= limits_.open_bytes) {
    const auto from = file_.begin() + static_cast<std::ptrdiff_t>(offset);
    offset = static_cast<std::uint64_t>(std::find(from, file_.end(), static_cast<std::uint8_t>(Op::kChunk)) -
                                        file_.begin());
    const auto record = RecordAt(file_, offset);
    const std::uint64_t tried_before = found.tried_bytes;
    if (record && IsWholeChunk(*record, found)) {
      found.tried_bytes = tried_before;
      return offset;
    }
    ++offset;
  }
  return std::nullopt;
}

}  // namespace thalweg::recorder
