#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/time.h"
#include "common/compression/compression.h"
#include "services/recorder/core/mcap_format.h"

namespace thalweg::recorder {

/// Takes the file's bytes in order. May throw; the writer is then of no further use, and what the sink has
/// taken so far is a file cut short, which McapReader reads up to the last whole chunk.
using ByteSink = std::function<void(Bytes)>;

/// Writes an MCAP file [https://mcap.dev/spec] of profile "ros2": chunks with message indexes, a summary with
/// statistics, and a CRC over each part.
///
/// Every schema and channel stands in the first chunk that uses it and again in the summary, so that a file
/// cut at any place explains all the messages that it still has.
/// Threading: one thread.
class McapWriter {
 public:
  struct Options {
    Compression compression = Compression::kZstd;
    std::size_t chunk_bytes = 2 << 20;  ///< [byte] A chunk ends once its records are this large.
    std::string library = "thalweg";    ///< Name and version of the program that writes.
  };
  McapWriter(const Options& options, ByteSink sink);  ///< Writes the file's beginning.

  /// @return  The channel's number, which Write takes. Throws std::length_error beyond 65535 channels.
  std::uint16_t AddChannel(const Channel& channel);

  /// @param sequence  Counts the channel's messages; a gap is a message that was dropped before.
  /// @param log_time, publish_time  When it was received and sent; the epoch or later.
  void Write(std::uint16_t channel, std::uint32_t sequence, Time log_time, Time publish_time, Bytes payload);

  void AddMetadata(const Metadata& metadata);
  void AddAttachment(const Attachment& attachment);

  /// Ends the chunk, if it has messages, and hands it to the sink.
  void Flush();

  /// Writes the summary. Nothing may be called afterwards.
  void Close();

  std::uint64_t bytes_written() const { return offset_; }       ///< Handed to the sink.
  std::uint64_t messages_written() const { return messages_; }  ///< Including those of the open chunk.

 private:
  struct KnownChannel {
    Channel channel;
    std::uint16_t schema = 0;
    bool announced = false;  ///< Whether a chunk, and the records before it, already have it.
    std::uint64_t messages = 0;
  };
  struct ChunkIndex {
    std::uint64_t start, end;
    std::uint64_t offset, length;
    std::map<std::uint16_t, std::uint64_t> message_indexes;
    std::uint64_t message_index_length;
    std::uint64_t compressed, uncompressed;
  };
  struct MetadataIndex {
    std::uint64_t offset, length;
    std::string name;
  };
  struct OpenChunk {
    /// Schemas and channels that its records announce, to be written before it as well: the messages of the
    /// chunks to come need them, also if this chunk is damaged and no summary was written.
    ByteWriter announcements;
    ByteWriter records;
    std::uint64_t start = 0, end = 0;
    std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> indexes;
  };

  struct AttachmentIndex {
    std::uint64_t offset, length;
    Attachment attachment;  ///< Without its data.
    std::uint64_t data_size;
  };

  void Emit(Bytes bytes);
  void EmitRecord(Op op, Bytes content);
  ByteWriter SchemaContent(std::uint16_t schema) const;
  ByteWriter ChannelContent(std::uint16_t channel) const;
  ByteWriter StatisticsContent() const;

  Options options_;
  ByteSink sink_;
  std::uint64_t offset_ = 0;
  std::uint32_t crc_ = 0;  ///< Over all bytes so far.

  std::vector<Channel> schemas_;  ///< Number of schema minus one; only the fields of the schema count.
  std::vector<KnownChannel> channels_;
  std::set<std::uint16_t> announced_schemas_;
  OpenChunk chunk_;
  std::vector<ChunkIndex> chunks_;
  std::vector<MetadataIndex> metadata_;
  std::vector<AttachmentIndex> attachments_;
  std::uint64_t messages_ = 0;
  std::uint64_t start_ = 0, end_ = 0;
};

}  // namespace thalweg::recorder
