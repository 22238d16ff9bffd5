#include "services/recorder/core/mcap_reader.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <set>

#include "services/recorder/core/compression.h"
#include "services/recorder/core/topic_pattern.h"

namespace thalweg::recorder {
namespace {

std::string At(std::uint64_t offset) {
  return "byte " + std::to_string(offset) + ": ";
}

bool IsMagic(Bytes bytes) {
  return bytes.size() >= kMagic.size() && std::ranges::equal(bytes.first(kMagic.size()), kMagic);
}

/// Times beyond the range of Time do not occur: it reaches to the year 2262.
bool FitsTime(std::uint64_t nanoseconds) {
  return nanoseconds <= static_cast<std::uint64_t>(std::numeric_limits<Duration::rep>::max());
}

Time TimeFrom(std::uint64_t nanoseconds) {
  return Time{Duration(static_cast<Duration::rep>(nanoseconds))};
}

}  // namespace

std::optional<McapReader::Record> McapReader::RecordAt(Bytes bytes, std::uint64_t offset) {
  if (offset > bytes.size() || bytes.size() - offset < kRecordHeaderBytes) return std::nullopt;
  ByteReader in(bytes.subspan(offset));
  const auto op = static_cast<Op>(in.U8());
  const std::uint64_t length = in.U64();
  const Bytes content = in.Take(length);
  if (!in.good()) return std::nullopt;
  return Record{op, offset, content, offset + kRecordHeaderBytes + length};
}

std::optional<Message> McapReader::ParseMessage(Bytes content) {
  ByteReader in(content);
  Message message{};
  message.channel = in.U16();
  message.sequence = in.U32();
  const std::uint64_t log_time = in.U64();
  const std::uint64_t publish_time = in.U64();
  message.payload = in.rest();
  if (!in.good() || !FitsTime(log_time) || !FitsTime(publish_time)) return std::nullopt;
  message.log_time = TimeFrom(log_time);
  message.publish_time = TimeFrom(publish_time);
  return message;
}

Result<McapReader> McapReader::Open(Bytes file, const ReadLimits& limits) {
  if (!IsMagic(file))
    return Error{"is no MCAP file: it does not begin with the bytes 89 4D 43 41 50 30 0D 0A"};
  McapReader reader(file, limits);
  if (!reader.OpenBySummary()) {
    McapReader scanner(file, limits);
    scanner.problems_ = std::move(reader.problems_);
    scanner.Scan();
    return scanner;
  }
  return reader;
}

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
  if (start == 0) return false;  // written without a summary
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
  if (!complete || !totals.stated || totals.chunks != chunks_.size() || totals.metadata != metadata_.size()) {
    return false;
  }
  if (totals.chunks == 0 && totals.messages > 0) return false;
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
  in.U32();  // attachments
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

bool McapReader::AddSchema(Bytes content, std::map<std::uint16_t, Channel>& schemas) {
  ByteReader in(content);
  const std::uint16_t number = in.U16();
  Channel schema;
  schema.type = in.String();
  schema.schema_encoding = in.String();
  schema.schema = in.String();
  if (!in.good() || number == 0) return false;
  schemas.emplace(number, std::move(schema));
  return true;
}

bool McapReader::AddChannel(Bytes content, const std::map<std::uint16_t, Channel>& schemas) {
  ByteReader in(content);
  const std::uint16_t number = in.U16();
  const std::uint16_t schema = in.U16();
  Channel channel;
  if (const auto known = schemas.find(schema); known != schemas.end()) {
    channel = known->second;
  } else if (schema != 0) {
    return false;
  } else {
    channel.schema_encoding.clear();
  }
  channel.topic = in.String();
  channel.message_encoding = in.String();
  channel.metadata = in.Map();
  if (!in.good()) return false;
  const auto [known, added] = channels_.emplace(number, channel);
  return added || known->second == channel;
}

bool McapReader::AddMetadata(Bytes content) {
  ByteReader in(content);
  Metadata metadata;
  metadata.name = in.String();
  metadata.pairs = in.Map();
  if (!in.good()) return false;
  metadata_.push_back(std::move(metadata));
  return true;
}

void McapReader::Count(const Message& message) {
  ++message_counts_[message.channel];
  start_ = start_ ? std::min(*start_, message.log_time) : message.log_time;
  end_ = end_ ? std::max(*end_, message.log_time) : message.log_time;
}

void McapReader::Scan() {
  std::map<std::uint16_t, Channel> schemas;
  std::uint64_t offset = kMagic.size();
  for (;;) {
    whole_until_ = offset;
    const auto record = RecordAt(file_, offset);
    if (!record) break;
    if (record->op == Op::kDataEnd || record->op == Op::kFooter) {
      // What follows only repeats what was read.
      whole_until_ = file_.size();
      return;
    }
    ScanRecord(*record, schemas);
    offset = record->end;
  }
  if (offset == file_.size()) return;
  problems_.Add(At(offset) + "no whole record: " + std::to_string(file_.size() - offset) +
                " bytes follow, to the end of the file; everything before them is read");
}

void McapReader::ScanRecord(const Record& record, std::map<std::uint16_t, Channel>& schemas) {
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
      good = AddSchema(record.content, schemas);
      break;
    case Op::kChannel:
      good = AddChannel(record.content, schemas);
      break;
    case Op::kMetadata:
      good = AddMetadata(record.content);
      break;
    case Op::kChunk:
      ScanChunk(record, schemas);
      break;
    case Op::kMessage: {
      const auto message = ParseMessage(record.content);
      good = message && channels_.contains(message->channel);
      if (!good) break;
      Count(*message);
      loose_.push_back({message->log_time, record.offset});
      break;
    }
    default:
      break;
  }
  if (!good) {
    problems_.Add(At(record.offset) + "record " + std::to_string(static_cast<int>(record.op)) +
                  " makes no sense, left out");
  }
}

