#include "services/recorder/core/mcap_reader.h"

#include <algorithm>

#include "common/compression/compression.h"
#include "services/recorder/core/mcap_parse.h"

namespace thalweg::recorder {
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
    return Error{"is not an MCAP file: it does not begin with the bytes 89 4D 43 41 50 30 0D 0A"};
  McapReader reader(file, limits);
  if (!reader.OpenBySummary()) {
    McapReader scanner(file, limits);
    scanner.problems_ = std::move(reader.problems_);
    scanner.is_without_summary_ = reader.is_without_summary_;
    scanner.Scan();
    return scanner;
  }
  return reader;
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
    constexpr std::size_t kMostSchemaBytes = 256'000'000;  // each channel holds a copy
    schema_bytes_ += known->second.schema.size();
    if (schema_bytes_ > kMostSchemaBytes) return false;
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
  // Records may be listed more than once, though none of ours is: together they are no longer than the file.
  metadata_bytes_ += content.size();
  if (metadata_bytes_ > file_.size()) return false;
  ByteReader in(content);
  Metadata metadata;
  metadata.name = in.String();
  metadata.pairs = in.Map();
  if (!in.good()) return false;
  metadata_.push_back(std::move(metadata));
  return true;
}

bool McapReader::AddAttachment(Bytes content) {
  attachment_bytes_ += content.size();  // listed more than once, as for metadata
  if (attachment_bytes_ > file_.size()) return false;
  ByteReader in(content);
  Attachment attachment;
  attachment.log_time_ns = in.U64();
  attachment.create_time_ns = in.U64();
  attachment.name = in.String();
  attachment.media_type = in.String();
  attachment.data = in.Take(in.U64());
  const std::size_t covered = content.size() - in.rest().size();
  const std::uint32_t crc = in.U32();
  if (!in.good() || (crc != 0 && Crc32(content.first(covered)) != crc)) return false;
  attachments_.push_back(std::move(attachment));
  return true;
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
  if (!in.good()) {
    return Error{At(record.offset) + "the chunk's fields make no sense, it is left out"};
  }
  // A single message without a sensible time must not cost those beside it.
  chunk.start = ClampedTime(start);
  chunk.end = ClampedTime(end);
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
      start_ != scan.start_ || end_ != scan.end_ || metadata_ != scan.metadata_ ||
      attachments_ != scan.attachments_) {
    problems.Add(At(offset) + "the summary contradicts the data");
  }
  return problems;
}

}  // namespace thalweg::recorder
