#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <queue>
#include <string>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/base/time.h"
#include "services/recorder/core/mcap_format.h"

namespace thalweg::recorder {

/// A bounded list of what is wrong with a file, each with its place in bytes.
class Problems {
 public:
  static constexpr std::size_t kMost = 100;
  void Add(std::string text) {
    if (texts_.size() < kMost) texts_.push_back(std::move(text));
    ++count_;
  }
  /// @param where  Before each of them, e.g. the name of a file and ": ".
  void Add(const Problems& others, const std::string& where = "") {
    for (const std::string& text : others.texts_) Add(where + text);
    count_ += others.count_ - others.texts_.size();
  }
  const std::vector<std::string>& texts() const { return texts_; }  ///< The first kMost.
  std::size_t count() const { return count_; }
  bool empty() const { return count_ == 0; }

 private:
  std::vector<std::string> texts_;
  std::size_t count_ = 0;
};

/// What a reader accepts. A file can claim any size; these bound what is allocated for such a claim.
struct ReadLimits {
  std::uint64_t chunk_bytes = 256 << 20;  ///< [byte] Greatest size of a chunk, decompressed.
  std::uint64_t open_bytes = 1 << 30;     ///< [byte] The same for all chunks that overlap in time.
};

struct Message {
  std::uint16_t channel;
  std::uint32_t sequence;
  Time log_time;      ///< When it was received.
  Time publish_time;  ///< When it was sent.
  Bytes payload;      ///< Valid until the next message is read.
};

/// Which messages to read.
struct Selection {
  Time start = Time::min();
  Time end = Time::max();                ///< Messages before this time; with Time::max(), up to the last.
  std::vector<std::string> topics = {};  ///< Patterns as in topic_pattern.h; empty = all.

  bool EndsBefore(Time time) const { return time >= end && end != Time::max(); }
};

class MessageCursor;

/// Reads an MCAP file [https://mcap.dev/spec] of any writer, from memory or a mapped file.
///
/// A file with a summary is opened by its summary. One without, or whose summary is damaged, is scanned from
/// its beginning; after a record that is not whole the scan goes on at the next whole chunk. Every length is
/// checked against the bytes that there are; what is wrong is named in problems(), and everything else is
/// read, but for messages of channels that nothing whole announces: they are counted there.
/// Departures from the specification: message indexes are skipped, since a chunk is always read whole; in a
/// file with both chunks and messages outside of chunks the latter are read only if there is no summary.
class McapReader {
 public:
  struct Chunk {
    Time start, end;
    std::uint64_t offset;  ///< [byte] Offset of its record in the file.
    std::uint64_t length;  ///< [byte] Length of the record with its header.
    std::uint64_t compressed, uncompressed;
    std::string compression;
    std::vector<std::uint16_t> channels;  ///< Channels that have messages in it.
  };

  /// @param file  All bytes; must outlive the reader and its cursors.
  /// @return      An error only if this is no MCAP file at all.
  static Result<McapReader> Open(Bytes file, const ReadLimits& limits = {});

  const std::string& profile() const { return profile_; }
  const std::string& library() const { return library_; }
  const std::map<std::uint16_t, Channel>& channels() const { return channels_; }
  const std::vector<Metadata>& metadata() const { return metadata_; }
  const std::vector<Attachment>& attachments() const { return attachments_; }  ///< Those whose CRC is right.
  const std::vector<Chunk>& chunks() const { return chunks_; }
  /// Number of messages of each channel, as the summary states or the scan found it.
  const std::map<std::uint16_t, std::uint64_t>& message_counts() const { return message_counts_; }
  std::uint64_t message_count() const;
  std::optional<Time> start() const { return start_; }  ///< Log time of the first message.
  std::optional<Time> end() const { return end_; }      ///< Log time of the last message.
  bool has_summary() const { return has_summary_; }     ///< Whether it was opened by its summary.
  /// Whether it was written without a summary, or with one that leaves parts out, which is no damage.
  bool is_without_summary() const { return is_without_summary_; }
  std::uint64_t size() const { return file_.size(); }  ///< [byte]
  /// [byte] Where the first record begins that is not whole: the file's size unless it was scanned and is cut
  /// or damaged.
  std::uint64_t whole_until() const { return whole_until_; }
  const Problems& problems() const { return problems_; }  ///< Found while opening.

  /// The selected messages in order of their log time; messages of one log time in the file's order.
  MessageCursor Read(const Selection& selection = {}) const;

  /// Reads all records and compares every CRC, and the summary with the data. Empty: the file is whole.
  Problems Check() const;

