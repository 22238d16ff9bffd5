#include "services/recorder/core/mcap_writer.h"

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "common/base/check.h"

namespace thalweg::recorder {
namespace {

void AppendRecord(ByteWriter& out, Op op, Bytes content) {
  out.U8(static_cast<std::uint8_t>(op));
  out.U64(content.size());
  out.Append(content);
}

std::uint64_t Nanoseconds(Time time) {
  const auto count = time.time_since_epoch().count();
  return count < 0 ? 0 : static_cast<std::uint64_t>(count);
}

/// Remembers where each group of the summary begins.
class SummaryGroups {
 public:
  explicit SummaryGroups(std::uint64_t start) : start_(start) {}

  void Add(Op op, const ByteWriter& content) {
    if (groups_.empty() || groups_.back().op != op) groups_.push_back({op, start_ + records_.size()});
    AppendRecord(records_, op, content.bytes());
  }
  /// @return  Where the offsets begin.
  std::uint64_t AddOffsets() {
    const std::uint64_t end = start_ + records_.size();
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const std::uint64_t next = g + 1 < groups_.size() ? groups_[g + 1].offset : end;
      ByteWriter content;
      content.U8(static_cast<std::uint8_t>(groups_[g].op));
      content.U64(groups_[g].offset);
      content.U64(next - groups_[g].offset);
      AppendRecord(records_, Op::kSummaryOffset, content.bytes());
    }
    return end;
  }
  ByteWriter& records() { return records_; }

 private:
  struct Group {
    Op op;
    std::uint64_t offset;
  };
  std::uint64_t start_;
  ByteWriter records_;
  std::vector<Group> groups_;
};

}  // namespace

McapWriter::McapWriter(const Options& options, ByteSink sink) : options_(options), sink_(std::move(sink)) {
  Emit(kMagic);
  ByteWriter header;
  header.String("ros2");
  header.String(options_.library);
  EmitRecord(Op::kHeader, header.bytes());
}

void McapWriter::Emit(Bytes bytes) {
  sink_(bytes);
  crc_ = Crc32(bytes, crc_);
  offset_ += bytes.size();
}

void McapWriter::EmitRecord(Op op, Bytes content) {
  ByteWriter header;
  header.U8(static_cast<std::uint8_t>(op));
  header.U64(content.size());
  Emit(header.bytes());
  Emit(content);
}

std::uint16_t McapWriter::AddChannel(const Channel& channel) {
  constexpr std::size_t kMostChannels = 65535;
  if (channels_.size() >= kMostChannels) throw std::length_error("more than 65535 channels");
  std::uint16_t schema = 0;
  if (!channel.type.empty()) {
    const auto fields = [](const Channel& c) { return std::tie(c.type, c.schema, c.schema_encoding); };
    const auto known =
        std::ranges::find_if(schemas_, [&](const Channel& s) { return fields(s) == fields(channel); });
    schema = static_cast<std::uint16_t>(known - schemas_.begin() + 1);
    if (known == schemas_.end()) schemas_.push_back(channel);
  }
  channels_.push_back({.channel = channel, .schema = schema});
  return static_cast<std::uint16_t>(channels_.size() - 1);
}

ByteWriter McapWriter::SchemaContent(std::uint16_t schema) const {
  const Channel& described = schemas_[schema - 1U];
  ByteWriter content;
  content.U16(schema);
  content.String(described.type);
  content.String(described.schema_encoding);
  content.String(described.schema);
  return content;
}

ByteWriter McapWriter::ChannelContent(std::uint16_t channel) const {
  const KnownChannel& known = channels_[channel];
  ByteWriter content;
  content.U16(channel);
  content.U16(known.schema);
  content.String(known.channel.topic);
  content.String(known.channel.message_encoding);
  content.Map(known.channel.metadata);
  return content;
}

