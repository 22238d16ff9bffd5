#include <algorithm>

#include "services/recorder/core/mcap_parse.h"
#include "services/recorder/core/mcap_reader.h"
#include "services/recorder/core/topic_pattern.h"

namespace thalweg::recorder {

MessageCursor::MessageCursor(const McapReader& reader, const Selection& selection)
    : reader_(&reader), selection_(selection) {
  for (const auto& [number, channel] : reader.channels_) {
    const bool wanted = selection.topics.empty() || MatchesAny(selection.topics, channel.topic);
    if (number >= wanted_.size()) wanted_.resize(number + 1U);
    wanted_[number] = wanted;
  }
  const auto is_wanted = [&](std::uint16_t channel) { return channel < wanted_.size() && wanted_[channel]; };
  for (const McapReader::Chunk& chunk : reader.chunks_) {
    if (chunk.end < selection.start || selection.EndsBefore(chunk.start)) continue;
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
         message.log_time >= selection_.start && !selection_.EndsBefore(message.log_time);
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