void McapReader::ScanChunk(const Record& record, std::map<std::uint16_t, Channel>& schemas) {
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
    if (inner->op == Op::kSchema) good = AddSchema(inner->content, schemas);
    if (inner->op == Op::kChannel) good = AddChannel(inner->content, schemas);
    if (inner->op == Op::kMessage) {
      const auto message = ParseMessage(inner->content);
      good = message && channels_.contains(message->channel);
      if (good) {
        Count(*message);
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

Result<McapReader::Chunk> McapReader::ParseChunk(const Record& record, Bytes& records,
                                                 std::uint32_t& crc) const {
  ByteReader in(record.content);
  Chunk chunk{};
  const std::uint64_t start = in.U64();
  const std::uint64_t end = in.U64();
  chunk.offset = record.offset;
  chunk.length = record.end - record.offset;
  chunk.uncompressed = in.U64();
  crc = in.U32();
  chunk.compression = in.String();
  chunk.compressed = in.U64();
  records = in.Take(chunk.compressed);
  if (!in.good() || !FitsTime(start) || !FitsTime(end)) {
    return Error{At(record.offset) + "the chunk's fields make no sense, it is left out"};
  }
  chunk.start = TimeFrom(start);
  chunk.end = TimeFrom(end);
  return chunk;
}

Result<std::vector<std::uint8_t>> McapReader::Load(const Chunk& chunk) const {
  const std::string at = At(chunk.offset);
  const auto record = RecordAt(file_, chunk.offset);
  if (!record || record->op != Op::kChunk)
    return Error{at + "the summary says that a chunk is here, none is"};
  Bytes compressed;
  std::uint32_t crc = 0;
  const Result<Chunk> found = ParseChunk(*record, compressed, crc);
  if (!found) return Error{found.error()};
  if (found->uncompressed != chunk.uncompressed || found->compression != chunk.compression) {
    return Error{at + "the chunk contradicts the summary, it is left out"};
  }
  if (found->uncompressed > limits_.chunk_bytes) {
    return Error{at + "the chunk says that it holds " + std::to_string(found->uncompressed) +
                 " bytes, more than the " + std::to_string(limits_.chunk_bytes) + " that are accepted"};
  }
  auto records = Decompress(found->compression, compressed, found->uncompressed);
  if (!records) return Error{at + "the chunk is left out: " + records.error()};
  if (crc != 0 && Crc32(*records) != crc) return Error{at + "the chunk's CRC is wrong, it is left out"};
  return records;
}

std::uint64_t McapReader::message_count() const {
  std::uint64_t count = 0;
  for (const auto& [channel, messages] : message_counts_) count += messages;
  return count;
}

MessageCursor McapReader::Read(const Selection& selection) const {
  return {*this, selection};
}

Problems McapReader::Check() const {
  Problems problems;
  if (has_summary_) {
    problems.Add(problems_);
  }
  // A scan, whatever the summary says, finds records that are not whole.
  McapReader scan(file_, limits_);
  scan.Scan();
  problems.Add(has_summary_ ? scan.problems_ : problems_);
  if (!has_summary_) return problems;
  if (scan.profile_.empty()) problems.Add(At(kMagic.size()) + "no header");

  std::uint64_t offset = kMagic.size();
  auto record = RecordAt(file_, offset);
  for (; record && record->op != Op::kDataEnd; record = RecordAt(file_, offset)) offset = record->end;
  ByteReader footer(file_.subspan(file_.size() - kMagic.size() - kFooterBytes + kRecordHeaderBytes));
  if (!record || record->content.size() != 4 || record->end != footer.U64()) {
    problems.Add(At(offset) + "no record that ends the data right before the summary");
    return problems;
  }
  const std::uint32_t crc = ByteReader(record->content).U32();
  if (crc != 0 && Crc32(file_.first(offset)) != crc) {
    problems.Add(At(0) + "the CRC of the data, up to byte " + std::to_string(offset) + ", is wrong");
  }
  const auto same_chunk = [](const Chunk& a, const Chunk& b) {
    return a.offset == b.offset && a.start == b.start && a.end == b.end && a.channels == b.channels;
  };
  if (!std::ranges::equal(chunks_, scan.chunks_, same_chunk) || message_counts_ != scan.message_counts_ ||
      start_ != scan.start_ || end_ != scan.end_ || metadata_ != scan.metadata_) {
    problems.Add(At(offset) + "the summary contradicts the data");
  }
  return problems;
}

MessageCursor::MessageCursor(const McapReader& reader, const Selection& selection)
    : reader_(&reader), selection_(selection) {
  for (const auto& [number, channel] : reader.channels_) {
    const bool wanted =
        selection.topics.empty() || std::ranges::any_of(selection.topics, [&](const std::string& pattern) {
          return Matches(pattern, channel.topic);
        });
    if (number >= wanted_.size()) wanted_.resize(number + 1U);
    wanted_[number] = wanted;
  }
  const auto is_wanted = [&](std::uint16_t channel) { return channel < wanted_.size() && wanted_[channel]; };
  for (const McapReader::Chunk& chunk : reader.chunks_) {
    if (chunk.end < selection.start || chunk.start >= selection.end) continue;
    if (std::ranges::any_of(chunk.channels, is_wanted)) pending_.push_back(&chunk);
  }
  std::ranges::stable_sort(pending_, {}, [](const McapReader::Chunk* chunk) { return chunk->start; });
  if (!reader.loose_.empty()) {
    OpenChunk loose;
    loose.bytes = reader.file_;
    loose.messages = reader.loose_;
    Push(pending_.size(), std::move(loose));
  }
}

bool MessageCursor::IsWanted(const Message& message) const {
  return message.channel < wanted_.size() && wanted_[message.channel] &&
         message.log_time >= selection_.start && message.log_time < selection_.end;
}

void MessageCursor::Push(std::size_t rank, OpenChunk chunk) {
  std::erase_if(chunk.messages, [&](const McapReader::Position& position) {
    const auto record = McapReader::RecordAt(chunk.bytes, position.offset);
    return !IsWanted(*McapReader::ParseMessage(record->content));
  });
  if (chunk.messages.empty()) return;
  std::ranges::stable_sort(chunk.messages, {}, &McapReader::Position::log_time);
  heads_.push({chunk.messages.front().log_time, rank});
  open_bytes_ += chunk.owned.size();
  open_.emplace(rank, std::move(chunk));
}

void MessageCursor::OpenNextChunk() {
  const std::size_t rank = next_pending_++;
  const McapReader::Chunk& info = *pending_[rank];
  if (open_bytes_ + info.uncompressed > reader_->limits_.open_bytes && !open_.empty()) {
    problems_.Add(At(info.offset) + "the chunk is left out: the chunks that overlap in time with it hold " +
                  std::to_string(open_bytes_) + " bytes");
    return;
  }
  auto records = reader_->Load(info);
  if (!records) return problems_.Add(records.error());
  OpenChunk chunk;
  chunk.owned = std::move(*records);
  chunk.bytes = chunk.owned;
  std::uint64_t offset = 0;
  for (auto record = McapReader::RecordAt(chunk.bytes, 0); record;
       record = McapReader::RecordAt(chunk.bytes, offset)) {
    offset = record->end;
    if (record->op != Op::kMessage) continue;
    if (const auto message = McapReader::ParseMessage(record->content)) {
      chunk.messages.push_back({message->log_time, record->offset});
    } else {
      problems_.Add(At(info.offset) + "the chunk's message at " + std::to_string(record->offset) +
                    " makes no sense, left out");
    }
  }
  if (offset != chunk.bytes.size()) problems_.Add(At(info.offset) + "the chunk's last record is not whole");
  Push(rank, std::move(chunk));
}

std::optional<Message> MessageCursor::Next() {
  if (spent_) {
    const auto spent = open_.find(*spent_);
    open_bytes_ -= spent->second.owned.size();
    open_.erase(spent);
    spent_.reset();
  }
  // Opens every chunk that may have a message before the earliest of the open ones.
  while (next_pending_ < pending_.size() &&
         (heads_.empty() || pending_[next_pending_]->start <= heads_.top().log_time)) {
    OpenNextChunk();
  }
  if (heads_.empty()) return std::nullopt;
  const std::size_t rank = heads_.top().chunk;
  heads_.pop();
  OpenChunk& chunk = open_.at(rank);
  const auto record = McapReader::RecordAt(chunk.bytes, chunk.messages[chunk.next].offset);
  if (++chunk.next < chunk.messages.size()) {
    heads_.push({chunk.messages[chunk.next].log_time, rank});
  } else {
    spent_ = rank;
  }
  return McapReader::ParseMessage(record->content);
}

}  // namespace thalweg::recorder