void McapWriter::Write(std::uint16_t channel, std::uint32_t sequence, Time log_time, Time publish_time,
                       Bytes payload) {
  THALWEG_CHECK(channel < channels_.size());
  KnownChannel& known = channels_[channel];
  if (!known.announced) {
    const auto announce = [&](Op op, const ByteWriter& content) {
      AppendRecord(chunk_.announcements, op, content.bytes());
      AppendRecord(chunk_.records, op, content.bytes());
    };
    if (known.schema != 0 && announced_schemas_.insert(known.schema).second) {
      announce(Op::kSchema, SchemaContent(known.schema));
    }
    announce(Op::kChannel, ChannelContent(channel));
    known.announced = true;
  }
  const std::uint64_t time = Nanoseconds(log_time);
  const bool first_of_chunk = chunk_.indexes.empty();
  chunk_.start = first_of_chunk ? time : std::min(chunk_.start, time);
  chunk_.end = first_of_chunk ? time : std::max(chunk_.end, time);
  start_ = messages_ == 0 ? time : std::min(start_, time);
  end_ = messages_ == 0 ? time : std::max(end_, time);
  chunk_.indexes[channel].emplace_back(time, chunk_.records.size());
  chunk_.records.U8(static_cast<std::uint8_t>(Op::kMessage));
  constexpr std::uint64_t kFields = 22;
  chunk_.records.U64(kFields + payload.size());
  chunk_.records.U16(channel);
  chunk_.records.U32(sequence);
  chunk_.records.U64(time);
  chunk_.records.U64(Nanoseconds(publish_time));
  chunk_.records.Append(payload);
  ++known.messages;
  ++messages_;
  if (chunk_.records.size() >= options_.chunk_bytes) Flush();
}

void McapWriter::Flush() {
  if (chunk_.indexes.empty()) return;
  const Bytes records = chunk_.records.bytes();
  const std::vector<std::uint8_t> compressed = Compress(options_.compression, records);
  ByteWriter content;
  content.U64(chunk_.start);
  content.U64(chunk_.end);
  content.U64(records.size());
  content.U32(Crc32(records));
  content.String(NameOf(options_.compression));
  content.U64(compressed.size());
  content.Append(compressed);
  ByteWriter out;
  out.Append(chunk_.announcements.bytes());
  ChunkIndex index{.start = chunk_.start,
                   .end = chunk_.end,
                   .offset = offset_ + out.size(),
                   .length = kRecordHeaderBytes + content.size(),
                   .message_indexes = {},
                   .message_index_length = 0,
                   .compressed = compressed.size(),
                   .uncompressed = records.size()};
  // The chunk and its indexes go to the sink in one piece, so that a kill leaves both or neither.
  AppendRecord(out, Op::kChunk, content.bytes());
  for (auto& [channel, messages] : chunk_.indexes) {
    std::ranges::stable_sort(messages, {}, [](const auto& message) { return message.first; });
    index.message_indexes[channel] = offset_ + out.size();
    ByteWriter entries;
    entries.U16(channel);
    entries.U32(static_cast<std::uint32_t>(16 * messages.size()));
    for (const auto& [time, offset] : messages) {
      entries.U64(time);
      entries.U64(offset);
    }
    AppendRecord(out, Op::kMessageIndex, entries.bytes());
  }
  index.message_index_length = out.size() - chunk_.announcements.size() - index.length;
  chunks_.push_back(std::move(index));
  chunk_.announcements.clear();
  chunk_.records.clear();
  chunk_.indexes.clear();
  Emit(out.bytes());
}

void McapWriter::AddMetadata(const Metadata& metadata) {
  Flush();
  ByteWriter content;
  content.String(metadata.name);
  content.Map(metadata.pairs);
  metadata_.push_back({offset_, kRecordHeaderBytes + content.size(), metadata.name});
  EmitRecord(Op::kMetadata, content.bytes());
}