 private:
  friend class MessageCursor;
  struct Position {
    Time log_time;
    std::uint64_t offset;  ///< Where the record begins, in its chunk or in the file.
  };
  struct Record {
    Op op;
    std::uint64_t offset;
    Bytes content;
    std::uint64_t end;  ///< Offset of the next record.
  };
  /// What the summary's statistics say that there is.
  struct Totals {
    bool stated = false;
    std::uint64_t messages = 0, metadata = 0, attachments = 0, chunks = 0;
  };

  McapReader(Bytes file, const ReadLimits& limits) : file_(file), limits_(limits) {}
  static std::optional<Record> RecordAt(Bytes bytes, std::uint64_t offset);
  static std::optional<Message> ParseMessage(Bytes content);

  bool OpenBySummary();
  bool ReadSummary(std::uint64_t start);
  bool ReadSummaryRecord(const Record& record, std::map<std::uint16_t, Channel>& schemas, Totals& totals);
  bool ReadStatistics(Bytes content, Totals& totals);
  bool AddChunkIndex(Bytes content);
  struct Found;  ///< What a scan has found so far.
  void Scan();
  bool ScanRecord(const Record& record, Found& found);
  void ScanChunk(const Record& record, Found& found);
  bool ScanChannel(Bytes content, Found& found);
  void ScanAnnouncements(std::uint64_t offset, Found& found);
  void Finish(Found& found);
  bool CanFollow(std::uint64_t offset) const;
  bool IsWholeChunk(const Record& record, Found& found) const;
  std::optional<std::uint64_t> NextWholeChunk(std::uint64_t offset, Found& found) const;
  Result<Chunk> ParseChunk(const Record& record, Bytes& records, std::uint32_t& crc) const;
  /// The chunk's records, decompressed and compared with their CRC.
  Result<std::vector<std::uint8_t>> Load(const Chunk& chunk) const;
  bool AddSchema(Bytes content, std::map<std::uint16_t, Channel>& schemas);
  bool AddChannel(Bytes content, const std::map<std::uint16_t, Channel>& schemas);
  bool AddMetadata(Bytes content);
  bool AddAttachment(Bytes content);

  Bytes file_;
  ReadLimits limits_;
  std::string profile_, library_;
  std::map<std::uint16_t, Channel> channels_;
  std::vector<Metadata> metadata_;
  std::size_t metadata_bytes_ = 0;  ///< Size of all records of metadata that were read.
  std::vector<Attachment> attachments_;
  std::size_t attachment_bytes_ = 0;  ///< Size of all records of attachments that were read.
  std::size_t schema_bytes_ = 0;      ///< Size of the copies that channels hold.
  std::vector<Chunk> chunks_;
  std::vector<Position> loose_;  ///< Messages outside of chunks.
  std::map<std::uint16_t, std::uint64_t> message_counts_;
  std::optional<Time> start_, end_;
  bool has_summary_ = false;
  bool is_without_summary_ = false;
  std::uint64_t whole_until_ = 0;
  Problems problems_;
};

/// Delivers the messages of a selection one by one. Holds only the chunks that overlap at the current time.
class MessageCursor {
 public:
  /// The next message; nullopt at the end. Its reader must still exist.
  std::optional<Message> Next();
  const Problems& problems() const { return problems_; }  ///< Chunks and messages that were left out.

 private:
  friend class McapReader;
  MessageCursor(const McapReader& reader, const Selection& selection);

  struct OpenChunk {
    std::vector<std::uint8_t> owned;  ///< Empty for messages outside of chunks.
    Bytes bytes;
    std::vector<McapReader::Position> messages;  ///< In order of their log time.
    std::size_t next = 0;
  };
  struct Head {
    Time log_time;
    std::size_t chunk;  ///< Rank among the chunks; breaks ties.
    bool operator>(const Head& other) const {
      return log_time != other.log_time ? log_time > other.log_time : chunk > other.chunk;
    }
  };
  bool IsWanted(const Message& message) const;
  void OpenNextChunk();
  void Push(std::size_t rank, OpenChunk chunk);

  const McapReader* reader_;
  Selection selection_;
  std::vector<bool> wanted_;                       ///< By channel.
  std::vector<const McapReader::Chunk*> pending_;  ///< In order of their start.
  std::size_t next_pending_ = 0;
  std::map<std::size_t, OpenChunk> open_;  ///< By rank.
  std::priority_queue<Head, std::vector<Head>, std::greater<>> heads_;
  std::uint64_t open_bytes_ = 0;
  std::optional<std::size_t> spent_;  ///< Rank of the chunk whose last message was delivered.
  Problems problems_;
};

}  // namespace thalweg::recorder
