#include <algorithm>
#include <set>

#include "services/recorder/core/mcap_parse.h"
#include "services/recorder/core/mcap_reader.h"

namespace thalweg::recorder {

// A file read from its beginning, because its summary is missing or damaged.

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
    case Op::kAttachment:
      good = AddAttachment(record.content);
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

}  // namespace thalweg::recorder