void McapWriter::AddAttachment(const Attachment& attachment) {
  Flush();
  ByteWriter content;
  content.U64(attachment.log_time_ns);
  content.U64(attachment.create_time_ns);
  content.String(attachment.name);
  content.String(attachment.media_type);
  content.U64(attachment.data.size());
  content.Append(attachment.data);
  content.U32(Crc32(content.bytes()));
  AttachmentIndex index{offset_, kRecordHeaderBytes + content.size(), attachment, attachment.data.size()};
  index.attachment.data = {};
  attachments_.push_back(std::move(index));
  EmitRecord(Op::kAttachment, content.bytes());
}

ByteWriter McapWriter::StatisticsContent() const {
  ByteWriter counts;
  for (std::size_t channel = 0; channel < channels_.size(); ++channel) {
    if (channels_[channel].messages == 0) continue;
    counts.U16(static_cast<std::uint16_t>(channel));
    counts.U64(channels_[channel].messages);
  }
  ByteWriter content;
  content.U64(messages_);
  content.U16(static_cast<std::uint16_t>(schemas_.size()));
  content.U32(static_cast<std::uint32_t>(channels_.size()));
  content.U32(static_cast<std::uint32_t>(attachments_.size()));
  content.U32(static_cast<std::uint32_t>(metadata_.size()));
  content.U32(static_cast<std::uint32_t>(chunks_.size()));
  content.U64(start_);
  content.U64(end_);
  content.U32(static_cast<std::uint32_t>(counts.size()));
  content.Append(counts.bytes());
  return content;
}

void McapWriter::Close() {
  Flush();
  ByteWriter data_end;
  data_end.U32(crc_);
  EmitRecord(Op::kDataEnd, data_end.bytes());

  const std::uint64_t start = offset_;
  SummaryGroups summary(start);
  for (std::size_t k = 1; k <= schemas_.size(); ++k) {
    summary.Add(Op::kSchema, SchemaContent(static_cast<std::uint16_t>(k)));
  }
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    summary.Add(Op::kChannel, ChannelContent(static_cast<std::uint16_t>(k)));
  }
  summary.Add(Op::kStatistics, StatisticsContent());
  for (const ChunkIndex& chunk : chunks_) {
    ByteWriter content;
    content.U64(chunk.start);
    content.U64(chunk.end);
    content.U64(chunk.offset);
    content.U64(chunk.length);
    content.U32(static_cast<std::uint32_t>(10 * chunk.message_indexes.size()));
    for (const auto& [channel, offset] : chunk.message_indexes) {
      content.U16(channel);
      content.U64(offset);
    }
    content.U64(chunk.message_index_length);
    content.String(NameOf(options_.compression));
    content.U64(chunk.compressed);
    content.U64(chunk.uncompressed);
    summary.Add(Op::kChunkIndex, content);
  }
  for (const auto& [offset, length, attachment, data_size] : attachments_) {
    ByteWriter content;
    content.U64(offset);
    content.U64(length);
    content.U64(attachment.log_time_ns);
    content.U64(attachment.create_time_ns);
    content.U64(data_size);
    content.String(attachment.name);
    content.String(attachment.media_type);
    summary.Add(Op::kAttachmentIndex, content);
  }
  for (const MetadataIndex& metadata : metadata_) {
    ByteWriter content;
    content.U64(metadata.offset);
    content.U64(metadata.length);
    content.String(metadata.name);
    summary.Add(Op::kMetadataIndex, content);
  }
  const std::uint64_t offsets_start = summary.AddOffsets();
  ByteWriter& out = summary.records();
  // The summary's CRC also covers the footer up to the CRC itself.
  out.U8(static_cast<std::uint8_t>(Op::kFooter));
  out.U64(kFooterBytes - kRecordHeaderBytes);
  out.U64(start);
  out.U64(offsets_start);
  out.U32(Crc32(out.bytes()));
  out.Append(kMagic);
  Emit(out.bytes());
}

}  // namespace thalweg::recorder
